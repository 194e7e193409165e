//! The calls of one collision substep, in order.

use super::arguments::{per_body, per_pair};
use super::buffers::SolverCapacity;
use super::{islands, warm_start};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::Calls;

/// Loads poses and velocities, and applies external impulses.
pub(super) const BEGIN: Kernel = kernel!("solver/begin");
/// Makes the constraints of all pairs.
pub(super) const CONSTRAINTS: Kernel = kernel!("solver/constraints");
/// Moves bodies that are in no island, and writes poses and velocities back.
pub(super) const FINISH: Kernel = kernel!("solver/finish");

/// Adds the calls that solve a collision substep.
pub fn record(calls: &mut Calls, capacity: &SolverCapacity) {
    calls.call(&BEGIN, per_body());
    warm_start::record_remap(calls);
    calls.call(&CONSTRAINTS, per_pair());
    warm_start::record_points(calls);
    islands::record(calls, capacity);
    calls.call(&FINISH, per_body());
    warm_start::record_save(calls);
}
