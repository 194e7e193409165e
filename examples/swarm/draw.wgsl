// Draws tori where they are on the GPU. `Poses::WGSL` stands before this.

#import bevy_render::view::View

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> before: array<FaceoffBefore>;
@group(0) @binding(2) var<storage, read> after: array<FaceoffAfter>;
@group(0) @binding(3) var<uniform> part: f32;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) place: vec3<f32>,
    @location(1) @interpolate(flat) torus: u32,
}

@vertex
fn vertex(@builtin(instance_index) torus: u32, @location(0) corner: vec3<f32>) -> Corner {
    let pose = faceoff_pose(before[torus], after[torus], part);
    let place = faceoff_point(pose, corner);
    return Corner(view.clip_from_world * vec4(place, 1.0), place, torus);
}

// Colours between blue and orange, one for each torus.
fn paint(torus: u32) -> vec3<f32> {
    let mixed = (torus * 2654435769u) >> 16u;
    return mix(vec3(0.05, 0.25, 0.75), vec3(0.95, 0.45, 0.08), f32(mixed & 0xffu) / 255.0);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4<f32> {
    // Faces are flat: the normal follows from where neighbouring pixels are.
    let normal = normalize(cross(dpdy(corner.place), dpdx(corner.place)));
    let light = 0.35 + 0.65 * max(dot(normal, normalize(vec3(0.4, 0.8, 0.5))), 0.0);
    return vec4(light * paint(corner.torus), 1.0);
}
