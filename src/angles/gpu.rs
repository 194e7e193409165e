//! Angles on the GPU: a thread a pair. Pairs that are apart stay in the list, marked, since skipping one costs less than
//! closing the gaps.

use crate::gpu::buffers::Buffers;
use crate::gpu::kernel::{Builder, Groups, Kernel, read, uniform, write};
use crate::gpu::layout::GROUPS_PER_64_PAIRS;

/// Relative poses, support planes, views.
pub const ANGLES: Kernel = Kernel {
    name: "angles/near",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/angles/near.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        write(2, "counters", "u32"),
        read(3, "bodies", "Body"),
        read(4, "sphere_pairs", "vec2<u32>"),
        write(5, "near_pairs", "NearPair"),
        uniform(6, "step", "Step"),
    ],
};

/// All of them.
pub const KERNELS: [&Kernel; 1] = [&ANGLES];

/// Adds this stage's calls.
pub fn record(builder: &mut Builder, b: &Buffers) {
    builder.call(
        &ANGLES,
        &[
            &b.meshes,
            &b.words,
            &b.counters,
            &b.bodies,
            &b.sphere_pairs,
            &b.near_pairs,
            &b.step,
        ],
        Groups::Indirect(GROUPS_PER_64_PAIRS),
    );
}
