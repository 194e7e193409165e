//! The solver's kernels: what each binds.

use crate::gpu::kernel::{Binding, Kernel, read, uniform, write};
use crate::sleep::gpu as sleep;

const INTERVAL: Binding = uniform(0, "interval", "Interval");

/// A kernel of 64 threads a workgroup; its WGSL is in the file of the same name.
macro_rules! kernel {
    ($(#[$doc:meta])* $constant:ident, $name:literal, $file:literal, $workgroup:literal, [$($binding:expr),* $(,)?]) => {
        $(#[$doc])*
        pub const $constant: Kernel = Kernel {
            name: concat!("solver/", $name),
            source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/", $file, ".wgsl")),
            emit: false,
            workgroup: $workgroup,
            bindings: &[INTERVAL, $($binding),*],
        };
    };
}

kernel!(
    /// Workgroups for all others.
    ARGUMENTS, "arguments", "arguments", 1, [
        uniform(1, "constants", "vec4<u32>"),
        read(2, "contact_counters", "u32"),
        write(3, "status", "u32"),
        write(4, "counters", "u32"),
        write(5, "arguments", "u32"),
    ]
);

kernel!(
    /// Bodies take over poses, velocities and impulses from outside.
    BEGIN, "begin", "begin", 64, [
        read(1, "bodies", "SolverBody"),
        read(2, "states", "BodyState"),
        write(3, "forces", "BodyForces"),
        write(4, "movers", "Mover"),
        write(5, "velocities", "Velocity"),
        write(6, "masses", "Mass"),
        write(7, "shifts", "Shift"),
        write(8, "links", "vec4<u32>"),
    ]
);

kernel!(
    /// Numbers that bodies had in the interval before.
    RENUMBER, "renumber", "renumber", 64, [
        read(1, "renumbered", "u32"),
        write(2, "links", "vec4<u32>"),
    ]
);

kernel!(
    /// What holds for all points of a pair.
    PREPARE_PAIRS, "pairs", "pairs", 64, [
        read(1, "counters", "u32"),
        read(2, "contact_pairs", "ContactPair"),
        read(3, "bodies", "SolverBody"),
        read(4, "states", "BodyState"),
        read(5, "masses", "Mass"),
        read(6, "links", "vec4<u32>"),
        read(7, "kept_pairs", "KeptPair"),
        write(8, "pairs", "SolverPair"),
    ]
);

kernel!(
    /// Points as they are solved.
    PREPARE_POINTS, "points", "points", 64, [
        read(1, "counters", "u32"),
        read(2, "contact_points", "ContactPoint"),
        write(3, "pairs", "SolverPair"),
        read(4, "kept_pairs", "KeptPair"),
        read(5, "kept_points", "KeptPoint"),
        read(6, "movers", "Mover"),
        write(7, "shapes", "PointShape"),
        write(8, "points", "PointState"),
    ]
);

kernel!(
    /// Ends of pairs, keyed by body.
    ENDS, "ends", "ends", 64, [
        read(1, "counters", "u32"),
        read(2, "pairs", "SolverPair"),
        write(3, "keys", "u32"),
        write(4, "values", "u32"),
    ]
);

kernel!(
    /// Where each body's ends are.
    SEGMENTS, "segments", "segments", 128, [
        read(1, "counters", "u32"),
        read(2, "keys", "u32"),
        write(3, "links", "vec4<u32>"),
    ]
);

kernel!(
    /// Pairs measure their points and give last substep's impulses again.
    BEGIN_SUBSTEP, "substep", "substep", 64, [
        read(2, "counters", "u32"),
        write(3, "pairs", "SolverPair"),
        read(4, "shapes", "PointShape"),
        write(5, "points", "PointState"),
        read(6, "masses", "Mass"),
        read(7, "shifts", "Shift"),
        read(8, "velocities", "Velocity"),
        write(9, "impulses", "Impulse"),
    ]
);

kernel!(
    /// One pass over the points of every pair.
    PASS, "pass", "pass", 64, [
        uniform(1, "constants", "vec4<u32>"),
        read(2, "counters", "u32"),
        write(3, "pairs", "SolverPair"),
        read(4, "shapes", "PointShape"),
        write(5, "points", "PointState"),
        read(6, "masses", "Mass"),
        read(7, "shifts", "Shift"),
        read(8, "velocities", "Velocity"),
        write(9, "impulses", "Impulse"),
    ]
);

kernel!(
    /// Bodies take impulses, and may move and speed up.
    TAKE, "take", "take", 64, [
        uniform(1, "constants", "vec4<u32>"),
        read(2, "movers", "Mover"),
        write(3, "velocities", "Velocity"),
        write(4, "masses", "Mass"),
        write(5, "shifts", "Shift"),
        read(6, "links", "vec4<u32>"),
        read(7, "ends", "u32"),
        read(8, "impulses", "Impulse"),
        read(9, "pairs", "SolverPair"),
    ]
);

kernel!(
    /// Which pairs bounce.
    BOUNCE_BEGIN, "bounce begin", "bounce_begin", 64, [
        read(2, "counters", "u32"),
        write(3, "pairs", "SolverPair"),
        read(4, "shapes", "PointShape"),
        write(5, "points", "PointState"),
        read(6, "masses", "Mass"),
        read(7, "shifts", "Shift"),
        write(9, "impulses", "Impulse"),
    ]
);

/// One pass over the pairs that bounce.
pub const BOUNCE: Kernel = Kernel {
    name: "solver/bounce",
    source: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/solver/bounce.wgsl")),
    emit: false,
    workgroup: 64,
    bindings: &[
        read(2, "counters", "u32"),
        write(3, "pairs", "SolverPair"),
        write(5, "points", "PointState"),
        read(6, "masses", "Mass"),
        read(8, "velocities", "Velocity"),
        write(9, "impulses", "Impulse"),
    ],
};

kernel!(
    /// Where the bodies are after the interval.
    FINISH, "finish", "finish", 64, [
        read(1, "movers", "Mover"),
        read(2, "velocities", "Velocity"),
        read(3, "shifts", "Shift"),
        write(4, "states", "BodyState"),
    ]
);

kernel!(
    /// What is kept until the next interval.
    KEEP, "keep", "keep", 64, [
        read(1, "counters", "u32"),
        read(2, "pairs", "SolverPair"),
        read(3, "shapes", "PointShape"),
        read(4, "points", "PointState"),
        read(5, "movers", "Mover"),
        write(6, "kept_pairs", "KeptPair"),
        write(7, "kept_points", "KeptPoint"),
    ]
);

/// All of the solver, those of the sort left out.
pub const KERNELS: [&Kernel; 20] = [
    &ARGUMENTS,
    &BEGIN,
    &RENUMBER,
    &PREPARE_PAIRS,
    &PREPARE_POINTS,
    &ENDS,
    &SEGMENTS,
    &BEGIN_SUBSTEP,
    &PASS,
    &TAKE,
    &BOUNCE_BEGIN,
    &BOUNCE,
    &FINISH,
    &KEEP,
    &sleep::BEGIN,
    &sleep::JOIN,
    &sleep::BODIES,
    &sleep::PAIRS,
    &sleep::APPLY,
    &sleep::WAKE_ALL,
];
