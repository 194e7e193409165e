//! Islands on the GPU: bodies joined by union-find, pairs sorted by island and coloured. Each island is solved by one
//! workgroup in one dispatch.

use super::arguments::{per, per_pair};
use super::buffers::SolverCapacity;
use super::layout::{
    ENTRIES, GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_LARGE_ISLAND, GROUPS_PER_SMALL_ISLAND, GROUPS_PER_SORT_BLOCK,
};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::radix_sort::Sort;

/// Unites the islands of bodies that pairs connect.
pub(super) const ISLAND_JOIN: Kernel = kernel!("solver/island_join");
/// Finds the island of each pair.
pub(super) const ISLAND_KEYS: Kernel = kernel!("solver/island_keys");
/// Lists the islands.
pub(super) const ISLAND_RANGES: Kernel = kernel!("solver/island_ranges");
/// Computes the workgroup counts of the kernels over islands.
pub(super) const ISLAND_ARGUMENTS: Kernel = kernel!("solver/island_arguments");
/// Colours and sorts the pairs of an island.
pub(super) const ISLAND_COLORS: [Kernel; 2] = [
    kernel!("solver/island_colors"),
    kernel!("solver/island_colors", "LARGE"),
];
/// Solves a collision substep of an island.
pub(super) const SUBSTEP: [Kernel; 2] = [kernel!("solver/substep"), kernel!("solver/substep", "LARGE")];

const SORT: Sort = Sort {
    counters: "solver_counters",
    input: ["island_keys", "pair_order"],
    scratch: ["other_island_keys", "other_pair_order"],
    digits: "island_digits",
    sums: "island_sums",
};

/// Adds the calls that find the islands, and those that solve them. The constraints of all pairs are made.
pub(super) fn record(calls: &mut Calls, capacity: &SolverCapacity) {
    calls.call(&ISLAND_JOIN, per_pair());
    calls.call(&ISLAND_KEYS, per_pair());
    let groups = [GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK].map(per);
    let [keys, order] = SORT.record(calls, ENTRIES, capacity.body_bits(), capacity.pairs, groups);
    calls.call(&ISLAND_RANGES, per_pair()).bind("island_keys", keys);
    calls.call(&ISLAND_ARGUMENTS, Groups::Exactly(1));
    let sizes = [GROUPS_PER_SMALL_ISLAND, GROUPS_PER_LARGE_ISLAND].map(per);
    for (kernel, islands) in ISLAND_COLORS.iter().zip(sizes) {
        calls.call(kernel, islands).bind("pair_order", order);
    }
    for (kernel, islands) in SUBSTEP.iter().zip(sizes) {
        calls.call(kernel, islands);
    }
}
