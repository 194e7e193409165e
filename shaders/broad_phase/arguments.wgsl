// BroadPhase: workgroup counts of the kernels over pairs. If the list of pairs is too short the step does nothing; the
// host makes the list longer and repeats it.
#import faceoff::constants::shared::{DIGITS, SCAN_BLOCK, SORT_BLOCK}
#import faceoff::dispatch::{divide_up, rows}
#import faceoff::types as t

@group(0) @binding(0) var<uniform> step: t::Step;
@group(0) @binding(1) var<storage, read_write> status: array<u32>;
@group(0) @binding(2) var<storage, read_write> counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> arguments: array<u32>;
@group(0) @binding(4) var<storage, read_write> piece_arguments: array<u32>;

@compute @workgroup_size(1)
fn main() {
    var pairs = counters[t::SPHERE_PAIRS];
    if pairs > step.pair_capacity || status[t::OVERFLOW] != 0u {
        status[t::OVERFLOW] = 1u;
        counters[t::SKIPPED] = 1u;
        pairs = 0u;
    }
    counters[t::PAIRS] = pairs;
    counters[t::ENTRIES] = 2u * pairs;
    let blocks = divide_up(2u * pairs, SORT_BLOCK);
    put(t::GROUPS_PER_64_PAIRS, divide_up(pairs, 64u));
    put(t::GROUPS_PER_PAIR, pairs);
    put(t::GROUPS_PER_SORT_BLOCK, blocks);
    put(t::GROUPS_PER_DIGIT_BLOCK, divide_up(DIGITS * blocks, SCAN_BLOCK));
    // Pairs of large meshes raise these.
    piece_arguments[0] = 0u;
    piece_arguments[1] = 0u;
    piece_arguments[2] = 1u;
}

fn put(slot: u32, groups: u32) {
    let r = rows(groups);
    arguments[3u * slot] = r.x;
    arguments[3u * slot + 1u] = r.y;
    arguments[3u * slot + 2u] = r.z;
}
