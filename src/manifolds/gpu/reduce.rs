//! Contact reduction on the GPU: selects the few points that represent a manifold, one workgroup per pair.

use super::record::per;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::GROUPS_PER_BATCH_PAIR;
use crate::gpu::program::Calls;
use crate::gpu::shader::{Module, shared_constants};
use crate::manifolds;
use crate::manifolds::cpu::reduce;

/// Selects points and converts them to world axes.
pub(super) const REDUCE: Kernel = kernel!("manifolds/reduce");

pub(super) const CONSTANTS: Module = shared_constants!("faceoff::constants::reduce", {
    u32 MAX_POINTS = manifolds::MAX_POINTS;
    f32 NORMAL_WEIGHT = reduce::NORMAL_WEIGHT;
    f32 DUPLICATE = reduce::DUPLICATE;
    f32 DEPTH_SCALE = reduce::DEPTH_SCALE;
    f32 MIN_WEIGHT = reduce::MIN_WEIGHT;
});

/// Adds the call for a batch of pairs: its number, and the number of batches.
pub(super) fn record(calls: &mut Calls, constants: [u32; 4]) {
    calls.call(&REDUCE, per(GROUPS_PER_BATCH_PAIR)).constants(constants);
}
