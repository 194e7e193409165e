#define_import_path faceoff::smooth

// How round surfaces touch of which a mesh has only corners and facets. `src/manifolds/cpu/smooth.rs` says why.

#import faceoff::constants::manifolds::SMOOTH
#import faceoff::math::direction
#import faceoff::sides
#import faceoff::types as t

// How the smooth surfaces touch at a feature.
struct Smoothed {
    // From the first body to the second.
    normal: vec3<f32>,
    // How fast it turns as the surfaces slide along each other: radians by length.
    normal_rotation: f32,
    // From where each body touches to where its smooth surface does, across the normal.
    slide_a: vec3<f32>,
    slide_b: vec3<f32>,
}

// With the roundness of the first body's surface and of the second's.
fn smoothed(a: sides::Side, b: sides::Side, feature: t::Feature, curvature_radius: vec2<f32>) -> Smoothed {
    var result: Smoothed;
    result.normal = feature.normal;
    let radius_a = sides::max_curvature_radius(a, feature.a);
    let radius_b = sides::max_curvature_radius(b, feature.b);
    if radius_a < t::FLAT_RADIUS && radius_b < t::FLAT_RADIUS {
        // Round all ways: they touch between the centres of the balls that they are there.
        let normal_a = normal_at(a, feature.a, feature.point_a);
        let normal_b = normal_at(b, feature.b, feature.point_b);
        // Two facets lie between the normals at two points.
        let least = 1.0 - 2.0 * SMOOTH * SMOOTH;
        if dot(normal_a, feature.normal) >= least && -dot(normal_b, feature.normal) >= least {
            let gap = max(feature.separation, 0.0);
            result.normal = direction(normal_a * radius_a - normal_b * radius_b + feature.normal * gap);
            result.normal_rotation = 1.0 / (radius_a + radius_b + gap);
            result.slide_a = slide(normal_a, feature.point_a - a.center, result.normal, curvature_radius.x);
            result.slide_b = slide(normal_b, feature.point_b - b.center, -result.normal, curvature_radius.y);
            return result;
        }
    }
    if feature.vertex == t::NOTHING {
        return result;
    }
    let number = feature.vertex & ~t::OF_SECOND;
    var offset = vec3(0.0);
    if (feature.vertex & t::OF_SECOND) == 0u {
        let normal = sides::smooth_normal(a, number);
        if is_smooth(normal, feature.normal, curvature_radius.x) {
            offset = slide(normal, feature.point_a - a.center, feature.normal, curvature_radius.x);
        }
    } else {
        let normal = sides::smooth_normal(b, number);
        if is_smooth(normal, -feature.normal, curvature_radius.y) {
            offset = slide(normal, feature.point_b - b.center, -feature.normal, curvature_radius.y);
        }
    }
    // Along the other body's face.
    result.slide_a = offset;
    result.slide_b = offset;
    return result;
}

// Whether there is a smooth surface of this roundness around a vertex, where it has this normal or none, that has the normal
// `out` near it.
fn is_smooth(normal: vec3<f32>, out: vec3<f32>, curvature_radius: f32) -> bool {
    let across = cross(normal, out);
    let near = dot(normal, out) > 0.0 && dot(across, across) <= SMOOTH * SMOOTH;
    return near && curvature_radius > 0.0 && curvature_radius < t::FLAT_RADIUS;
}

// From a point with this normal, at `anchor` from the centre of mass, to where it is `out`.
fn slide(normal: vec3<f32>, anchor: vec3<f32>, out: vec3<f32>, curvature_radius: f32) -> vec3<f32> {
    // No farther round than to beside the centre of mass, as the solver takes it.
    return (out * dot(normal, out) - normal) * min(curvature_radius, max(dot(anchor, out), 0.0));
}

// The smooth surface's normal at a point of a triangle: between those at its corners, by the areas over against them.
fn normal_at(side: sides::Side, triangle: u32, at: vec3<f32>) -> vec3<f32> {
    let numbers = sides::vertices(side, triangle);
    let p = sides::vertex(side, numbers.x) - at;
    let q = sides::vertex(side, numbers.y) - at;
    let r = sides::vertex(side, numbers.z) - at;
    let whole = direction(cross(q - p, r - p));
    return direction(
        sides::smooth_normal(side, numbers.x) * max(dot(cross(q, r), whole), 0.0)
            + sides::smooth_normal(side, numbers.y) * max(dot(cross(r, p), whole), 0.0)
            + sides::smooth_normal(side, numbers.z) * max(dot(cross(p, q), whole), 0.0),
    );
}
