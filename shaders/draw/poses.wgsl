// Poses of colliders between two steps, for shaders that draw them: `Poses::WGSL`.

// A collider before the last step. `Poses::previous` is an array of these.
struct FaceoffBefore {
    // Position of the mesh's origin.
    position: vec3<f32>,
    mesh: u32,
    // Unit quaternion.
    rotation: vec4<f32>,
    scale: vec3<f32>,
    radius: f32,
    others: array<vec4<u32>, 8>,
}

// A collider after the last step. `Poses::current` is an array of these.
struct FaceoffAfter {
    position: vec3<f32>,
    asleep: u32,
    rotation: vec4<f32>,
    velocities: array<vec4<f32>, 2>,
}

struct FaceoffPose {
    position: vec3<f32>,
    rotation: vec4<f32>,
    scale: vec3<f32>,
}

// The pose at this part of the way from before the step, 0, to after it, 1.
fn faceoff_pose(before: FaceoffBefore, after: FaceoffAfter, part: f32) -> FaceoffPose {
    // A quaternion and its negative are the same rotation. The shorter way leads to one of them.
    let rotation = select(-after.rotation, after.rotation, dot(before.rotation, after.rotation) >= 0.0);
    return FaceoffPose(
        mix(before.position, after.position, part),
        normalize(mix(before.rotation, rotation, part)),
        before.scale,
    );
}

// A point of the mesh in the world.
fn faceoff_point(pose: FaceoffPose, point: vec3<f32>) -> vec3<f32> {
    let scaled = pose.scale * point;
    let axis = pose.rotation.xyz;
    return pose.position + scaled + 2.0 * cross(axis, cross(axis, scaled) + pose.rotation.w * scaled);
}
