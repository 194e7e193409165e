//! TriangleTest on the GPU: one workgroup per pair, and one per body for the half-spaces.
//!
//! Tests have error bounds, as on the CPU. Where single precision cannot decide, the triangles count as touching unless
//! a separating plane is found, because graphics cards lack fast double precision. So no contact is missed, but faces
//! closer than some millionths of the bodies' size may be reported although they do not touch.

use super::cpu::{contact, interval_test};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::GROUPS_PER_PAIR;
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Tests the triangles of pairs.
const PAIRS: Kernel = kernel!("triangle_test/pairs");
/// Finds the vertices inside half-spaces.
const PLANES: Kernel = kernel!("triangle_test/planes");

const CONSTANTS: Module = shared_constants!("faceoff::constants::triangle_test", {
    f32 MIN_LINE = interval_test::MIN_LINE;
    f32 SIGNIFICANT = contact::SIGNIFICANT;
});

/// This stage's modules and kernels.
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
    calls.call(&PLANES, Groups::PerBodies(1)).for_planes();
}
