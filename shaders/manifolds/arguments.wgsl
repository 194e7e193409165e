// Contact generation, before all else: how many workgroups each kernel takes.
#import faceoff::dispatch::{divide_up, rows}
#import faceoff::scan::BLOCK
#import faceoff::types as t

@group(0) @binding(0) var<uniform> limits: t::ContactLimits;
@group(0) @binding(1) var<storage, read_write> counters: array<u32>;
@group(0) @binding(2) var<storage, read_write> arguments: array<u32>;

@compute @workgroup_size(1)
fn main() {
    let pairs = counters[t::MARGIN_PAIRS];
    // Every pair has a slot, and every body one for each half-space.
    let slots = pairs + limits.bodies * limits.planes;
    counters[t::CONTACT_SLOTS] = slots;
    set_rows(t::GROUPS_PER_MARGIN_PAIR, pairs);
    set_rows(t::GROUPS_PER_64_MARGIN_PAIRS, divide_up(pairs, 64u));
    set_rows(t::GROUPS_PER_64_SLOTS, divide_up(slots, 64u));
    set_rows(t::GROUPS_PER_SLOT_BLOCK, divide_up(slots, BLOCK));
}

fn set_rows(slot: u32, groups: u32) {
    let all = rows(groups);
    arguments[3u * slot] = all.x;
    arguments[3u * slot + 1u] = all.y;
    arguments[3u * slot + 2u] = all.z;
}
