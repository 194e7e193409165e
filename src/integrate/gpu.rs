//! Integrate on the GPU: a thread a body.

use crate::gpu::buffers::Buffers;
use crate::gpu::kernel::{Builder, Groups, Kernel, read, uniform, write};

/// Moves the bodies, unless some list was too small.
pub const MOVE: Kernel = Kernel {
    name: "integrate/move",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/integrate/move.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        uniform(2, "step", "Step"),
        write(3, "status", "u32"),
        write(4, "counters", "u32"),
        read(5, "impulses", "Impulse"),
        read(6, "bodies", "Body"),
        write(7, "moved", "Moved"),
    ],
};

/// All of them.
pub const KERNELS: [&Kernel; 1] = [&MOVE];

/// Adds this stage's calls.
pub fn record(builder: &mut Builder, b: &Buffers) {
    builder.call(
        &MOVE,
        &[
            &b.meshes,
            &b.step,
            &b.status,
            &b.counters,
            &b.impulses,
            &b.bodies,
            &b.moved,
        ],
        Groups::PerBodies(64),
    );
}
