//! ForceScan on the GPU: two entries a pair, sorted by body, summed by a thread a body.

use crate::gpu::buffers::Buffers;
use crate::gpu::kernel::{Builder, Groups, Kernel, read, uniform, write};
use crate::gpu::layout::{self, GROUPS_PER_64_PAIRS, GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_SORT_BLOCK};
use crate::gpu::radix_sort::Sort;

/// Keys by body.
pub const ENTRIES: Kernel = Kernel {
    name: "force_scan/entries",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/force_scan/entries.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        uniform(2, "step", "Step"),
        read(3, "counters", "u32"),
        read(4, "bodies", "Body"),
        read(5, "results", "PairResult"),
        write(6, "keys", "u32"),
        write(7, "values", "u32"),
    ],
};

/// Where each body's entries are.
pub const SEGMENTS: Kernel = Kernel {
    name: "force_scan/segments",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/force_scan/segments.wgsl")),
    emit: false,
    workgroup: 128,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "counters", "u32"),
        read(2, "keys", "u32"),
        write(3, "body_contacts", "BodyContacts"),
    ],
};

/// How many push it.
pub const COUNTS: Kernel = Kernel {
    name: "force_scan/counts",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/force_scan/counts.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "bodies", "Body"),
        read(2, "planes", "Plane"),
        read(3, "plane_contacts", "PlaneContact"),
        write(4, "body_contacts", "BodyContacts"),
    ],
};

/// The sums.
pub const SUMS: Kernel = Kernel {
    name: "force_scan/sums",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/force_scan/sums.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        uniform(2, "step", "Step"),
        read(3, "bodies", "Body"),
        read(4, "results", "PairResult"),
        read(5, "values", "u32"),
        read(6, "planes", "Plane"),
        read(7, "plane_contacts", "PlaneContact"),
        read(8, "body_contacts", "BodyContacts"),
        write(9, "impulses", "Impulse"),
    ],
};

/// All of them.
pub const KERNELS: [&Kernel; 4] = [&ENTRIES, &SEGMENTS, &COUNTS, &SUMS];

/// Adds this stage's calls.
pub fn record(builder: &mut Builder, b: &Buffers) {
    builder.call(
        &ENTRIES,
        &[
            &b.meshes,
            &b.step,
            &b.counters,
            &b.bodies,
            &b.results,
            &b.keys[0],
            &b.values[0],
        ],
        Groups::Indirect(GROUPS_PER_64_PAIRS),
    );
    let sort = Sort {
        counters: &b.counters,
        input: [&b.keys[0], &b.values[0]],
        scratch: [&b.keys[1], &b.values[1]],
        digits: &b.digits,
        sums: &b.sums,
    };
    let groups = [GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK].map(Groups::Indirect);
    let [keys, values] = sort.record(builder, layout::ENTRIES, b.sizes.body_bits(), groups);
    builder.call(
        &SEGMENTS,
        &[&b.step, &b.counters, keys, &b.body_contacts],
        Groups::Indirect(GROUPS_PER_64_PAIRS),
    );
    builder.call(
        &COUNTS,
        &[&b.step, &b.bodies, &b.planes, &b.plane_contacts, &b.body_contacts],
        Groups::PerBodies(64),
    );
    builder.call(
        &SUMS,
        &[
            &b.meshes,
            &b.step,
            &b.bodies,
            &b.results,
            values,
            &b.planes,
            &b.plane_contacts,
            &b.body_contacts,
            &b.impulses,
        ],
        Groups::PerBodies(64),
    );
}
