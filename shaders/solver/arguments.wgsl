// Solver: how many workgroups its kernels need. A list that is too small, or an interval without length, turns all of them
// into nothing; the memory of impulses stays what it was.
#import faceoff::dispatch::{divide_up, rows}
#import faceoff::solver_math::{finite, finite_vector}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> interval: s::Interval;
// Which of the contact counters hold the numbers of pairs and points; the first slot of arguments.
@group(0) @binding(1) var<uniform> constants: vec4<u32>;
@group(0) @binding(2) var<storage, read> contact_counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> status: array<u32>;
@group(0) @binding(4) var<storage, read_write> counters: array<u32>;
@group(0) @binding(5) var<storage, read_write> arguments: array<u32>;

@compute @workgroup_size(1)
fn main() {
    let pairs = contact_counters[constants.x];
    let points = contact_counters[constants.y];
    counters[s::PAIRS_FOUND] = pairs;
    counters[s::POINTS_FOUND] = points;
    counters[s::SKIPPED] = 0u;
    if pairs > interval.pair_capacity || points > interval.point_capacity || status[t::OVERFLOW] != 0u {
        status[t::OVERFLOW] = 1u;
        counters[s::SKIPPED] = 1u;
    }
    let runs = counters[s::SKIPPED] == 0u
        && interval.h > 0.0
        && finite(interval.h)
        && finite_vector(interval.gravity);
    counters[s::ENTRIES] = select(0u, 2u * pairs, runs);
    if runs {
        counters[s::KEPT_PAIRS] = counters[s::PAIRS];
        counters[s::KEPT_SUBSTEP] = counters[s::SUBSTEP];
        counters[s::PAIRS] = pairs;
        counters[s::POINTS] = points;
        counters[s::SUBSTEP] = bitcast<u32>(interval.h);
    }
    let blocks = divide_up(2u * pairs, 2048u);
    put(s::GROUPS_PER_64_PAIRS, divide_up(pairs, 64u), runs);
    put(s::GROUPS_PER_SORT_BLOCK, blocks, runs);
    put(s::GROUPS_PER_DIGIT_BLOCK, divide_up(256u * blocks, 1024u), runs);
    put(s::GROUPS_PER_64_BODIES, divide_up(interval.bodies, 64u), runs);
    put(s::GROUPS_PER_64_OLD_BODIES, divide_up(interval.old_bodies, 64u), runs);
}

fn put(slot: u32, groups: u32, runs: bool) {
    let r = rows(select(0u, groups, runs));
    let at = 3u * (constants.z + slot);
    arguments[at] = r.x;
    arguments[at + 1u] = r.y;
    arguments[at + 2u] = r.z;
}
