// Contact generation, selection of pairs, last of three kernels: the pairs in ascending order, with margins. Contact
// points are found for active pairs only, which are listed in any order; the others have empty slots at first. One
// thread per pair.
#import faceoff::contact_slots::slot_of_pair
#import faceoff::dispatch::group_index
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read> counters: array<u32>;
@group(0) @binding(2) var<storage, read> bodies: array<t::Body>;
@group(0) @binding(3) var<storage, read> near_pairs: array<t::NearPair>;
@group(0) @binding(4) var<storage, read> values: array<u32>;
@group(0) @binding(5) var<storage, read_write> margin_pairs: array<t::MarginPair>;
// Cleared before.
@group(0) @binding(6) var<storage, read_write> contact_counters: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> active_pairs: array<u32>;
@group(0) @binding(8) var<storage, read_write> slots: array<t::ContactPair>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let i = group_index(group) * 64u + thread;
    let count = counters[t::SELECTED];
    if i >= count {
        return;
    }
    if i == 0u {
        atomicStore(&contact_counters[t::MARGIN_PAIRS], count);
    }
    let pair = near_pairs[values[i]];
    let a = bodies[pair.a];
    let b = bodies[pair.b];
    margin_pairs[i] = t::MarginPair(pair.a, pair.b, pair.margin, 0u);
    if a.inactive == 0u || b.inactive == 0u {
        active_pairs[atomicAdd(&contact_counters[t::ACTIVE_PAIRS], 1u)] = i;
    } else {
        slots[slot_of_pair(i, pair.a, step.bodies, step.planes)] = t::ContactPair(pair.a, pair.b, 0u, 0u);
    }
}
