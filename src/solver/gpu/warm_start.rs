//! Warm starting on the GPU: matches the impulses of the last collision substep with the new contact points, and saves
//! those of this one.

use super::arguments::{per, per_pair};
use super::layout::GROUPS_PER_64_OLD_BODIES;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::Calls;
use crate::gpu::shader::{Module, shared_constants};
use crate::solver::warm_start;

/// Gives each body its number in the last collision substep.
pub(super) const BODY_REMAP: Kernel = kernel!("solver/body_remap");
/// Makes the points of all pairs, with the saved impulses that match them.
pub(super) const WARM_START: Kernel = kernel!("solver/warm_start");
/// Saves pairs, points and impulses.
pub(super) const WARM_START_SAVE: Kernel = kernel!("solver/warm_start_save");

pub(super) const CONSTANTS: Module = shared_constants!("faceoff::constants::warm_start", {
    u32 MAX_MATCHED = warm_start::MAX_MATCHED;
    f32 MAX_IMPULSE_SCALE = warm_start::MAX_IMPULSE_SCALE;
});

/// Adds the call that gives each body its number in the last collision substep, by which pairs find their saved ones.
pub(super) fn record_remap(calls: &mut Calls) {
    calls.call(&BODY_REMAP, per(GROUPS_PER_64_OLD_BODIES));
}

/// Adds the call that makes the points and their initial impulses.
pub(super) fn record_points(calls: &mut Calls) {
    calls.call(&WARM_START, per_pair());
}

/// Adds the call that saves the impulses at the end of a collision substep.
pub(super) fn record_save(calls: &mut Calls) {
    calls.call(&WARM_START_SAVE, per_pair());
}
