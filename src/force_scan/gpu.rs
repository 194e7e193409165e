//! ForceScan on the GPU. For impulses each pair has two entries, which are sorted by collider; one thread per collider
//! sums its impulses. Integrate adds those of the colliders of a compound. Touches are recorded by one thread per pair.

use super::impulse;
use crate::broad_phase::gpu::SORT;
use crate::gpu::buffers::Capacity;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::{self, GROUPS_PER_64_PAIRS, GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_SORT_BLOCK};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};
use crate::solver::gpu::arguments::per_pair as per_solver_pair;

/// Writes the entries of pairs, keyed by collider.
const ENTRIES: Kernel = kernel!("force_scan/entries");
/// Finds the range of each collider's entries.
const SEGMENTS: Kernel = kernel!("force_scan/segments");
/// Counts the active contacts of each collider.
const COUNTS: Kernel = kernel!("force_scan/counts");
/// Adds up the counts of the colliders of each compound.
const COMPOUND_COUNTS: Kernel = kernel!("force_scan/compound_counts");
/// Sums the impulses.
const SUMS: Kernel = kernel!("force_scan/sums");
/// Records the touching pairs.
const TOUCHES: Kernel = kernel!("force_scan/touches");

const CONSTANTS: Module = shared_constants!("faceoff::constants::force_scan", {
    vec2 PUSH = impulse::PUSH;
    f32 RESTITUTION_STEPS = impulse::RESTITUTION_STEPS;
});

/// This stage's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[CONSTANTS, module!("force_scan/response")],
    kernels: &[&ENTRIES, &SEGMENTS, &COUNTS, &COMPOUND_COUNTS, &SUMS, &TOUCHES],
};

/// Adds the calls that sum impulses.
pub fn record_impulses(calls: &mut Calls, capacity: &Capacity) {
    let [per_pair, per_block, per_digit_block] = [GROUPS_PER_64_PAIRS, GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK]
        .map(|slot| Groups::Indirect("arguments", slot));
    let per_pair = Groups::per_64(capacity.pairs, per_pair);
    let per_body = Groups::PerBodies(64);
    calls.call(&ENTRIES, per_pair);
    let [keys, values] = SORT.record(
        calls,
        layout::ENTRIES,
        capacity.body_bits(),
        capacity.pairs.saturating_mul(2),
        [per_block, per_digit_block],
    );
    calls.call(&SEGMENTS, per_pair).bind("keys", keys);
    calls.call(&COUNTS, per_body);
    calls.call(&COMPOUND_COUNTS, Groups::PerCompounds(64));
    calls.call(&SUMS, per_body).bind("values", values);
}

/// Adds the call that records the touching pairs of a collision substep, after the solver.
pub fn record_touches(calls: &mut Calls) {
    calls.call(&TOUCHES, per_solver_pair());
}
