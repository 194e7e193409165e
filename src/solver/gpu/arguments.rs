//! How many workgroups the solver's kernels need: the device counts pairs and points itself.

use super::layout::{GROUPS_PER_64_BODIES, GROUPS_PER_64_PAIRS};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::{Calls, Groups};

/// Computes the workgroup counts of all other kernels.
pub(super) const ARGUMENTS: Kernel = kernel!("solver/arguments");

/// Adds the call that computes the workgroup counts. It must precede all other calls of a collision substep.
pub fn record_arguments(calls: &mut Calls) {
    calls.call(&ARGUMENTS, Groups::Exactly(1));
}

/// One thread per body.
pub(crate) const fn per_body() -> Groups {
    per(GROUPS_PER_64_BODIES)
}

/// One thread per pair.
pub(crate) const fn per_pair() -> Groups {
    per(GROUPS_PER_64_PAIRS)
}

/// The workgroup count in this slot of `solver_arguments`.
pub(super) const fn per(slot: u32) -> Groups {
    Groups::Indirect("solver_arguments", slot)
}
