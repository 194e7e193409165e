//! Scratch memory of the CPU's stages. It is reused, so that a step like the last one allocates nothing. No result
//! depends on it.

use super::hooks::LeftOut;
use super::reach::Reach;
use super::schedule::Schedule;
use crate::ccd::stage::Ccd;
use crate::force_scan::touches::Touches;
use crate::sleep::cpu::Sleeper;
use crate::solver::{Solver, SolverBodies};
use crate::state::inactive::InactiveBodies;
use crate::state::margins::SpeculativeMargins;
use crate::{angles, broad_phase, force_scan, manifolds, triangle_test};

/// Scratch memory of the stages.
#[derive(Default)]
pub struct StepScratch {
    /// The bodies' keys.
    pub(crate) keys: Vec<u64>,
    /// The solver's bodies, followed by the half-spaces.
    pub(crate) solver_bodies: SolverBodies,
    /// Which of them are unchanged since the last collision substep.
    pub(crate) inactive: InactiveBodies,
    /// The pairs that a hook left out of this collision substep.
    pub(crate) left_out: LeftOut,
    /// Which bodies can meet in this step.
    pub(crate) reach: Reach,
    /// The collision substeps of this step.
    pub(crate) schedule: Schedule,
    /// The speculative margins of this step.
    pub(crate) margins: SpeculativeMargins,
    /// The touching pairs of the step so far.
    pub(crate) touches: Touches,
    /// Continuous collision detection, with the impacts of the step so far.
    pub(crate) ccd: Ccd,
    /// Most near pairs of a collision substep, if the first one has left pairs out.
    pub(crate) most_near_pairs: Option<usize>,
    pub(crate) solver: Solver,
    pub(crate) sleeper: Sleeper,
    pub(crate) broad_phase: broad_phase::cpu::Scratch,
    pub(crate) angles: angles::cpu::Scratch,
    pub(crate) triangle_test: triangle_test::cpu::Scratch,
    pub(crate) manifolds: manifolds::step::Scratch,
    pub(crate) force_scan: force_scan::cpu::Scratch,
}
