//! TriangleTest on the GPU: a workgroup a pair, and a workgroup a body for the half-spaces.
//!
//! Verdicts come with error bounds as on the CPU. What single precision cannot tell counts as touching unless a plane
//! is found that certainly separates the two triangles: a graphics card has no double precision to ask. So nothing is
//! missed, and faces nearer than some millionths of the bodies' size may be reported although they do not touch.

use crate::gpu::buffers::Buffers;
use crate::gpu::kernel::{Builder, Groups, Kernel, read, uniform, write};
use crate::gpu::layout::GROUPS_PER_PAIR;

/// Pairs of bodies.
pub const PAIRS: Kernel = Kernel {
    name: "triangle_test/pairs",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/triangle_test/pairs.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "step", "Step"),
        write(3, "counters", "u32"),
        read(4, "bodies", "Body"),
        read(5, "near_pairs", "NearPair"),
        write(6, "results", "PairResult"),
        write(7, "touching", "Touching"),
        write(8, "hits", "Hit"),
    ],
};

/// Bodies in half-spaces.
pub const PLANES: Kernel = Kernel {
    name: "triangle_test/planes",
    source: include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/shaders/triangle_test/planes.wgsl"
    )),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "step", "Step"),
        write(3, "counters", "u32"),
        read(4, "bodies", "Body"),
        read(5, "planes", "Plane"),
        write(6, "plane_contacts", "PlaneContact"),
        write(7, "body_contacts", "BodyContacts"),
    ],
};

/// All of them.
pub const KERNELS: [&Kernel; 2] = [&PAIRS, &PLANES];

/// Adds this stage's calls.
pub fn record(builder: &mut Builder, b: &Buffers) {
    builder.call(
        &PAIRS,
        &[
            &b.meshes,
            &b.words,
            &b.step,
            &b.counters,
            &b.bodies,
            &b.near_pairs,
            &b.results,
            &b.touching,
            &b.hits,
        ],
        Groups::Indirect(GROUPS_PER_PAIR),
    );
    builder.call(
        &PLANES,
        &[
            &b.meshes,
            &b.words,
            &b.step,
            &b.counters,
            &b.bodies,
            &b.planes,
            &b.plane_contacts,
            &b.body_contacts,
        ],
        Groups::PerBodies(1),
    );
}
