// Contact generation: the first contact of a pair whose speculative points were dropped because the bodies fly past
// each other there. The pair may meet elsewhere: at an edge or a corner without a point. If it does within the
// collision substep, it gets the point at which the surfaces touch first, with the normal of that moment. One workgroup
// per pair of bodies, one thread per pair of triangles. The twin of `src/ccd/first_contact.rs`, for the triangles
// within the margin, and for colliders that turn about their own centres.
//
// Conservative advancement: two triangles cannot touch before their distance over a bound of their approach speed along
// it.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::closest::{Nearest, of_triangles}
#import faceoff::constants::manifolds::ARRIVAL_TOLERANCE
#import faceoff::dispatch::group_index
#import faceoff::math::{conjugate, direction, rotate}
#import faceoff::near_ranges::{range_count, range_of}
#import faceoff::pair_motion::{PairMotion, bodies, motion_of, turned}
#import faceoff::sides
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> pair_setups: array<t::PairSetup>;
@group(0) @binding(5) var<storage, read> near_triangles: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read_write> features: array<t::Feature>;

// Triangles that need more rounds slide along each other.
const MAX_ADVANCES: u32 = 32u;
// Least tolerance, in units of the rounding.
const MIN_ROUNDINGS: f32 = 8.0;

// The earliest time of each thread, and the number of its pair of triangles.
var<workgroup> times: array<f32, 64>;
var<workgroup> numbers: array<u32, 64>;

// Where this thread's triangles touch first.
var<private> first_time: f32;
var<private> first_number: u32;
var<private> first_at: u32;
var<private> first_points: Nearest;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    // Bodies that cross have met.
    if agree(thread, u32(setup.valid == 0u || setup.has_dropped == 0u || setup.segment_count > 0u)) == 1u {
        return;
    }
    let a = sides::first(setup);
    let b = sides::second(setup);
    let motion = motion_of(setup);
    let tolerance = max(ARRIVAL_TOLERANCE * motion.rest_offset, MIN_ROUNDINGS * setup.rounding);
    first_time = t::DROPPED;
    first_number = t::NOTHING;
    let ranges = range_count(setup, atomicLoad(&contact_counters[t::NEAR_PIECES]), limits.pieces);
    var before = 0u;
    for (var i = 0u; i < ranges; i += 1u) {
        let range = range_of(setup, i);
        for (var k = thread; k < range.y; k += 64u) {
            advance(a, b, motion, range.x + k, before + k, tolerance);
        }
        before += range.y;
    }
    times[thread] = first_time;
    numbers[thread] = first_number;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            let other = times[thread + half];
            let earlier = other < times[thread]
                || (other == times[thread] && numbers[thread + half] < numbers[thread]);
            if earlier {
                times[thread] = other;
                numbers[thread] = numbers[thread + half];
            }
        }
        workgroupBarrier();
    }
    if first_number != t::NOTHING && first_number == numbers[0] {
        write_point(index, a, b, motion);
    }
}

// Advances two triangles until they touch, unless others of this thread do before.
fn advance(a: sides::Side, b: sides::Side, motion: PairMotion, at: u32, number: u32, tolerance: f32) {
    let triangles = near_triangles[at].xy;
    let corners_a = corners_of(a, triangles.x);
    let corners_b = corners_of(b, triangles.y);
    let spin = length(motion.turn_a) * arm(corners_a) + length(motion.turn_b) * arm(corners_b);
    var time = 0.0;
    var is_met = false;
    var points: Nearest;
    for (var round = 0u; round < MAX_ADVANCES && time <= 1.0 && time < first_time && !is_met; round += 1u) {
        let now = turned(motion, time);
        let center_b = b.center + motion.travel * time;
        points = of_triangles(moved(corners_a, now.a, a.center), moved(corners_b, now.b, center_b));
        let distance = sqrt(points.square);
        // The gap between the rounded surfaces.
        let apart = distance - sides::rounding(a, b);
        if apart <= tolerance {
            // Contacts hold what is as near as that from the start.
            is_met = round > 0u;
            time = select(t::DROPPED, time, is_met);
        } else {
            let approach = -dot(points.q - points.p, motion.travel) / distance;
            let speed = max(approach, 0.0) + spin;
            // Half of the tolerance, so that it arrives.
            let gap = apart - 0.5 * tolerance;
            time = select(t::DROPPED, time + gap / speed, gap < speed);
        }
    }
    if is_met && time < first_time {
        first_time = time;
        first_number = number;
        first_at = at;
        first_points = points;
    }
}

// The corners, relative to the centre of mass.
fn corners_of(side: sides::Side, number: u32) -> mat3x3<f32> {
    return mat3x3(
        sides::corner(side, number, 0u) - side.center,
        sides::corner(side, number, 1u) - side.center,
        sides::corner(side, number, 2u) - side.center,
    );
}

// The largest distance of corners from the centre of mass.
fn arm(corners: mat3x3<f32>) -> f32 {
    return max(length(corners[0]), max(length(corners[1]), length(corners[2])));
}

fn moved(corners: mat3x3<f32>, turn: vec4<f32>, center: vec3<f32>) -> mat3x3<f32> {
    return mat3x3(
        center + rotate(turn, corners[0]), center + rotate(turn, corners[1]), center + rotate(turn, corners[2])
    );
}

// Adds the point of first contact.
fn write_point(index: u32, a: sides::Side, b: sides::Side, motion: PairMotion) {
    let at = atomicAdd(&contact_counters[t::FEATURES], 1u);
    if at >= limits.features {
        return;
    }
    let now = turned(motion, first_time);
    let center_b = b.center + motion.travel * first_time;
    var feature: t::Feature;
    // Where they are at the start.
    feature.point_a = a.center + rotate(conjugate(now.a), first_points.p - a.center);
    feature.point_b = b.center + rotate(conjugate(now.b), first_points.q - center_b);
    feature.normal = direction(first_points.q - first_points.p);
    // A rotation may lead a point round to a place from which it does not approach along the normal.
    feature.separation = max(dot(feature.normal, feature.point_b - feature.point_a), sides::rounding(a, b));
    feature.vertex = t::NOTHING;
    feature.origin = t::OF_PATCH;
    feature.a = near_triangles[first_at].x;
    feature.b = near_triangles[first_at].y;
    features[at] = feature;
    pair_setups[index].first_meeting = at;
    pair_setups[index].meeting_count = 1u;
}
