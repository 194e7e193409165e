//! Angles on the GPU: a thread a pair. Pairs that are apart stay in the list, marked, since skipping one costs less than
//! closing the gaps.

use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::GROUPS_PER_64_PAIRS;
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::{Module, Shaders, shared_constants};

/// Relative poses, support planes, views.
const SUPPORT_AXES: Kernel = kernel!("angles/support_axes");

const CONSTANTS: Module = shared_constants!("faceoff::constants::angles", {
    u32 AXES = super::AXES;
});

/// All of them.
pub const SHADERS: Shaders = Shaders {
    modules: &[CONSTANTS],
    kernels: &[&SUPPORT_AXES],
};

/// Adds this stage's calls.
pub fn record(calls: &mut Calls) {
    calls.call(&SUPPORT_AXES, Groups::Indirect("arguments", GROUPS_PER_64_PAIRS));
}
