// Contact reduction: selects the few points that represent a manifold. The deepest, then repeatedly the one farthest
// from those selected, in position and normal. One workgroup per pair. The twin of `src/manifolds/cpu/reduce.rs`.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::batches::active_pair_of
#import faceoff::constants::manifolds::SAME_CONTACT
#import faceoff::constants::reduce::{MIN_WEIGHT, MAX_POINTS, DUPLICATE, DEPTH_SCALE, NORMAL_WEIGHT}
#import faceoff::contact_slots::slot_of_pair
#import faceoff::dispatch::group_index
#import faceoff::math::{norm1, rotate}
#import faceoff::sides
#import faceoff::smooth
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> pair_setups: array<t::PairSetup>;
@group(0) @binding(5) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(6) var<storage, read_write> staged: array<t::ContactPoint>;
@group(0) @binding(7) var<storage, read_write> slots: array<t::ContactPair>;
// x: number of the batch. y: number of batches.
@group(0) @binding(8) var<uniform> constants: vec4<u32>;
@group(0) @binding(9) var<storage, read> active_pairs: array<u32>;

var<workgroup> best: array<f32, 64>;
var<workgroup> best_at: array<u32, 64>;
var<workgroup> chosen: array<u32, 16>;
// The points of the chosen features and of round surfaces, and their places in the manifold.
var<workgroup> anchors: array<vec3<f32>, 16>;
var<workgroup> normals: array<vec3<f32>, 16>;
var<workgroup> states: array<u32, 16>;
var<workgroup> places: array<u32, 16>;
var<workgroup> base: u32;

const DISTINCT: u32 = 0u;
const ROUND: u32 = 1u;
const ELSEWHERE: u32 = 2u;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= agree(thread, atomicLoad(&contact_counters[t::BATCH_PAIRS])) {
        return;
    }
    let setup = pair_setups[index];
    var count = 0u;
    if setup.valid != 0u {
        count = choose(setup, thread);
    }
    var own: Point;
    if thread < count {
        own = point(setup, chosen[thread]);
        anchors[thread] = own.point.anchor_a;
        normals[thread] = own.point.normal;
        states[thread] = own.state;
    }
    workgroupBarrier();
    if thread == 0u {
        let kept = keep(setup, count);
        base = atomicAdd(&contact_counters[t::STAGED_POINTS], kept);
        let fits = base <= limits.staged_points && kept <= limits.staged_points - base;
        let pair = active_pairs[active_pair_of(index, constants.xy)];
        let slot = slot_of_pair(pair, setup.a, limits.bodies, limits.planes);
        slots[slot] = t::ContactPair(setup.a, setup.b, base, select(0u, kept, fits));
        base = select(t::NOTHING, base, fits);
    }
    workgroupBarrier();
    if base != t::NOTHING && thread < count && places[thread] != t::NOTHING {
        staged[base + places[thread]] = own.point;
    }
}

// Gives the points their places, and returns the number of kept points. A smooth surface has one point where it
// touches, not one per nearby vertex.
fn keep(setup: t::PairSetup, count: u32) -> u32 {
    let close = SAME_CONTACT * setup.size / setup.unit;
    var kept = 0u;
    for (var i = 0u; i < count; i += 1u) {
        var is_kept = states[i] != ELSEWHERE;
        if states[i] == ROUND {
            for (var k = 0u; k < i; k += 1u) {
                if places[k] != t::NOTHING
                    && distance(normals[k], normals[i]) < SAME_CONTACT
                    && distance(anchors[k], anchors[i]) < close {
                    is_kept = false;
                }
            }
        }
        places[i] = select(t::NOTHING, kept, is_kept);
        kept += u32(is_kept);
    }
    if kept == 0u && count > 0u {
        places[0] = 0u;
        kept = 1u;
    }
    return kept;
}

// Selects features and returns their number.
fn choose(setup: t::PairSetup, thread: u32) -> u32 {
    let all = setup.feature_count + setup.nearest_count + setup.deep_count + setup.probe_count + setup.meeting_count;
    var best_value = -t::DROPPED;
    var place = t::NOTHING;
    for (var i = thread; i < all; i += 64u) {
        let at = feature_at(setup, i);
        let separation = features[at].separation;
        features[at].distance = t::DROPPED;
        if separation != t::DROPPED && -separation > best_value {
            best_value = -separation;
            place = at;
        }
    }
    greatest(best_value, place, thread);
    let deepest = -best[0];
    var last = workgroupUniformLoad(&best_at[0]);
    var count = 0u;
    while last != t::NOTHING {
        if thread == 0u {
            chosen[count] = last;
        }
        count += 1u;
        if count == MAX_POINTS {
            break;
        }
        let p = features[last].point_a;
        let n = features[last].normal;
        best_value = 0.0;
        place = t::NOTHING;
        var i = thread;
        while i < all {
            let at = feature_at(setup, i);
            i += 64u;
            let separation = features[at].separation;
            if separation == t::DROPPED {
                continue;
            }
            let offset = (features[at].point_a - p) / setup.size;
            let normal_change = features[at].normal - n;
            let squared = dot(offset, offset) + NORMAL_WEIGHT * dot(normal_change, normal_change);
            let distance = min(features[at].distance, squared);
            features[at].distance = distance;
            if distance <= DUPLICATE {
                continue;
            }
            let shallower = (separation - deepest) / (DEPTH_SCALE * setup.size);
            let weighted = distance * max(exp(-shallower), MIN_WEIGHT);
            if weighted > best_value {
                best_value = weighted;
                place = at;
            }
        }
        // Some devices abort long loops.
        if i < all {
            atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
        }
        greatest(best_value, place, thread);
        last = workgroupUniformLoad(&best_at[0]);
    }
    return count;
}

// Index of the pair's i-th feature.
fn feature_at(setup: t::PairSetup, i: u32) -> u32 {
    if i < setup.feature_count {
        return setup.first_feature + i;
    }
    var j = i - setup.feature_count;
    if j < setup.nearest_count {
        return setup.first_nearest + j;
    }
    j -= setup.nearest_count;
    if j < setup.deep_count {
        return setup.first_deep + j;
    }
    j -= setup.deep_count;
    if j < setup.probe_count {
        return setup.first_probe + j;
    }
    return setup.first_meeting;
}

// Reduction to the largest value of all threads; among equal ones, the first thread's.
fn greatest(value: f32, place: u32, thread: u32) {
    best[thread] = value;
    best_at[thread] = place;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half && best_at[thread + half] != t::NOTHING
            && (best_at[thread] == t::NOTHING || best[thread + half] > best[thread]) {
            best[thread] = best[thread + half];
            best_at[thread] = best_at[thread + half];
        }
        workgroupBarrier();
    }
}

// A contact point, and whether it is one of round surfaces or stands for one that touches elsewhere.
struct Point {
    point: t::ContactPoint,
    state: u32,
}

// The contact point of the feature at an index, in world axes and metres.
fn point(setup: t::PairSetup, at: u32) -> Point {
    let feature = features[at];
    let a = sides::first(setup);
    let b = sides::second(setup);
    let face_radii = vec2(
        curvature_radius_of(a, feature.a, feature.vertex),
        curvature_radius_of(b, feature.b, feature.vertex),
    );
    var smoothed: smooth::Smoothed;
    // A point of first contact stays where the meshes touch.
    if setup.meeting_count > 0u && at == setup.first_meeting {
        smoothed.normal = feature.normal;
    } else {
        smoothed = smooth::smoothed(a, b, feature, face_radii, setup.spin);
    }
    let own = smoothed.normal;
    var result: t::ContactPoint;
    result.separation = (feature.separation - sides::rounding(a, b)) / setup.unit;
    result.bulge = (smoothed.bulge_a + smoothed.bulge_b) / setup.unit;
    result.curvature_radius_a = in_metres(smoothed.radius_a + a.rounded, setup.unit);
    result.curvature_radius_b = in_metres(smoothed.radius_b + b.rounded, setup.unit);
    let normal = rotate(setup.rotation, own);
    result.normal = normal / sqrt(dot(normal, normal));
    let on_a = feature.point_a + (smoothed.slide_a + own * (smoothed.bulge_a + a.rounded)) - a.center;
    let on_b = feature.point_b + (smoothed.slide_b - own * (smoothed.bulge_b + b.rounded)) - b.center;
    result.anchor_a = rotate(setup.rotation, on_a) / setup.unit;
    result.anchor_b = rotate(setup.rotation, on_b) / setup.unit;
    result.normal_rotation = smoothed.normal_rotation * setup.unit;
    result.face_a = sides::face(a, feature.a);
    result.face_b = sides::face(b, feature.b);
    let is_round = is_curved(result.curvature_radius_a) || is_curved(result.curvature_radius_b);
    return Point(result, select(select(DISTINCT, ROUND, is_round), ELSEWHERE, smoothed.elsewhere));
}

fn is_curved(radius: f32) -> bool {
    return radius > 0.0 && radius < t::FLAT_RADIUS;
}

// A radius of curvature in metres. That of a flat surface stays.
fn in_metres(radius: f32, unit: f32) -> f32 {
    return select(radius / unit, t::FLAT_RADIUS, radius >= t::FLAT_RADIUS);
}

// Radius of curvature of a body's surface at the feature.
fn curvature_radius_of(side: sides::Side, triangle: u32, vertex: u32) -> f32 {
    let curvature_radius = sides::curvature_radius(side, triangle);
    let is_face = vertex != t::NOTHING && (vertex & t::OF_SECOND) != side.mark;
    // The interior of a face between creases is flat.
    if curvature_radius >= t::FLAT_RADIUS || (is_face && curvature_radius == 0.0) {
        return t::FLAT_RADIUS;
    }
    return curvature_radius * norm1(side.scale) / 3.0;
}
