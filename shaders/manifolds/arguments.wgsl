// Contact generation, first for each batch of pairs: workgroup counts of its kernels.
#import faceoff::batches::{contact_counters, end_batch, pairs_in}
#import faceoff::constants::shared::SCAN_BLOCK
#import faceoff::dispatch::{divide_up, rows}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> limits: t::ContactLimits;
@group(0) @binding(2) var<storage, read_write> contact_arguments: array<u32>;
@group(0) @binding(3) var<storage, read_write> near_arguments: array<u32>;
// x: number of the batch. y: number of batches.
@group(0) @binding(4) var<uniform> constants: vec4<u32>;
@group(0) @binding(5) var<uniform> step: t::Step;

@compute @workgroup_size(1)
fn main() {
    end_batch();
    let pairs = pairs_in(constants.xy);
    contact_counters[t::BATCH_PAIRS] = pairs;
    // One slot per pair of all batches, and one per body and half-space.
    let all_slots = contact_counters[t::MARGIN_PAIRS] + limits.bodies * limits.planes;
    let slots = select(all_slots, 0u, step.is_over != 0u);
    contact_counters[t::CONTACT_SLOTS] = slots;
    set_rows(t::GROUPS_PER_BATCH_PAIR, pairs);
    set_rows(t::GROUPS_PER_64_BATCH_PAIRS, divide_up(pairs, 64u));
    set_rows(t::GROUPS_PER_64_SLOTS, divide_up(slots, 64u));
    set_rows(t::GROUPS_PER_SLOT_BLOCK, divide_up(slots, SCAN_BLOCK));
    // Pairs of large meshes raise these.
    for (var search = 0u; search < 2u; search += 1u) {
        near_arguments[3u * search] = 0u;
        near_arguments[3u * search + 1u] = 0u;
        near_arguments[3u * search + 2u] = 1u;
    }
}

fn set_rows(slot: u32, groups: u32) {
    let all = rows(groups);
    contact_arguments[3u * slot] = all.x;
    contact_arguments[3u * slot + 1u] = all.y;
    contact_arguments[3u * slot + 2u] = all.z;
}
