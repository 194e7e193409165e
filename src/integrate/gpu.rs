//! Integrate on the GPU: one thread per body.

use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::Shaders;

/// Moves the bodies, unless a list was too short.
const MOVE: Kernel = kernel!("integrate/move");
/// Moves compounds and their colliders.
const MOVE_COMPOUNDS: Kernel = kernel!("integrate/move_compounds");

/// This stage's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[],
    kernels: &[&MOVE, &MOVE_COMPOUNDS],
};

/// Adds this stage's calls.
pub fn record(calls: &mut Calls) {
    calls.call(&MOVE, Groups::PerBodies(64));
    calls.call(&MOVE_COMPOUNDS, Groups::PerCompounds(64));
}
