//! The solver on the GPU, with bodies, contacts and saved impulses in buffers. It uses the method of the CPU's solver.
//!
//! Bodies are joined into islands by union-find, and pairs are sorted by island. One workgroup solves an island, with
//! all its substeps and passes, in one dispatch. Before that it colours the pairs: those of one colour have no body in
//! common that impulses move. A pass visits the colours one after the other, with a barrier between them, and the pairs
//! of a colour at once, with one thread each. Colours and sums do not depend on the order of threads, so the same input
//! gives the same bits.
//!
//! The pairs of a colour go to 8 threads, or to 64 in islands of more than 128 pairs: a software driver pays for idle
//! threads as much as for busy ones. A real GPU does not, but there the time is that of the island with the longest
//! chain of points, one after the other, whatever the number of threads.
//!
//! Limits: an island of many thousands of pairs occupies one workgroup while the rest of the device is idle. A body
//! with a thousand pairs needs a thousand colours. Passes are bounded as on the CPU, and further where heavy loads
//! shorten the substeps, so that no dispatch takes long.
//!
//! | file | contents |
//! |---|---|
//! | [`layout`] | structs and constants that kernels and host share |
//! | [`buffers`] | the buffers |
//! | [`arguments`] | workgroup counts |
//! | [`record`](mod@record) | the calls of a collision substep |
//! | `islands` | islands, colours, and the calls that solve them |
//! | `warm_start` | matching and saving of impulses |
//! | [`upload`] | conversion of the host's bodies and contacts |
//! | `hand_over` | conversion of the impulses that the CPU has saved, and back |
//!
//! The device has no double precision. Centres and rotations are stored in two parts, so that slow motion far from the
//! origin is not lost to rounding. If there are more pairs or points than the lists hold, nothing is solved and
//! `status` says so.
//!
//! Input buffers: `solver_bodies`, `motion_states` and `forces` hold the bodies, followed by the planes. Impulses in
//! `forces` are cleared. `new_numbers` maps the numbers that bodies had in the last collision substep to those of this
//! one; `u32::MAX` marks bodies that are gone. `body_paces` has the number of each body's pace among `paces`, or
//! `u32::MAX` if it is static or has completed its step: as on the CPU, each body has its own number of collision
//! substeps, and a pair whose bodies do not move keeps its impulses. `contact_pairs` holds the touching pairs in
//! ascending order, `contact_points` their points, and `contact_counters` the number of both. Nothing is solved if
//! `status` says that an earlier list was too short.

pub mod arguments;
pub mod buffers;
mod hand_over;
mod islands;
pub mod layout;
pub mod record;
pub mod upload;
mod warm_start;

pub use buffers::{SolverBuffers, SolverCapacity};

use super::{body_constants, clearance, load, overlap, patch, restitution, softness, solve, substep};
use crate::gpu::shader::{Module, Shaders, module, shared_constants};
use crate::types::solver_settings::MAX_COLLISION_SUBSTEPS;

/// Most points times passes of an island in one part of the substeps into which heavy loads divide one.
///
/// On a real GPU the points of a pair come one after the other. Without this limit a single island of 50 points with 16
/// times the substeps took a hundred milliseconds of a step. The CPU is much faster at a single island and has no such
/// limit.
const SUBSTEP_BUDGET: u32 = 4 * substep::PASS_BUDGET;

const CONSTANTS: Module = shared_constants!("faceoff::constants::solver", {
    f32 OPPOSED = overlap::OPPOSED;
    f32 OPPOSITE = clearance::OPPOSITE;
    f32 ALIKE = clearance::ALIKE;
    u32 MOST_COMPARED = clearance::MOST_COMPARED;
    f32 CONFLICT_DEPTH = overlap::CONFLICT_DEPTH;
    f32 RESOLVED_DEPTH = overlap::RESOLVED_DEPTH;
    f32 MIN_DIRECTION_LENGTH = overlap::MIN_DIRECTION_LENGTH;
    f32 FREE_ANGLE = body_constants::FREE_ANGLE;
    f32 MAX_ROUNDS = body_constants::MAX_ROUNDS;
    f32 ACTIVATION_DISTANCE = solve::ACTIVATION_DISTANCE;
    f32 MAX_STEP_ERROR = solve::MAX_STEP_ERROR;
    f32 SOFTEST = softness::SOFTEST;
    f32 CORNER = softness::CORNER;
    u32 FEW_PASSES = softness::FEW_PASSES;
    f32 MAX_COMPRESSION = load::MAX_COMPRESSION;
    f32 MAX_FACTOR = load::MAX_FACTOR;
    f32 SQUEEZED = load::SQUEEZED;
    f32 MAX_STRESS = load::MAX_STRESS;
    f32 POINT_BUDGET = load::POINT_BUDGET;
    u32 PASS_BUDGET = substep::PASS_BUDGET;
    u32 SUBSTEP_BUDGET = SUBSTEP_BUDGET;
    f32 RESTITUTION_TOLERANCE = restitution::TOLERANCE;
    f32 SAME_NORMAL = patch::SAME_NORMAL;
    f32 FLATNESS = patch::FLATNESS;
    f32 INSIDE = patch::INSIDE;
    u32 MAX_PATCH_POINTS = patch::MAX_POINTS;
    u32 MAX_COLLISION_SUBSTEPS = MAX_COLLISION_SUBSTEPS;
    f32 COARSE_DIGIT = upload::COARSE_DIGIT;
});

/// The solver's modules and kernels.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        CONSTANTS,
        warm_start::CONSTANTS,
        module!("solver/types", layout::CONSTANTS),
        module!("solver/math"),
        module!("solver/paces"),
        module!("solver/motion"),
        module!("solver/overlap"),
        module!("solver/clearance"),
        module!("solver/patch"),
        module!("solver/union_find"),
        module!("solver/contact"),
        module!("solver/points"),
        module!("solver/friction"),
        module!("solver/solve"),
        module!("solver/restitution"),
        module!("solver/load"),
    ],
    kernels: &[
        &arguments::ARGUMENTS,
        &record::BEGIN,
        &warm_start::BODY_REMAP,
        &record::CONSTRAINTS,
        &warm_start::WARM_START,
        &islands::ISLAND_JOIN,
        &islands::ISLAND_KEYS,
        &islands::ISLAND_RANGES,
        &islands::ISLAND_ARGUMENTS,
        &islands::ISLAND_COLORS[0],
        &islands::ISLAND_COLORS[1],
        &islands::SUBSTEP[0],
        &islands::SUBSTEP[1],
        &record::FINISH,
        &warm_start::WARM_START_SAVE,
    ],
};
