//! TriangleTest on the GPU: one workgroup per pair, and one per body for the planes.
//!
//! Large pairs, such as two meshes of more than 1,024 triangles, are split into pieces, which run side by side:
//!
//! | kernel | one workgroup (or thread) per | task |
//! |---|---|---|
//! | split | pair | the pieces of large pairs: pairs of nodes of 64 triangles each, or 512 in meshes beyond 262,144 |
//! | pairs, pieces | piece | its triangles |
//! | pairs | pair | the triangles of all other pairs |
//! | join | pair | the contacts of large pairs |
//! | rounded | pair | the triangles within the roundings, of pairs whose cores do not touch |
//! | number hits | (face pair) | their numbers within their pair |
//!
//! Rounded pairs are not split. In a step with contacts those that push each other are left out: their contact points
//! tell whether they touch.
//!
//! In a round a workgroup opens a pair of nodes or tests 64 pairs of triangles. A piece takes at most 129 rounds, or
//! 8,321 with the larger nodes; a pair that is not split at most 133,200. `benches/results/gpu.md` says how long that
//! is.
//!
//! Tests have error bounds, as on the CPU. Where single precision cannot decide, the triangles count as touching unless
//! a separating plane is found, because GPUs lack fast double precision. So no contact is missed, but faces
//! closer than some millionths of the bodies' size may be reported although they do not touch.

use super::cpu::{contact, interval_test};
use crate::gpu::buffers::Capacity;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::GROUPS_PER_PAIR;
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Tests the triangles of pairs.
const PAIRS: Kernel = kernel!("triangle_test/pairs");
/// Tests the triangles of pieces of large pairs.
const PIECES: Kernel = kernel!("triangle_test/pairs", "PIECES");
/// Splits large pairs into pieces.
const SPLIT: Kernel = kernel!("triangle_test/split");
/// Puts together what pieces have found.
const JOIN: Kernel = kernel!("triangle_test/join");
/// Finds where pairs touch that are rounded.
const ROUNDED: Kernel = kernel!("triangle_test/rounded");
/// Numbers the intersecting faces of pieces.
const NUMBER_HITS: Kernel = kernel!("triangle_test/number_hits");
/// Finds the vertices inside planes.
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
        module!("triangle_test/placed_pair"),
        module!("triangle_test/pair_contact"),
    ],
    kernels: &[&SPLIT, &PIECES, &PAIRS, &JOIN, &ROUNDED, &NUMBER_HITS, &PLANES],
};

/// Adds this stage's calls.
pub fn record(calls: &mut Calls, capacity: &Capacity) {
    let per_pair = Groups::Indirect("arguments", GROUPS_PER_PAIR);
    calls.call(&SPLIT, per_pair).for_large_meshes();
    calls
        .call(&PIECES, Groups::Indirect("piece_arguments", 0))
        .for_large_meshes();
    calls.call(&PAIRS, per_pair);
    calls.call(&JOIN, per_pair).for_large_meshes();
    calls.call(&ROUNDED, per_pair).for_rounded_meshes();
    // Superfluous workgroups return at once.
    calls
        .call(&NUMBER_HITS, Groups::Exactly(capacity.hits.div_ceil(64)))
        .for_large_meshes();
    calls.call(&PLANES, Groups::PerBodies(1)).for_planes();
}
