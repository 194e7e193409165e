//! Memory that the CPU's stages keep between steps, so that a step like the last one allocates nothing. No result depends on
//! it.

use crate::ccd::stops::Stops;
use crate::force_scan::touches::Touches;
use crate::sleep::cpu::Sleeper;
use crate::solver::{Solver, SolverBodies};
use crate::state::inactive::InactiveBodies;
use crate::state::margins::SpeculativeMargins;
use crate::{angles, broad_phase, force_scan, manifolds, triangle_test};

/// What the stages work on within a step.
#[derive(Default)]
pub struct StepScratch {
    /// The bodies' keys.
    pub(crate) keys: Vec<u64>,
    /// The bodies as the solver moves them, and after them the half-spaces.
    pub(crate) solver_bodies: SolverBodies,
    /// Which of them have not changed.
    pub(crate) inactive: InactiveBodies,
    /// How far bodies look for each other in this step.
    pub(crate) margins: SpeculativeMargins,
    /// Who touched whom so far.
    pub(crate) touches: Touches,
    /// Who was stopped so far.
    pub(crate) stops: Stops,
    pub(crate) solver: Solver,
    pub(crate) sleeper: Sleeper,
    pub(crate) broad_phase: broad_phase::cpu::Scratch,
    pub(crate) angles: angles::cpu::Scratch,
    pub(crate) triangle_test: triangle_test::cpu::Scratch,
    pub(crate) manifolds: manifolds::step::Scratch,
    pub(crate) force_scan: force_scan::cpu::Scratch,
}
