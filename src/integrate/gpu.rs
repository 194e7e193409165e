//! Integrate on the GPU: one thread per body.

use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::Shaders;

/// Moves the bodies, unless a list was too short.
const MOVE: Kernel = kernel!("integrate/move");

/// This stage's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[],
    kernels: &[&MOVE],
};

/// Adds this stage's calls.
pub fn record(calls: &mut Calls) {
    calls.call(&MOVE, Groups::PerBodies(64));
}
