//! Restitution on the GPU: passes after the last substep, over the pairs that met fast enough.

use super::arguments::per_pair;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::Calls;
use crate::gpu::shader::{Module, shared_constants};

/// Makes only the pairs active that need restitution.
pub(super) const RESTITUTION_BEGIN: Kernel = kernel!("solver/restitution_begin");
/// One restitution pass.
pub(super) const RESTITUTION: Kernel = kernel!("solver/restitution");

/// Sweeps over the points of a pair in a pass. A pair that nothing else touches is exact after one pass.
const SWEEPS: u32 = 6;

pub(super) const CONSTANTS: Module = shared_constants!("faceoff::constants::restitution", {
    u32 RESTITUTION_SWEEPS = SWEEPS;
});

/// Adds the restitution passes. `apply_impulses` adds the call that applies the impulses of a pass; its argument tells
/// whether masses are split among the active pairs first.
pub(super) fn record(calls: &mut Calls, iterations: u32, apply_impulses: impl Fn(&mut Calls, bool)) {
    calls.call(&RESTITUTION_BEGIN, per_pair());
    apply_impulses(calls, true);
    for _ in 0..iterations {
        calls.call(&RESTITUTION, per_pair());
        apply_impulses(calls, false);
    }
}
