//! The calls of one collision substep, in order.

use super::arguments::{per, per_body, per_pair};
use super::buffers::SolverCapacity;
use super::layout::{
    ENTRIES, GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_SORT_BLOCK, PASS_BIASED, PASS_UPDATES_POINTS, THEN_INTEGRATE_POSES,
    THEN_INTEGRATE_VELOCITIES,
};
use super::{restitution, warm_start};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::Calls;
use crate::gpu::radix_sort::Sort;
use crate::solver::CollisionSubstep;
use crate::types::solver_settings::SolverSettings;

/// Loads poses and velocities, applies external impulses, and integrates velocities for the first substep.
pub(super) const BEGIN: Kernel = kernel!("solver/begin");
/// Makes the constraints of all pairs.
pub(super) const CONSTRAINTS: Kernel = kernel!("solver/constraints");
/// Lists the sides of pairs, keyed by body.
pub(super) const PAIR_ADJACENCY: Kernel = kernel!("solver/pair_adjacency");
/// Finds the range of each body among the sorted sides.
pub(super) const PAIR_ADJACENCY_RANGES: Kernel = kernel!("solver/pair_adjacency_ranges");
/// Updates the points, decides which are active, and applies the impulses of the last substep.
pub(super) const SUBSTEP_BEGIN: Kernel = kernel!("solver/substep");
/// One pass over the active points of every pair.
pub(super) const SOLVE: Kernel = kernel!("solver/solve");
/// Applies the impulses of a pass to the bodies, and integrates poses or velocities if that is next.
pub(super) const APPLY_IMPULSES: Kernel = kernel!("solver/apply_impulses");
/// Writes poses and velocities back.
pub(super) const FINISH: Kernel = kernel!("solver/finish");

/// Iteration counts of a collision substep: all that its calls depend on, besides buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Passes {
    substeps: u32,
    bias: u32,
    relax: u32,
    restitution: u32,
    /// Whether bodies may fall asleep.
    pub sleeping: bool,
}

impl Passes {
    /// Those of a collision substep.
    pub fn new(settings: &SolverSettings, collision_substep: &CollisionSubstep) -> Self {
        Self {
            substeps: collision_substep.substeps.max(1),
            bias: settings.bias_iterations,
            relax: settings.relax_iterations,
            restitution: settings.restitution_iterations,
            sleeping: settings.sleeping,
        }
    }
}

const SORT: Sort = Sort {
    counters: "solver_counters",
    input: ["side_keys", "sides"],
    scratch: ["other_side_keys", "other_sides"],
    digits: "side_digits",
    sums: "side_sums",
};

/// Adds the calls that solve a collision substep.
pub fn record(calls: &mut Calls, capacity: &SolverCapacity, passes: Passes) {
    let sides = record_begin(calls, capacity);
    for number in 1..=passes.substeps {
        record_substep(calls, sides, passes, number == passes.substeps);
    }
    restitution::record(calls, passes.restitution, |calls, split_masses| {
        apply_impulses(calls, sides, split_masses, 0);
    });
    calls.call(&FINISH, per_body());
    warm_start::record_save(calls);
}

/// Adds the calls before the first substep, and returns the name of the buffer that holds the sorted sides.
fn record_begin(calls: &mut Calls, capacity: &SolverCapacity) -> &'static str {
    calls.call(&BEGIN, per_body());
    warm_start::record_remap(calls);
    calls.call(&CONSTRAINTS, per_pair());
    warm_start::record_points(calls);
    calls.call(&PAIR_ADJACENCY, per_pair());
    let groups = [GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK].map(per);
    let [keys, sides] = SORT.record(calls, ENTRIES, capacity.body_bits(), groups);
    calls.call(&PAIR_ADJACENCY_RANGES, per_pair()).bind("side_keys", keys);
    sides
}

/// Adds the calls of one substep. Velocities are integrated already; unless it is the last one, its last call integrates
/// them for the next.
fn record_substep(calls: &mut Calls, sides: &'static str, passes: Passes, is_last: bool) {
    calls.call(&SUBSTEP_BEGIN, per_pair());
    let last_pass = passes.bias + passes.relax;
    for pass in 0..=last_pass {
        // Pass 0 is the warm start, whose impulses the call above computes.
        if pass > 0 {
            let flag = |set: bool, flag| if set { flag } else { 0 };
            let biased = flag(pass <= passes.bias, PASS_BIASED);
            // The first pass after the bodies have moved.
            let updates = flag(pass == passes.bias + 1, PASS_UPDATES_POINTS);
            calls.call(&SOLVE, per_pair()).constants([biased | updates, 0, 0, 0]);
        }
        let mut then = 0;
        if pass == passes.bias {
            then |= THEN_INTEGRATE_POSES;
        }
        if pass == last_pass && !is_last {
            then |= THEN_INTEGRATE_VELOCITIES;
        }
        apply_impulses(calls, sides, pass == 0, then);
    }
}

/// Adds the call that applies the impulses of a pass. With `split_masses` it splits the mass of each body among its
/// active pairs. `then` has bits for what follows.
fn apply_impulses(calls: &mut Calls, sides: &'static str, split_masses: bool, then: u32) {
    let call = calls.call(&APPLY_IMPULSES, per_body());
    call.constants([split_masses.into(), then, 0, 0]).bind("sides", sides);
}
