//! Angles on the GPU: one thread per pair. Pairs that are apart stay in the list with a mark, because skipping them
//! costs less than compacting the list.

use crate::gpu::buffers::Capacity;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::GROUPS_PER_64_PAIRS;
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Relative poses, support-axis cull, visible triangles.
const SUPPORT_AXES: Kernel = kernel!("angles/support_axes");

const CONSTANTS: Module = shared_constants!("faceoff::constants::angles", {
    u32 AXES = super::AXES;
});

/// This stage's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[CONSTANTS, module!("angles/pair_margin")],
    kernels: &[&SUPPORT_AXES],
};

/// Adds this stage's calls.
pub fn record(calls: &mut Calls, capacity: &Capacity) {
    let counted = Groups::Indirect("arguments", GROUPS_PER_64_PAIRS);
    calls.call(&SUPPORT_AXES, Groups::per_64(capacity.pairs, counted));
}
