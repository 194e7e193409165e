// Contact generation, last: writes the lists of pairs and points without gaps. One thread per slot.
#import faceoff::batches::{contact_counters, end_batch}
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> limits: t::ContactLimits;
@group(0) @binding(2) var<storage, read> slots: array<t::ContactPair>;
@group(0) @binding(3) var<storage, read> pair_places: array<u32>;
@group(0) @binding(4) var<storage, read> point_places: array<u32>;
@group(0) @binding(5) var<storage, read> staged: array<t::ContactPoint>;
@group(0) @binding(6) var<storage, read_write> contact_pairs: array<t::ContactPair>;
@group(0) @binding(7) var<storage, read_write> contact_points: array<t::ContactPoint>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    if i >= contact_counters[t::CONTACT_SLOTS] {
        return;
    }
    if i == 0u {
        end_batch();
        contact_counters[t::CONTACTS_SKIPPED] = u32(is_worthless());
    }
    let slot = slots[i];
    let place = pair_places[i];
    let first = point_places[i];
    if slot.point_count == 0u || place >= limits.pairs || first + slot.point_count > limits.points {
        return;
    }
    contact_pairs[place] = t::ContactPair(slot.a, slot.b, first, slot.point_count);
    for (var k = 0u; k < slot.point_count; k += 1u) {
        contact_points[first + k] = staged[slot.first_point + k];
    }
}

// Whether a list overflowed or a loop was aborted.
fn is_worthless() -> bool {
    return contact_counters[t::MAX_NEAR_TRIANGLES] > limits.near_triangles
        || contact_counters[t::MAX_NEAR_PIECES] > limits.pieces
        || contact_counters[t::MAX_FEATURES] > limits.features
        || contact_counters[t::MAX_SEGMENTS] > limits.segments
        || contact_counters[t::STAGED_POINTS] > limits.staged_points
        || contact_counters[t::CONTACT_PAIRS] > limits.pairs
        || contact_counters[t::CONTACT_POINTS] > limits.points
        || contact_counters[t::CONTACTS_CUT_SHORT] != 0u;
}
