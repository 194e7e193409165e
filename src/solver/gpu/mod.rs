//! The solver on the GPU: what [`Solver`](super::Solver) does, with bodies, contacts and the memory of impulses in buffers.
//!
//! A thread a pair solves the pair's points, a thread a body sums the impulses of its ends; the ends are sorted by body
//! once an interval. Every sum is in the order of pairs, so the same input gives the same bits.
//!
//! | file | holds |
//! |---|---|
//! | [`layout`] | what passes between kernels and host |
//! | [`buffers`] | where it lies |
//! | [`record`](mod@record) | an interval as calls |
//! | [`upload`] | from the host's bodies and contacts to the device's, and back |
//!
//! The device has no double precision: centres and rotations are kept in two parts, so that what moves slowly far from the
//! origin moves all the same. If there are more pairs or points than the lists hold, nothing is solved and the status says
//! so.
//!
//! Bodies are in `solver_bodies`, `states` and `forces`, half-spaces after all others; forces are used up. `renumbered` has, by
//! the number that a body had in the interval before, its number now; `u32::MAX` if it is gone. Pairs that touch are in
//! `contact_pairs`, ascending, their points in `contact_points`, and their numbers in `contact_counters`. Nothing is solved if
//! `status` says that a list was too small so far.

pub mod buffers;
pub mod layout;
pub mod record;
pub mod upload;

pub use buffers::{Room, SolverBuffers};
pub use record::Passes;

use super::{body_constants, overlap, restitution, solve, warm_start};
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};

/// Workgroups for all others.
const ARGUMENTS: Kernel = kernel!("solver/arguments");
/// Bodies take over poses, velocities and impulses from outside.
const BEGIN: Kernel = kernel!("solver/begin");
/// Numbers that bodies had in the interval before.
const WARM_START_RENUMBER: Kernel = kernel!("solver/warm_start_renumber");
/// What holds for all points of a pair.
const CONSTRAINTS: Kernel = kernel!("solver/constraints");
/// Points as they are solved, with last interval's impulses.
const WARM_START: Kernel = kernel!("solver/warm_start");
/// Ends of pairs, keyed by body.
const ENDS: Kernel = kernel!("solver/ends");
/// Where each body's ends are.
const SEGMENTS: Kernel = kernel!("solver/segments");
/// Pairs measure their points and give last substep's impulses again.
const SUBSTEP_BEGIN: Kernel = kernel!("solver/substep");
/// One pass over the points of every pair.
const SOLVE: Kernel = kernel!("solver/solve");
/// Bodies take impulses, and may move and speed up.
const APPLY_IMPULSES: Kernel = kernel!("solver/apply_impulses");
/// Which pairs bounce.
const RESTITUTION_BEGIN: Kernel = kernel!("solver/restitution_begin");
/// One pass over the pairs that bounce.
const RESTITUTION: Kernel = kernel!("solver/restitution");
/// Where the bodies are after the interval.
const FINISH: Kernel = kernel!("solver/finish");
/// What is kept until the next interval.
const WARM_START_KEEP: Kernel = kernel!("solver/warm_start_keep");

const CONSTANTS: Module = shared_constants!("faceoff::constants::solver", {
    f32 OPPOSED = overlap::OPPOSED;
    f32 CONFLICT_DEPTH = overlap::CONFLICT_DEPTH;
    f32 RESOLVED_DEPTH = overlap::RESOLVED_DEPTH;
    vec3 DEFAULT_DIRECTION = overlap::DEFAULT_DIRECTION;
    f32 MIN_DIRECTION_LENGTH = overlap::MIN_DIRECTION_LENGTH;
    f32 FREE_ANGLE = body_constants::FREE_ANGLE;
    f32 MAX_ROUNDS = body_constants::MAX_ROUNDS;
    u32 RESTITUTION_SWEEPS = restitution::RESTITUTION_SWEEPS;
    f32 ACTIVATION_DISTANCE = solve::ACTIVATION_DISTANCE;
    u32 MAX_MATCHED = warm_start::MAX_MATCHED;
    f32 MAX_IMPULSE_SCALE = warm_start::MAX_IMPULSE_SCALE;
    f32 COARSE_DIGIT = upload::COARSE_DIGIT;
});

/// All of them.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        CONSTANTS,
        module!("solver/types", layout::CONSTANTS),
        module!("solver/math"),
        module!("solver/motion"),
        module!("solver/overlap"),
        module!("solver/contact"),
        module!("solver/friction"),
    ],
    kernels: &[
        &ARGUMENTS,
        &BEGIN,
        &WARM_START_RENUMBER,
        &CONSTRAINTS,
        &WARM_START,
        &ENDS,
        &SEGMENTS,
        &SUBSTEP_BEGIN,
        &SOLVE,
        &APPLY_IMPULSES,
        &RESTITUTION_BEGIN,
        &RESTITUTION,
        &FINISH,
        &WARM_START_KEEP,
    ],
};
