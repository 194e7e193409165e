//! The solver on the GPU, with bodies, contacts and saved impulses in buffers. [`solver`](super) tells how its method
//! differs from that of the CPU.
//!
//! One thread per pair solves the pair's points; one thread per body sums the impulses of its sides. A side is one of
//! the two bodies of a pair. Sides are sorted by body once per collision substep, and all sums are in the order of
//! pairs, so the same input gives the same bits.
//!
//! | file | contents |
//! |---|---|
//! | [`layout`] | structs and constants that kernels and host share |
//! | [`buffers`] | the buffers |
//! | [`arguments`] | workgroup counts |
//! | [`record`](mod@record) | the calls of a collision substep |
//! | `warm_start` | matching and saving of impulses |
//! | `restitution` | restitution passes |
//! | [`upload`] | conversion of the host's bodies and contacts |
//! | `hand_over` | conversion of the impulses that the CPU has saved, and back |
//!
//! The device has no double precision. Centres and rotations are stored in two parts, so that slow motion far from the
//! origin is not lost to rounding. If there are more pairs or points than the lists hold, nothing is solved and
//! `status` says so.
//!
//! Input buffers: `solver_bodies`, `motion_states` and `forces` hold the bodies, followed by the half-spaces. Impulses
//! in `forces` are cleared. `new_numbers` maps the numbers that bodies had in the last collision substep to those of
//! this one; `u32::MAX` marks bodies that are gone. `contact_pairs` holds the touching pairs in ascending order,
//! `contact_points` their points, and `contact_counters` the number of both. Nothing is solved if `status` says that an
//! earlier list was too short.

pub mod arguments;
pub mod buffers;
mod hand_over;
pub mod layout;
pub mod record;
mod restitution;
pub mod upload;
mod warm_start;

pub use buffers::{SolverBuffers, SolverCapacity};
pub use record::Passes;

use super::{body_constants, overlap, solve};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

const CONSTANTS: Module = shared_constants!("faceoff::constants::solver", {
    f32 OPPOSED = overlap::OPPOSED;
    f32 CONFLICT_DEPTH = overlap::CONFLICT_DEPTH;
    f32 RESOLVED_DEPTH = overlap::RESOLVED_DEPTH;
    f32 MIN_DIRECTION_LENGTH = overlap::MIN_DIRECTION_LENGTH;
    f32 FREE_ANGLE = body_constants::FREE_ANGLE;
    f32 MAX_ROUNDS = body_constants::MAX_ROUNDS;
    f32 ACTIVATION_DISTANCE = solve::ACTIVATION_DISTANCE;
    f32 COARSE_DIGIT = upload::COARSE_DIGIT;
});

/// The solver's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        CONSTANTS,
        warm_start::CONSTANTS,
        restitution::CONSTANTS,
        module!("solver/types", layout::CONSTANTS),
        module!("solver/math"),
        module!("solver/motion"),
        module!("solver/overlap"),
        module!("solver/contact"),
        module!("solver/friction"),
    ],
    kernels: &[
        &arguments::ARGUMENTS,
        &record::BEGIN,
        &warm_start::BODY_REMAP,
        &record::CONSTRAINTS,
        &warm_start::WARM_START,
        &record::PAIR_ADJACENCY,
        &record::PAIR_ADJACENCY_RANGES,
        &record::SUBSTEP_BEGIN,
        &record::SOLVE,
        &record::APPLY_IMPULSES,
        &restitution::RESTITUTION_BEGIN,
        &restitution::RESTITUTION,
        &record::FINISH,
        &warm_start::WARM_START_SAVE,
    ],
};
