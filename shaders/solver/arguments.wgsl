// Solver: workgroup counts of its kernels. They are all zero if a list is too short or the collision substep has no
// length; saved impulses then stay as they are.
#import faceoff::constants::shared::{DIGITS, SCAN_BLOCK, SORT_BLOCK}
#import faceoff::dispatch::{divide_up, rows}
#import faceoff::paces::paces
#import faceoff::solver_math::{finite, finite_vector}
#import faceoff::solver_types as s
#import faceoff::types as t

@group(0) @binding(0) var<uniform> collision_substep: s::CollisionSubstep;
@group(0) @binding(2) var<storage, read> contact_counters: array<u32>;
@group(0) @binding(3) var<storage, read_write> status: array<u32>;
@group(0) @binding(4) var<storage, read_write> solver_counters: array<u32>;
@group(0) @binding(5) var<storage, read_write> solver_arguments: array<u32>;

@compute @workgroup_size(1)
fn main() {
    let pairs = contact_counters[t::CONTACT_PAIRS];
    let points = contact_counters[t::CONTACT_POINTS];
    solver_counters[s::PAIRS_FOUND] = pairs;
    solver_counters[s::POINTS_FOUND] = points;
    solver_counters[s::SKIPPED] = 0u;
    solver_counters[s::SMALL_ISLANDS] = 0u;
    solver_counters[s::LARGE_ISLANDS] = 0u;
    if pairs > collision_substep.pair_capacity
        || points > collision_substep.point_capacity
        || status[t::OVERFLOW] != 0u {
        status[t::OVERFLOW] = 1u;
        solver_counters[s::SKIPPED] = 1u;
    }
    let runs = solver_counters[s::SKIPPED] == 0u
        && collision_substep.paces > 0u
        && paces[0].h > 0.0
        && finite(paces[0].h)
        && finite_vector(collision_substep.gravity);
    solver_counters[s::ENTRIES] = select(0u, pairs, runs);
    if runs {
        solver_counters[s::SAVED_PAIRS] = solver_counters[s::PAIRS];
        solver_counters[s::PAIRS] = pairs;
        solver_counters[s::POINTS] = points;
    }
    let blocks = divide_up(pairs, SORT_BLOCK);
    put(s::GROUPS_PER_64_PAIRS, divide_up(pairs, 64u), runs);
    put(s::GROUPS_PER_SORT_BLOCK, blocks, runs);
    put(s::GROUPS_PER_DIGIT_BLOCK, divide_up(DIGITS * blocks, SCAN_BLOCK), runs);
    put(s::GROUPS_PER_64_BODIES, divide_up(collision_substep.bodies, 64u), runs);
    put(s::GROUPS_PER_64_OLD_BODIES, divide_up(collision_substep.old_bodies, 64u), runs);
}

fn put(slot: u32, groups: u32, runs: bool) {
    let r = rows(select(0u, groups, runs));
    let at = 3u * slot;
    solver_arguments[at] = r.x;
    solver_arguments[at + 1u] = r.y;
    solver_arguments[at + 2u] = r.z;
}
