// Contact generation: drops speculative points that do not count, because the surfaces do not meet there. One workgroup
// per pair of bodies, one thread per feature. The twin of `src/manifolds/cpu/arrival.rs`.
//
// A point ahead of a body lies on the plane through the other body's face, and the solver lets nothing cross that
// plane. A body that flies past a convex edge crosses it beyond the edge, where there is no surface. So a point counts
// if the surfaces do not arrive within the collision substep, or if they arrive on the surface.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::constants::manifolds::ARRIVAL_TOLERANCE
#import faceoff::dispatch::group_index
#import faceoff::pair_motion::{PairMotion, bodies, motion_of, step, way_at}
#import faceoff::sides
#import faceoff::surface::{is_near, surface_unfinished}
#import faceoff::tree
#import faceoff::types as t

@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> pair_setups: array<t::PairSetup>;
@group(0) @binding(6) var<storage, read_write> features: array<t::Feature>;

var<workgroup> any_dropped: atomic<u32>;

// A feature that may arrive: the relative displacement of the second body there until the surfaces meet; the remaining
// gap; and how far the path may leave the straight line.
struct Course {
    way: vec3<f32>,
    left: f32,
    error: f32,
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    // Only steps with a solver have substeps.
    let count = agree(thread, setup.feature_count + setup.nearest_count);
    if agree(thread, u32(setup.valid == 0u || step.substeps == 0u || count == 0u)) == 1u {
        return;
    }
    let a = sides::first(setup);
    let b = sides::second(setup);
    if thread < 2u {
        tree::survey(thread, select(a.mesh, b.mesh, thread == 1u));
    }
    if thread == 0u {
        atomicStore(&any_dropped, 0u);
    }
    workgroupBarrier();
    let motion = motion_of(setup);
    var i = thread;
    while i < count {
        var at = setup.first_feature + i;
        if i >= setup.feature_count {
            at = setup.first_nearest + i - setup.feature_count;
        }
        var feature = features[at];
        let is_known = feature.separation != t::DROPPED;
        // The gap between the rounded surfaces.
        feature.separation -= sides::rounding(a, b);
        if is_known && !does_count(setup, a, b, motion, feature) {
            features[at].separation = t::DROPPED;
            atomicStore(&any_dropped, 1u);
        }
        i += 64u;
    }
    // Some devices abort long loops.
    if i < count || surface_unfinished {
        atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
    }
    workgroupBarrier();
    if thread == 0u {
        pair_setups[index].has_dropped = atomicLoad(&any_dropped);
    }
}

fn kind_of(feature: t::Feature) -> u32 {
    return feature.origin & t::ORIGIN_MASK;
}

// Whether the vertex of a feature belongs to the second body.
fn is_of_second(feature: t::Feature) -> bool {
    return (feature.origin & t::VERTEX_OF_SECOND) != 0u;
}

// Whether the solver may act on a feature.
fn does_count(setup: t::PairSetup, a: sides::Side, b: sides::Side, motion: PairMotion, feature: t::Feature) -> bool {
    if feature.separation <= motion.rest_offset || is_round(a, b, feature) {
        return true;
    }
    let kind = kind_of(feature);
    var at = 0.5 * (feature.point_a + feature.point_b);
    if kind == t::OF_VERTEX || kind == t::OF_VERTEX_EDGE {
        at = select(feature.point_a, feature.point_b, is_of_second(feature));
    }
    let way = way_at(a, b, motion, at);
    // What carries a body is not known here. The point must arrive on the surface in either case.
    let closing = -dot(feature.normal, way);
    let falling = -dot(feature.normal, motion.fall);
    if closing + max(falling, 0.0) <= feature.separation - motion.rest_offset {
        return true;
    }
    var arrived = true;
    // Twice in a loop, so that compilers do not write it twice.
    for (var falls = 0u; falls < 2u && arrived; falls += 1u) {
        arrived = arrives(setup, a, b, motion, feature, at, way + motion.fall * f32(falls));
    }
    return arrived;
}

// Whether both surfaces are smooth and convex at the feature. The solver rotates the normal of their contact as they
// pass each other.
fn is_round(a: sides::Side, b: sides::Side, feature: t::Feature) -> bool {
    return sides::max_curvature_radius_at(a, feature.a, feature.origin) < t::FLAT_RADIUS
        && sides::max_curvature_radius_at(b, feature.b, feature.origin) < t::FLAT_RADIUS;
}

// Whether a feature at a point arrives on the surface, or not at all.
fn arrives(
    setup: t::PairSetup, a: sides::Side, b: sides::Side, motion: PairMotion, feature: t::Feature, at: vec3<f32>, way: vec3<f32>
) -> bool {
    let gap = feature.separation;
    let closing = -dot(feature.normal, way);
    if closing <= gap - motion.rest_offset {
        return true;
    }
    // Both times are fractions of the motion.
    let time = min(gap / closing, 1.0);
    let course = Course(time * way, max(gap - time * closing, 0.0), time * time * deviation(a, b, motion, at));
    let tolerance = ARRIVAL_TOLERANCE * motion.rest_offset + setup.rounding;
    let kind = kind_of(feature);
    let of_second = is_of_second(feature);
    if kind == t::OF_EDGES {
        return edges_cross(a, b, feature, course, tolerance);
    }
    // Surfaces touch while the cores are as far apart as both roundings.
    let apart = course.left + sides::rounding(a, b);
    if kind == t::OF_VERTICES {
        return is_on(a, 0u, feature.point_b + course.way, apart, course.error, tolerance);
    }
    if of_second {
        let place = feature.point_b + course.way;
        return (kind == t::OF_VERTEX && is_over(a, feature.a, place, course.error))
            || is_on(a, 0u, place, apart, course.error, tolerance);
    }
    let place = feature.point_a - course.way;
    return (kind == t::OF_VERTEX && is_over(b, feature.b, place, course.error))
        || is_on(b, 1u, place, apart, course.error, tolerance);
}

// Bound of how far the path of a point leaves its straight way, in the axes of either body.
fn deviation(a: sides::Side, b: sides::Side, motion: PairMotion, p: vec3<f32>) -> f32 {
    let turn_a = length(motion.turn_a);
    let turn_b = length(motion.turn_b);
    let round_a = turn_a * length(p - a.center);
    let round_b = turn_b * length(p - b.center);
    return 0.5 * (turn_a * round_a + turn_b * round_b) + max(turn_a, turn_b) * (length(motion.travel) + round_a + round_b);
}

// Whether a point projects into a triangle, and no nearer to its edges than by the error.
fn is_over(side: sides::Side, number: u32, place: vec3<f32>, error: f32) -> bool {
    let over = sides::triangle(side, number);
    let start = sides::corner(side, number, 0u);
    let foot = place - over.normal * dot(over.normal, place - start);
    for (var k = 0u; k < 3u; k += 1u) {
        let corner = sides::corner(side, number, k);
        let edge = sides::corner(side, number, (k + 1u) % 3u) - corner;
        if dot(cross(edge, foot - corner), over.normal) * over.winding_sign < error * length(edge) {
            return false;
        }
    }
    return true;
}

// Whether two edges still cross when they arrive. Where one of them has ended, another may continue it.
fn edges_cross(a: sides::Side, b: sides::Side, feature: t::Feature, course: Course, tolerance: f32) -> bool {
    let k = (feature.origin >> t::FIRST_EDGE_SHIFT) & 3u;
    let l = (feature.origin >> t::SECOND_EDGE_SHIFT) & 3u;
    let start_a = sides::corner(a, feature.a, k);
    let along_a = sides::corner(a, feature.a, (k + 1u) % 3u) - start_a;
    let start_b = sides::corner(b, feature.b, l);
    let along_b = sides::corner(b, feature.b, (l + 1u) % 3u) - start_b;
    let offset = start_b + course.way - start_a;
    let normal = cross(along_a, along_b);
    let square = dot(normal, normal);
    if square == 0.0 {
        return false;
    }
    let at = vec2(dot(cross(offset, along_b), normal), dot(cross(offset, along_a), normal)) / square;
    let margin = course.error / vec2(length(along_a), length(along_b));
    if all(at >= margin) && all(at <= 1.0 - margin) {
        return true;
    }
    let place = start_a + along_a * at.x;
    return is_on(a, 0u, place, course.left, course.error, tolerance)
        && is_on(b, 1u, place - course.way, course.left, course.error, tolerance);
}

// Whether a point lies on a side's core, or no farther above it than this.
fn is_on(side: sides::Side, end: u32, p: vec3<f32>, apart: f32, error: f32, tolerance: f32) -> bool {
    return error <= tolerance && is_near(side, end, p, apart + tolerance);
}
