//! BroadPhase on the GPU: a hashed grid with a level of cells for each power of two of the diameter.
//!
//! Each body searches its own level and the coarser ones that have bodies.

use super::cpu::grid;
use crate::gpu::buffers::Capacity;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::{BODIES, SPHERE_PAIRS};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::radix_sort::{self, Sort};
use crate::gpu::scan::{self, Length, Scan};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Places the bodies at the start of a step.
const PLACE: Kernel = kernel!("broad_phase/place");
/// Places compounds and their colliders.
const PLACE_COMPOUNDS: Kernel = kernel!("broad_phase/place_compounds");
/// Computes the bucket of each body.
const CELLS: Kernel = kernel!("broad_phase/cells");
/// Writes the bodies in the order of their buckets.
const ENTRIES: Kernel = kernel!("broad_phase/entries");
/// Counts the pairs of each body.
pub const COUNT: Kernel = kernel!("broad_phase/pairs");
/// Writes the pairs.
const EMIT: Kernel = kernel!("broad_phase/pairs", "EMIT");
/// Count and write the pairs that can meet within a step.
const COUNT_SWEPT: Kernel = kernel!("broad_phase/pairs", "SWEPT");
const EMIT_SWEPT: Kernel = kernel!("broad_phase/pairs", "EMIT SWEPT");
/// Computes workgroup counts for the following stages.
pub const ARGUMENTS: Kernel = kernel!("broad_phase/arguments");

/// Most pairs that a body finds. In physical space bodies have far fewer: its search looks for bodies that are as large
/// as itself or larger.
const MAX_PARTNERS: u32 = 1 << 14;

const CONSTANTS: Module = shared_constants!("faceoff::constants::broad_phase", {
    f32 SPHERE_SLACK = grid::SPHERE_SLACK;
    u32 MAX_PARTNERS = MAX_PARTNERS;
});

/// This stage's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[CONSTANTS, module!("broad_phase/grid"), module!("broad_phase/sweep")],
    kernels: &[
        &PLACE,
        &PLACE_COMPOUNDS,
        &CELLS,
        &ENTRIES,
        &COUNT,
        &EMIT,
        &COUNT_SWEPT,
        &EMIT_SWEPT,
        &ARGUMENTS,
    ],
};

/// Sorts `keys` with `values`.
pub const SORT: Sort = Sort {
    counters: "counters",
    input: ["keys", "values"],
    scratch: ["other_keys", "other_values"],
    digits: "digits",
    sums: "sums",
};

/// Adds the calls that place the bodies.
pub fn record_place(calls: &mut Calls) {
    calls.call(&PLACE, Groups::PerBodies(64));
    calls.call(&PLACE_COMPOUNDS, Groups::PerCompounds(64));
}

/// Adds the calls that find the sphere pairs.
pub fn record_search(calls: &mut Calls, capacity: &Capacity) {
    record(calls, capacity, [&COUNT, &EMIT]);
}

/// Adds the calls that find the pairs that can meet within a step. Speculative radii hold the ways of the whole step.
pub fn record_swept_search(calls: &mut Calls, capacity: &Capacity) {
    record(calls, capacity, [&COUNT_SWEPT, &EMIT_SWEPT]);
}

fn record(calls: &mut Calls, capacity: &Capacity, [count, emit]: [&'static Kernel; 2]) {
    let per_body = Groups::PerBodies(64);
    calls.call(&CELLS, per_body);
    // Superfluous workgroups return at once.
    let groups = [
        Groups::PerBodies(radix_sort::BLOCK),
        Groups::Exactly(radix_sort::digit_groups(capacity.bodies)),
    ];
    let [keys, values] = SORT.record(calls, BODIES, capacity.bucket_bits(), capacity.bodies, groups);
    calls.call(&ENTRIES, per_body).bind("keys", keys).bind("values", values);
    calls.call(count, per_body);
    let scan = Scan {
        counters: "counters",
        values: "pair_counts",
        sums: "sums",
    };
    scan.record(
        calls,
        BODIES,
        Length::Counter,
        Some(SPHERE_PAIRS),
        capacity.bodies,
        Groups::PerBodies(scan::BLOCK),
    );
    calls.call(emit, per_body);
    calls.call(&ARGUMENTS, Groups::Exactly(1));
}
