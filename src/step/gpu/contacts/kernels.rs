//! The kernels between those of contact generation and those of the solver, which make a step of them.

use crate::gpu::kernel::{Kernel, read, uniform, write};

/// Where bodies are as the step begins.
pub const BEGIN: Kernel = Kernel {
    name: "broad_phase/begin",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/begin.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        uniform(2, "step", "Step"),
        read(3, "moved", "Moved"),
        read(4, "settled", "BodyState"),
        read(5, "arrivals", "BodyState"),
        write(6, "bodies", "Body"),
        write(7, "states", "BodyState"),
    ],
};

/// Where they are as another interval begins.
pub const PLACE: Kernel = Kernel {
    name: "broad_phase/place again",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/place.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        uniform(2, "step", "Step"),
        read(3, "states", "BodyState"),
        read(4, "movers", "Mover"),
        write(5, "bodies", "Body"),
        write(6, "counters", "u32"),
    ],
};

/// Which pairs contact generation looks at, and their second bodies.
pub const KEYS: Kernel = Kernel {
    name: "manifolds/keys",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/pair_keys.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        write(1, "counters", "u32"),
        read(2, "bodies", "Body"),
        read(3, "near_pairs", "NearPair"),
        write(4, "keys", "u32"),
        write(5, "values", "u32"),
    ],
};

/// Their first bodies.
pub const ORDER: Kernel = Kernel {
    name: "manifolds/order",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/pair_order.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "counters", "u32"),
        read(2, "near_pairs", "NearPair"),
        write(3, "keys", "u32"),
        read(4, "values", "u32"),
    ],
};

/// The pairs, ascending.
pub const PAIRS: Kernel = Kernel {
    name: "manifolds/pairs",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/pairs.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "counters", "u32"),
        read(2, "bodies", "Body"),
        read(3, "near_pairs", "NearPair"),
        read(4, "values", "u32"),
        write(5, "margin_pairs", "MarginPair"),
        write(6, "contact_counters", "u32"),
    ],
};

/// The points of pairs about which nothing has changed.
pub const RECALL: Kernel = Kernel {
    name: "manifolds/recall",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/recall.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        uniform(1, "interval", "Interval"),
        read(2, "bodies", "Body"),
        write(3, "counters", "u32"),
        write(4, "slots", "ContactPair"),
        write(5, "staged", "ContactPoint"),
        read(6, "contact_pairs", "ContactPair"),
        read(7, "contact_points", "ContactPoint"),
        read(8, "solver_counters", "u32"),
    ],
};

/// How much there is.
pub const TALLY: Kernel = Kernel {
    name: "manifolds/tally",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/tally.wgsl")),
    emit: false,
    workgroup: 1,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "contact_counters", "u32"),
        write(2, "tally", "u32"),
        write(3, "status", "u32"),
        write(4, "counters", "u32"),
    ],
};

/// Who touched whom, and where.
pub const TOUCHES: Kernel = Kernel {
    name: "force_scan/touches",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/touches.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "counters", "u32"),
        read(2, "pairs", "SolverPair"),
        read(3, "contact_points", "ContactPoint"),
        read(4, "points", "PointState"),
        read(5, "states", "BodyState"),
        read(6, "shifts", "Shift"),
        write(7, "tally", "u32"),
        write(8, "touches", "Touch"),
    ],
};

/// Whether all lists sufficed.
pub const VERDICT: Kernel = Kernel {
    name: "integrate/verdict",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/verdict.wgsl")),
    emit: false,
    workgroup: 1,
    bindings: &[
        uniform(0, "step", "Step"),
        read(1, "tally", "u32"),
        write(2, "status", "u32"),
        write(3, "counters", "u32"),
    ],
};

/// Where the bodies are after the step.
pub const FINISH: Kernel = Kernel {
    name: "integrate/finish",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/finish.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(0, "meshes", "Mesh"),
        uniform(2, "step", "Step"),
        read(3, "counters", "u32"),
        write(4, "tally", "u32"),
        read(5, "bodies", "Body"),
        read(6, "movers", "Mover"),
        read(7, "states", "BodyState"),
        write(8, "moved", "Moved"),
        write(9, "settled", "BodyState"),
    ],
};

/// What outlives it.
pub const KEEP: Kernel = Kernel {
    name: "integrate/keep",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/step/keep.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        uniform(0, "constants", "vec4<u32>"),
        read(1, "counters", "u32"),
        read(2, "solver_counters", "u32"),
        read(3, "source", "vec4<u32>"),
        write(4, "kept", "vec4<u32>"),
    ],
};

/// All of them.
pub const KERNELS: [&Kernel; 11] = [
    &BEGIN, &PLACE, &KEYS, &ORDER, &PAIRS, &RECALL, &TALLY, &TOUCHES, &VERDICT, &FINISH, &KEEP,
];
