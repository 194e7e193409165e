//! The kernels, and the order in which they run.

use super::buffers::ContactBuffers;
use crate::gpu::kernel::{Builder, Groups, Kernel, read, uniform, write};
use crate::gpu::layout::{
    CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS, GROUPS_PER_64_MARGIN_PAIRS, GROUPS_PER_64_SLOTS,
    GROUPS_PER_MARGIN_PAIR, GROUPS_PER_SLOT_BLOCK,
};
use crate::gpu::scan::{Length, Scan};
use wgpu::Buffer;

/// How many workgroups the others take.
pub const ARGUMENTS: Kernel = Kernel {
    name: "manifolds/arguments",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/arguments.wgsl")),
    emit: false,
    workgroup: 1,
    bindings: &[
        uniform(0, "limits", "ContactLimits"),
        write(1, "counters", "u32"),
        write(2, "arguments", "u32"),
    ],
};

/// How the bodies of each pair lie to each other.
pub const PLACE: Kernel = Kernel {
    name: "manifolds/place",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/place.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        uniform(2, "limits", "ContactLimits"),
        read(3, "counters", "u32"),
        read(4, "bodies", "Body"),
        read(5, "margin_pairs", "MarginPair"),
        write(6, "settings", "ContactSetting"),
    ],
};

/// Pairs of triangles that are near each other.
pub const NEAR: Kernel = Kernel {
    name: "manifolds/near",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/near.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "constants", "vec4<u32>"),
        uniform(3, "limits", "ContactLimits"),
        write(4, "counters", "u32"),
        write(5, "settings", "ContactSetting"),
        write(6, "near_triangles", "vec4<u32>"),
    ],
};

/// Features and segments.
pub const FEATURES: Kernel = Kernel {
    name: "manifolds/features",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/features.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "constants", "vec4<u32>"),
        uniform(3, "limits", "ContactLimits"),
        write(4, "counters", "u32"),
        write(5, "settings", "ContactSetting"),
        write(6, "near_triangles", "vec4<u32>"),
        write(7, "features", "Feature"),
        write(8, "segments", "Segment"),
        read(9, "patches", "Patch"),
    ],
};

/// Contours and patches.
pub const CONTOURS: Kernel = Kernel {
    name: "manifolds/contours",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/contours.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        write(0, "counters", "u32"),
        write(1, "settings", "ContactSetting"),
        read(2, "segments", "Segment"),
        write(3, "links", "u32"),
        write(4, "patches", "Patch"),
    ],
};

/// Which features count.
pub const ADMIT: Kernel = Kernel {
    name: "manifolds/admit",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/admit.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        write(0, "counters", "u32"),
        read(1, "settings", "ContactSetting"),
        write(2, "features", "Feature"),
        write(3, "patches", "Patch"),
    ],
};

/// Rays out of patches.
pub const PROBE: Kernel = Kernel {
    name: "manifolds/probe",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/probe.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "limits", "ContactLimits"),
        write(3, "counters", "u32"),
        write(4, "settings", "ContactSetting"),
        read(5, "patches", "Patch"),
        write(6, "features", "Feature"),
    ],
};

/// Bodies inside bodies.
pub const INSIDE: Kernel = Kernel {
    name: "manifolds/inside",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/inside.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "limits", "ContactLimits"),
        write(3, "counters", "u32"),
        write(4, "settings", "ContactSetting"),
        write(5, "features", "Feature"),
    ],
};

/// The few points that count.
pub const REDUCE: Kernel = Kernel {
    name: "manifolds/reduce",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/reduce.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "limits", "ContactLimits"),
        write(3, "counters", "u32"),
        read(4, "settings", "ContactSetting"),
        write(5, "features", "Feature"),
        write(6, "staged", "ContactPoint"),
        write(7, "slots", "ContactPair"),
    ],
};

/// Bodies on half-spaces.
pub const PLANES: Kernel = Kernel {
    name: "manifolds/planes",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/planes.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        read(1, "words", "u32"),
        uniform(2, "limits", "ContactLimits"),
        uniform(3, "step", "Step"),
        write(4, "counters", "u32"),
        read(5, "bodies", "Body"),
        read(6, "planes", "Plane"),
        read(7, "margin_pairs", "MarginPair"),
        write(8, "staged", "ContactPoint"),
        write(9, "slots", "ContactPair"),
    ],
};

/// What the scans add up.
pub const COUNTS: Kernel = Kernel {
    name: "manifolds/counts",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/counts.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "counters", "u32"),
        read(1, "slots", "ContactPair"),
        write(2, "pair_places", "u32"),
        write(3, "point_places", "u32"),
    ],
};

/// The lists.
pub const EMIT: Kernel = Kernel {
    name: "manifolds/emit",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/manifolds/emit.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "limits", "ContactLimits"),
        write(1, "counters", "u32"),
        read(2, "slots", "ContactPair"),
        read(3, "pair_places", "u32"),
        read(4, "point_places", "u32"),
        read(5, "staged", "ContactPoint"),
        write(6, "contact_pairs", "ContactPair"),
        write(7, "contact_points", "ContactPoint"),
    ],
};

/// All of them, but for those of the scan.
pub const KERNELS: [&Kernel; 12] = [
    &ARGUMENTS, &PLACE, &NEAR, &FEATURES, &CONTOURS, &ADMIT, &PROBE, &INSIDE, &REDUCE, &PLANES, &COUNTS, &EMIT,
];

/// What contact generation reads and others write.
#[derive(Clone, Copy, Debug)]
pub struct Shared<'b> {
    /// Uniform: gravity and the length of the step.
    pub step: &'b Buffer,
    /// Where the bodies are.
    pub bodies: &'b Buffer,
    /// The half-spaces.
    pub planes: &'b Buffer,
    /// Headers of an [arena with features](crate::gpu::arena::Arena::with_features).
    pub meshes: &'b Buffer,
    /// Its words.
    pub words: &'b Buffer,
}

/// Adds the calls. They must run with the arguments of `b`, for as many bodies as `b.limits` says.
pub fn record(builder: &mut Builder, shared: Shared, b: &ContactBuffers) {
    record_points(builder, shared, b);
    record_lists(builder, b);
}

/// Adds those that find points, in any order.
pub fn record_points(builder: &mut Builder, shared: Shared, b: &ContactBuffers) {
    let Shared {
        step,
        bodies,
        planes,
        meshes,
        words,
    } = shared;
    let (limits, counters, settings, features) = (&b.limits, &b.counters, &b.settings, &b.features);
    let per_pair = Groups::Indirect(GROUPS_PER_MARGIN_PAIR);
    builder.call(&ARGUMENTS, &[limits, counters, &b.arguments], Groups::Exactly(1));
    builder.call(
        &PLACE,
        &[meshes, limits, counters, bodies, &b.margin_pairs, settings],
        Groups::Indirect(GROUPS_PER_64_MARGIN_PAIRS),
    );
    for search in 0..2 {
        let constants = builder.constants([search, 0, 0, 0]);
        let near = [meshes, words, &constants, limits, counters, settings, &b.near_triangles];
        builder.call(&NEAR, &near, per_pair);
        let [meshes, words, constants, limits, counters, settings, near] = near;
        builder.call(
            &FEATURES,
            &[
                meshes,
                words,
                constants,
                limits,
                counters,
                settings,
                near,
                features,
                &b.segments,
                &b.patches,
            ],
            per_pair,
        );
        if search == 0 {
            let contours = [counters, settings, &b.segments, &b.links, &b.patches];
            builder.call(&CONTOURS, &contours, per_pair);
        }
    }
    builder.call(&ADMIT, &[counters, settings, features, &b.patches], per_pair);
    builder.call(
        &PROBE,
        &[meshes, words, limits, counters, settings, &b.patches, features],
        per_pair,
    );
    builder.call(
        &INSIDE,
        &[meshes, words, limits, counters, settings, features],
        per_pair,
    );
    builder.call(
        &REDUCE,
        &[meshes, words, limits, counters, settings, features, &b.staged, &b.slots],
        per_pair,
    );
    builder.call(
        &PLANES,
        &[
            meshes,
            words,
            limits,
            step,
            counters,
            bodies,
            planes,
            &b.margin_pairs,
            &b.staged,
            &b.slots,
        ],
        Groups::PerBodies(1),
    );
}

/// Adds those that put them in order.
pub fn record_lists(builder: &mut Builder, b: &ContactBuffers) {
    let (limits, counters) = (&b.limits, &b.counters);
    let per_slots = Groups::Indirect(GROUPS_PER_64_SLOTS);
    builder.call(
        &COUNTS,
        &[counters, &b.slots, &b.pair_places, &b.point_places],
        per_slots,
    );
    for (values, total) in [(&b.pair_places, CONTACT_PAIRS), (&b.point_places, CONTACT_POINTS)] {
        let scan = Scan {
            counters,
            values,
            sums: &b.sums,
        };
        let groups = Groups::Indirect(GROUPS_PER_SLOT_BLOCK);
        scan.record(builder, CONTACT_SLOTS, Length::Counter, Some(total), groups);
    }
    builder.call(
        &EMIT,
        &[
            limits,
            counters,
            &b.slots,
            &b.pair_places,
            &b.point_places,
            &b.staged,
            &b.contact_pairs,
            &b.contact_points,
        ],
        per_slots,
    );
}
