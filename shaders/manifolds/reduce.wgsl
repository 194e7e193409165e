// Contact generation: the few points that say what many say. The deepest, then always the one farthest from those chosen
// before, in position and normal. A workgroup a pair.
#import faceoff::arena::{meshes, words}
#import faceoff::constants::manifolds::{LEAST_WEIGHT, MOST_POINTS, SAME, SHALLOWER, TURN}
#import faceoff::contact_slots::slot_of_pair
#import faceoff::dispatch::group_index
#import faceoff::math::{norm1, rotate}
#import faceoff::sides
#import faceoff::smooth
#import faceoff::types as t

@group(0) @binding(2) var<uniform> limits: t::ContactLimits;
@group(0) @binding(3) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> settings: array<t::ContactSetting>;
@group(0) @binding(5) var<storage, read_write> features: array<t::Feature>;
@group(0) @binding(6) var<storage, read_write> staged: array<t::ContactPoint>;
@group(0) @binding(7) var<storage, read_write> slots: array<t::ContactPair>;

var<workgroup> best: array<f32, 64>;
var<workgroup> best_at: array<u32, 64>;
var<workgroup> chosen: array<u32, 16>;
var<workgroup> base: u32;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let index = group_index(group);
    if index >= atomicLoad(&contact_counters[t::MARGIN_PAIRS]) {
        return;
    }
    let setting = settings[index];
    var count = 0u;
    if setting.valid != 0u {
        count = choose(setting, thread);
    }
    if thread == 0u {
        base = atomicAdd(&contact_counters[t::STAGED_POINTS], count);
        let fits = base <= limits.staged_points && count <= limits.staged_points - base;
        slots[slot_of_pair(index, setting.a, limits.bodies, limits.planes)] =
            t::ContactPair(setting.a, setting.b, base, select(0u, count, fits));
        base = select(t::NOTHING, base, fits);
    }
    workgroupBarrier();
    if base != t::NOTHING && thread < count {
        staged[base + thread] = point(setting, features[chosen[thread]]);
    }
}

// Fills in the list of chosen features, and tells how many.
fn choose(setting: t::ContactSetting, thread: u32) -> u32 {
    let all = setting.feature_count + setting.deep_count + setting.probe_count;
    var most = -t::DROPPED;
    var place = t::NOTHING;
    for (var i = thread; i < all; i += 64u) {
        let at = feature_at(setting, i);
        let separation = features[at].separation;
        features[at].distance = t::DROPPED;
        if separation != t::DROPPED && -separation > most {
            most = -separation;
            place = at;
        }
    }
    greatest(most, place, thread);
    let deepest = -best[0];
    var last = best_at[0];
    workgroupBarrier();
    var count = 0u;
    while last != t::NOTHING {
        if thread == 0u {
            chosen[count] = last;
        }
        count += 1u;
        if count == MOST_POINTS {
            break;
        }
        let p = features[last].point_a;
        let n = features[last].normal;
        most = 0.0;
        place = t::NOTHING;
        var i = thread;
        while i < all {
            let at = feature_at(setting, i);
            i += 64u;
            let separation = features[at].separation;
            if separation == t::DROPPED {
                continue;
            }
            let way = (features[at].point_a - p) / setting.size;
            let turn = features[at].normal - n;
            let distance = min(features[at].distance, dot(way, way) + TURN * dot(turn, turn));
            features[at].distance = distance;
            if distance <= SAME {
                continue;
            }
            let shallower = (separation - deepest) / (SHALLOWER * setting.size);
            let weighted = distance * max(exp(-shallower), LEAST_WEIGHT);
            if weighted > most {
                most = weighted;
                place = at;
            }
        }
        // Some devices leave a loop that takes long.
        if i < all {
            atomicOr(&contact_counters[t::CONTACTS_CUT_SHORT], 1u);
        }
        greatest(most, place, thread);
        last = best_at[0];
        workgroupBarrier();
    }
    return count;
}

// The pair's i-th feature.
fn feature_at(setting: t::ContactSetting, i: u32) -> u32 {
    if i < setting.feature_count {
        return setting.first_feature + i;
    }
    let j = i - setting.feature_count;
    if j < setting.deep_count {
        return setting.first_deep + j;
    }
    return setting.first_probe + j - setting.deep_count;
}

// Brings the greatest of all threads to the front; of equals that of the first thread.
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

// Out of the first body's axes and the pair's unit.
fn point(setting: t::ContactSetting, feature: t::Feature) -> t::ContactPoint {
    let a = sides::first(setting);
    let b = sides::second(setting);
    var result: t::ContactPoint;
    result.separation = feature.separation / setting.unit;
    result.roundness_a = roundness_of(a, feature.a, feature.vertex, setting.unit);
    result.roundness_b = roundness_of(b, feature.b, feature.vertex, setting.unit);
    let roundness = vec2(result.roundness_a, result.roundness_b) * setting.unit;
    let smoothed = smooth::smoothed(a, b, feature, roundness);
    let normal = rotate(setting.rotation, smoothed.normal);
    result.normal = normal / sqrt(dot(normal, normal));
    result.arm_a = rotate(setting.rotation, feature.point_a + smoothed.slide_a - a.center) / setting.unit;
    result.arm_b = rotate(setting.rotation, feature.point_b + smoothed.slide_b - b.center) / setting.unit;
    result.turn = smoothed.turn * setting.unit;
    result.face_a = sides::face(a, feature.a);
    result.face_b = sides::face(b, feature.b);
    return result;
}

// Of a body's surface at the feature, metres.
fn roundness_of(side: sides::Side, triangle: u32, vertex: u32, unit: f32) -> f32 {
    let roundness = sides::roundness(side, triangle);
    let is_face = vertex != t::NOTHING && (vertex & t::OF_SECOND) != side.mark;
    // Between creases a face is flat.
    if roundness >= t::FLAT_ROUNDNESS || (is_face && roundness == 0.0) {
        return t::FLAT_ROUNDNESS;
    }
    return roundness * norm1(side.scale) / (3.0 * unit);
}
