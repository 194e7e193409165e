//! BroadPhase on the GPU: a hashed grid with a level of cells for every power of two of the diameter.
//!
//! Each body looks into its own level and the coarser ones that hold any.

use crate::gpu::buffers::Buffers;
use crate::gpu::kernel::{Builder, Groups, Kernel, read, uniform, write};
use crate::gpu::layout::{BODIES, SPHERE_PAIRS};
use crate::gpu::radix_sort::{self, Sort};
use crate::gpu::scan::{self, Length, Scan};

/// Where the bodies are.
pub const PLACE: Kernel = Kernel {
    name: "broad_phase/place",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/broad_phase/place.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "moved", "Moved"),
        write(2, "bodies", "Body"),
    ],
};

/// The bucket of every body.
pub const CELLS: Kernel = Kernel {
    name: "broad_phase/cells",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/broad_phase/cells.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "bodies", "Body"),
        read(2, "meshes", "Mesh"),
        write(3, "counters", "u32"),
        write(4, "keys", "u32"),
        write(5, "values", "u32"),
    ],
};

/// Bodies in the order of buckets.
pub const ENTRIES: Kernel = Kernel {
    name: "broad_phase/entries",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/broad_phase/entries.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "bodies", "Body"),
        read(2, "meshes", "Mesh"),
        read(3, "keys", "u32"),
        read(4, "values", "u32"),
        write(5, "entries", "GridEntry"),
        write(6, "buckets", "vec2<u32>"),
    ],
};

/// How many pairs each body sees.
pub const COUNT: Kernel = Kernel {
    name: "broad_phase/count",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/broad_phase/pairs.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "counters", "u32"),
        read(2, "bodies", "Body"),
        read(3, "entries", "GridEntry"),
        read(4, "buckets", "vec2<u32>"),
        write(5, "pair_counts", "u32"),
    ],
};

/// The pairs.
pub const EMIT: Kernel = Kernel {
    name: "broad_phase/emit",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/broad_phase/pairs.wgsl")),
    emit: true,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "counters", "u32"),
        read(2, "bodies", "Body"),
        read(3, "entries", "GridEntry"),
        read(4, "buckets", "vec2<u32>"),
        read(5, "pair_counts", "u32"),
        write(6, "sphere_pairs", "vec2<u32>"),
    ],
};

/// Workgroups for the stages that follow.
pub const ARGUMENTS: Kernel = Kernel {
    name: "broad_phase/arguments",
    source: include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/shaders/broad_phase/arguments.wgsl"
    )),
    emit: false,
    workgroup: 1,
    bindings: &[
        uniform(0, "step", "Step"),
        write(1, "status", "u32"),
        write(2, "counters", "u32"),
        write(3, "arguments", "u32"),
    ],
};

/// All of them.
pub const KERNELS: [&Kernel; 6] = [&PLACE, &CELLS, &ENTRIES, &COUNT, &EMIT, &ARGUMENTS];

/// Adds this stage's calls.
pub fn record(builder: &mut Builder, b: &Buffers) {
    builder.call(&PLACE, &[&b.step, &b.moved, &b.bodies], Groups::PerBodies(64));
    record_search(builder, b);
}

/// Adds those that follow when the bodies are where they are.
pub fn record_search(builder: &mut Builder, b: &Buffers) {
    let per_body = Groups::PerBodies(64);
    builder.call(
        &CELLS,
        &[&b.step, &b.bodies, &b.meshes, &b.counters, &b.keys[0], &b.values[0]],
        per_body,
    );
    let sort = Sort {
        counters: &b.counters,
        input: [&b.keys[0], &b.values[0]],
        scratch: [&b.keys[1], &b.values[1]],
        digits: &b.digits,
        sums: &b.sums,
    };
    // Workgroups beyond the bodies there are return at once.
    let groups = [
        Groups::PerBodies(radix_sort::BLOCK),
        Groups::Exactly(radix_sort::digit_groups(b.sizes.bodies)),
    ];
    let [keys, values] = sort.record(builder, BODIES, b.sizes.bucket_bits(), groups);
    builder.call(
        &ENTRIES,
        &[&b.step, &b.bodies, &b.meshes, keys, values, &b.entries, &b.buckets],
        per_body,
    );
    let seen = [&b.step, &b.counters, &b.bodies, &b.entries, &b.buckets, &b.pair_counts];
    builder.call(&COUNT, &seen, per_body);
    let scan = Scan {
        counters: &b.counters,
        values: &b.pair_counts,
        sums: &b.sums,
    };
    scan.record(
        builder,
        BODIES,
        Length::Counter,
        Some(SPHERE_PAIRS),
        Groups::PerBodies(scan::BLOCK),
    );
    let [step, counters, bodies, entries, buckets, pair_counts] = seen;
    builder.call(
        &EMIT,
        &[step, counters, bodies, entries, buckets, pair_counts, &b.sphere_pairs],
        per_body,
    );
    builder.call(
        &ARGUMENTS,
        &[&b.step, &b.status, &b.counters, &b.arguments],
        Groups::Exactly(1),
    );
}
