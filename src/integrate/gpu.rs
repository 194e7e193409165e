//! Integrate on the GPU: a thread a body.

use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::Shaders;

/// Moves the bodies, unless some list was too small.
const MOVE: Kernel = kernel!("integrate/move");

/// All of them.
pub const SHADERS: Shaders = Shaders {
    modules: &[],
    kernels: &[&MOVE],
};

/// Adds this stage's calls.
pub fn record(calls: &mut Calls) {
    calls.call(&MOVE, Groups::PerBodies(64));
}
