//! TriangleTest on the GPU: a workgroup a pair, and a workgroup a body for the half-spaces.
//!
//! Verdicts come with error bounds as on the CPU. What single precision cannot tell counts as touching unless a plane
//! is found that certainly separates the two triangles: a graphics card has no double precision to ask. So nothing is
//! missed, and faces nearer than some millionths of the bodies' size may be reported although they do not touch.

use super::cpu::{contact, interval_test};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::GROUPS_PER_PAIR;
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Pairs of bodies.
const PAIRS: Kernel = kernel!("triangle_test/pairs");
/// Bodies in half-spaces.
const PLANES: Kernel = kernel!("triangle_test/planes");

const CONSTANTS: Module = shared_constants!("faceoff::constants::triangle_test", {
    f32 MIN_LINE = interval_test::MIN_LINE;
    f32 SIGNIFICANT = contact::SIGNIFICANT;
});

/// All of them.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        CONSTANTS,
        module!("triangle_test/containment"),
        module!("triangle_test/triangles"),
    ],
    kernels: &[&PAIRS, &PLANES],
};

/// Adds this stage's calls.
pub fn record(calls: &mut Calls) {
    calls.call(&PAIRS, Groups::Indirect("arguments", GROUPS_PER_PAIR));
    calls.call(&PLANES, Groups::PerBodies(1));
}
