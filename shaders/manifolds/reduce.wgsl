// Contact reduction: selects the few points that represent a manifold. The deepest, then repeatedly the one farthest
// from those selected, in position and normal. One workgroup per pair. The twin of `src/manifolds/cpu/reduce.rs`.
#import faceoff::agree::agree
#import faceoff::arena::{meshes, words}
#import faceoff::batches::active_pair_of
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
var<workgroup> base: u32;

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
    if thread == 0u {
        base = atomicAdd(&contact_counters[t::STAGED_POINTS], count);
        let fits = base <= limits.staged_points && count <= limits.staged_points - base;
        let pair = active_pairs[active_pair_of(index, constants.xy)];
        let slot = slot_of_pair(pair, setup.a, limits.bodies, limits.planes);
        slots[slot] = t::ContactPair(setup.a, setup.b, base, select(0u, count, fits));
        base = select(t::NOTHING, base, fits);
    }
    workgroupBarrier();
    if base != t::NOTHING && thread < count {
        staged[base + thread] = point(setup, features[chosen[thread]]);
    }
}

// Selects features and returns their number.
fn choose(setup: t::PairSetup, thread: u32) -> u32 {
    let all = setup.feature_count + setup.deep_count + setup.probe_count;
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
    let j = i - setup.feature_count;
    if j < setup.deep_count {
        return setup.first_deep + j;
    }
    return setup.first_probe + j - setup.deep_count;
}

// Reduction to the largest value of all threads; of equal ones, that of the first thread.
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

// The contact point of a feature, in world axes and metres.
fn point(setup: t::PairSetup, feature: t::Feature) -> t::ContactPoint {
    let a = sides::first(setup);
    let b = sides::second(setup);
    var result: t::ContactPoint;
    result.separation = feature.separation / setup.unit;
    result.curvature_radius_a = curvature_radius_of(a, feature.a, feature.vertex, setup.unit);
    result.curvature_radius_b = curvature_radius_of(b, feature.b, feature.vertex, setup.unit);
    let curvature_radius = vec2(result.curvature_radius_a, result.curvature_radius_b) * setup.unit;
    let smoothed = smooth::smoothed(a, b, feature, curvature_radius);
    let normal = rotate(setup.rotation, smoothed.normal);
    result.normal = normal / sqrt(dot(normal, normal));
    result.anchor_a = rotate(setup.rotation, feature.point_a + smoothed.slide_a - a.center) / setup.unit;
    result.anchor_b = rotate(setup.rotation, feature.point_b + smoothed.slide_b - b.center) / setup.unit;
    result.normal_rotation = smoothed.normal_rotation * setup.unit;
    result.face_a = sides::face(a, feature.a);
    result.face_b = sides::face(b, feature.b);
    return result;
}

// Radius of curvature of a body's surface at the feature, metres.
fn curvature_radius_of(side: sides::Side, triangle: u32, vertex: u32, unit: f32) -> f32 {
    let curvature_radius = sides::curvature_radius(side, triangle);
    let is_face = vertex != t::NOTHING && (vertex & t::OF_SECOND) != side.mark;
    // The interior of a face between creases is flat.
    if curvature_radius >= t::FLAT_RADIUS || (is_face && curvature_radius == 0.0) {
        return t::FLAT_RADIUS;
    }
    return curvature_radius * norm1(side.scale) / (3.0 * unit);
}
