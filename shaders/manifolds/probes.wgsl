#define_import_path faceoff::probes

// Rays out of a patch along its normal, to where they leave the two bodies. The twin of `src/manifolds/cpu/ray.rs`.

#import faceoff::arena::{meshes, vector}
#import faceoff::constants::manifolds::RAY_LENGTH
#import faceoff::sides
#import faceoff::tree
#import faceoff::types as t

// Tolerance of a hit in barycentric coordinates, so that no ray slips through an edge.
const SLACK_SINGLE: f32 = 1.0e-5;

// The device aborted a loop.
var<private> rays_unfinished: bool = false;

struct Probe {
    // How far each body extends from the point along the normal: the first body forwards, the second back.
    ways: vec2<f32>,
    // The triangles that the rays hit.
    triangles: vec2<u32>,
    // `DROPPED` if a ray does not leave its body.
    separation: f32,
}

// Casts two rays along n through p. They start slightly before p, because rounding may put p outside where the bodies
// only touch.
fn cast_through(a: sides::Side, b: sides::Side, n: vec3<f32>, p: vec3<f32>, setup: t::PairSetup) -> Probe {
    var probe: Probe;
    probe.separation = t::DROPPED;
    let back = setup.touch;
    let max_distance = RAY_LENGTH * setup.size + back;
    let up = exit(a, 0u, p - n * back, n, max_distance);
    if up.triangle == t::NOTHING {
        return probe;
    }
    let down = exit(b, 1u, p + n * back, -n, max_distance);
    if down.triangle == t::NOTHING {
        return probe;
    }
    probe.ways = vec2(up.distance, down.distance) - back;
    probe.triangles = vec2(up.triangle, down.triangle);
    probe.separation = 2.0 * back - (up.distance + down.distance);
    return probe;
}

struct Exit {
    distance: f32,
    triangle: u32,
}

// Distance and triangle of the first hit of the ray from `start` along the unit vector `direction`. The triangle is
// `NOTHING` if the hit is farther than `max_distance` or the ray does not leave the body there. `end` is the body's
// position in the pair.
fn exit(side: sides::Side, end: u32, start: vec3<f32>, direction: vec3<f32>, max_distance: f32) -> Exit {
    // In the body's own axes, scaled.
    let origin = sides::to_own(side, start);
    let along = direction * side.rotation;
    // Keeps the reciprocal finite.
    let inverse = 1.0 / select(along, vec3(1.0e-12), abs(along) < vec3(1.0e-12));
    let whole = abs(side.scale) * meshes[side.mesh].box_half;
    let pad = 4.0e-6 * (whole.x + whole.y + whole.z);
    var nearest = Exit(max_distance, t::NOTHING);
    let levels = meshes[side.mesh].levels;
    var walk = tree::walk(levels);
    while !walk.is_done {
        var opened = 0u;
        for (var k = 0u; walk.is_new && k < 8u; k += 1u) {
            let child = 8u * walk.number + k;
            if walk.level == 0u {
                if child < side.triangle_count {
                    let distance = meets(side, child, origin, along);
                    if distance < nearest.distance {
                        nearest = Exit(distance, child);
                    }
                }
            } else {
                let at = tree::box_of(end, tree::node(walk.level - 1u, child));
                if at != 0u && passes(side, at, origin, inverse, pad, nearest.distance) {
                    opened |= 1u << k;
                }
            }
        }
        walk = tree::advance(walk, levels, opened);
    }
    rays_unfinished = rays_unfinished || !walk.is_done;
    if nearest.triangle != t::NOTHING && dot(direction, sides::baked_normal(side, nearest.triangle)) <= 0.0 {
        nearest.triangle = t::NOTHING;
    }
    return nearest;
}

// Whether the ray meets a box within `max_distance`.
fn passes(side: sides::Side, at: u32, origin: vec3<f32>, inverse: vec3<f32>, pad: f32, max_distance: f32) -> bool {
    let apart = side.scale * vector(at) - origin;
    let half = abs(side.scale) * vector(at + 3u) + pad;
    let s = (apart - half) * inverse;
    let e = (apart + half) * inverse;
    let low = min(s, e);
    let high = max(s, e);
    let enter = max(0.0, max(low.x, max(low.y, low.z)));
    let leaves = min(max_distance, min(high.x, min(high.y, high.z)));
    return enter <= leaves + 1.0e-6 * (abs(enter) + abs(leaves)) + pad;
}

// Distance at which the ray hits the triangle; `DROPPED` if it misses.
fn meets(side: sides::Side, number: u32, origin: vec3<f32>, direction: vec3<f32>) -> f32 {
    let at = side.triangles + 9u * number;
    let a = side.scale * vector(at) - origin;
    let ab = side.scale * vector(at + 3u) - origin - a;
    let ac = side.scale * vector(at + 6u) - origin - a;
    let normal = cross(ab, ac);
    let slope = dot(direction, normal);
    if slope * slope <= 1.0e-12 * dot(normal, normal) {
        return t::DROPPED;
    }
    let moment = cross(a, direction);
    let v = dot(moment, ac) / slope;
    let w = -dot(moment, ab) / slope;
    let distance = dot(a, normal) / slope;
    if v >= -SLACK_SINGLE && w >= -SLACK_SINGLE && v + w <= 1.0 + SLACK_SINGLE && distance >= 0.0 {
        return distance;
    }
    return t::DROPPED;
}
