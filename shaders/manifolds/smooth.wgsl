#define_import_path faceoff::smooth

// Contact on the smooth surface that a fine mesh approximates. The twin of `src/manifolds/cpu/smooth.rs`.

#import faceoff::constants::manifolds::SMOOTH
#import faceoff::math::direction
#import faceoff::sides
#import faceoff::types as t

// The contact of the smooth surfaces at a feature.
struct Smoothed {
    // Unit vector from the first body to the second.
    normal: vec3<f32>,
    // Rotation of the normal per distance that the surfaces slide along each other.
    normal_rotation: f32,
    // Offset of each body's point, perpendicular to the normal, to where its smooth surface touches.
    slide_a: vec3<f32>,
    slide_b: vec3<f32>,
}

// The contact at a feature, for the radii of curvature there.
fn smoothed(a: sides::Side, b: sides::Side, feature: t::Feature, curvature_radius: vec2<f32>) -> Smoothed {
    var result: Smoothed;
    result.normal = feature.normal;
    let radius_a = sides::max_curvature_radius(a, feature.a);
    let radius_b = sides::max_curvature_radius(b, feature.b);
    if radius_a < t::FLAT_RADIUS && radius_b < t::FLAT_RADIUS {
        // Surfaces that are convex in all directions touch on the line between their centres of curvature.
        let normal_a = normal_at(a, feature.a, feature.point_a);
        let normal_b = normal_at(b, feature.b, feature.point_b);
        // The smooth normals at two points differ by at most the angle of two facets.
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
    // Both points move along the other body's face.
    result.slide_a = offset;
    result.slide_b = offset;
    return result;
}

// Whether the smooth surface around a vertex has the normal `out` nearby. `normal` is the smooth normal at the vertex,
// which may be zero.
fn is_smooth(normal: vec3<f32>, out: vec3<f32>, curvature_radius: f32) -> bool {
    let across = cross(normal, out);
    let near = dot(normal, out) > 0.0 && dot(across, across) <= SMOOTH * SMOOTH;
    return near && curvature_radius > 0.0 && curvature_radius < t::FLAT_RADIUS;
}

// Offset from a point with this normal, at `anchor` from the centre of mass, to where the normal is `out`.
fn slide(normal: vec3<f32>, anchor: vec3<f32>, out: vec3<f32>, curvature_radius: f32) -> vec3<f32> {
    // The centre of curvature lies no deeper than the centre of mass, as in the solver.
    return (out * dot(normal, out) - normal) * min(curvature_radius, max(dot(anchor, out), 0.0));
}

// The smooth normal at a point of a triangle, interpolated from the corners by barycentric areas.
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
