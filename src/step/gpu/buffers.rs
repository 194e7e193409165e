//! Buffers between contact generation and the solver, and buffers that persist between steps.

use crate::gpu::buffers::{Capacity, buffers, grow};
use crate::gpu::layout::{ContactPair, ContactPoint, Division, Meeting, Sweep, TALLIES, Touch};
use crate::manifolds::gpu::ContactCapacity;
use crate::solver::gpu::SolverCapacity;
use crate::solver::gpu::layout::{
    BodyForces, COUNTERS, CollisionSubstep, MotionState, SLOTS, SavedPair, SavedPoint, SolverBody,
};
use wgpu::Buffer;

/// Capacity of the lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepCapacity {
    /// Capacity of contact generation.
    pub contacts: ContactCapacity,
    /// Bodies and planes.
    pub bodies: u32,
    /// Points of touching pairs, in all collision substeps.
    pub touches: u32,
    /// Whether bodies are solved. Otherwise the solver's lists, and those between steps, have no elements.
    pub solves: bool,
    /// Whether some body has continuous collision. Otherwise the list that only it needs has no elements.
    pub has_fast_bodies: bool,
}

impl StepCapacity {
    /// At least `needed` of each, with some to spare where this capacity does not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            contacts: self.contacts.grown(needed.contacts),
            bodies: grow(self.bodies, needed.bodies),
            touches: grow(self.touches, needed.touches),
            solves: self.solves || needed.solves,
            has_fast_bodies: self.has_fast_bodies || needed.has_fast_bodies,
        }
    }

    /// The larger of two, list by list.
    pub fn max(self, other: Self) -> Self {
        Self {
            contacts: self.contacts.max(other.contacts),
            bodies: self.bodies.max(other.bodies),
            touches: self.touches.max(other.touches),
            solves: self.solves || other.solves,
            has_fast_bodies: self.has_fast_bodies || other.has_fast_bodies,
        }
    }

    /// Adds the largest possible numbers of pairs, slots and bodies: the device fills these lists.
    pub fn covering(mut self, capacity: &Capacity) -> Self {
        self.contacts.margin_pairs = capacity.pairs;
        self.contacts.slots = capacity
            .bodies
            .saturating_mul(capacity.planes)
            .saturating_add(capacity.pairs);
        self.bodies = self.bodies.max(capacity.bodies.saturating_add(capacity.planes));
        self
    }

    /// The number of bodies whose states at the start of a collision substep are kept until its end.
    fn kept_states(&self) -> u32 {
        if self.has_fast_bodies { self.bodies } else { 0 }
    }

    /// The capacity of the solver's own buffers.
    pub fn solver(&self) -> SolverCapacity {
        if !self.solves {
            return SolverCapacity::default();
        }
        SolverCapacity {
            bodies: self.bodies,
            pairs: self.contacts.pairs,
            points: self.contacts.points,
        }
    }
}

buffers! {
    /// The buffers besides those of contact generation and of the solver.
    StepBuffers(StepCapacity), |capacity| {
        /// Counters over all collision substeps of a step.
        tally: ARRAY u32, TALLIES, "tally of a step";
        /// Points of touching pairs, in any order.
        touches: ARRAY Touch, capacity.touches, "touches";
        /// Properties of bodies.
        solver_bodies: ARRAY SolverBody, capacity.solver().bodies, "solver bodies";
        /// Motion states as the host knows them.
        host_states: ARRAY MotionState, capacity.solver().bodies, "motion states of the host";
        /// Motion states during the step.
        motion_states: ARRAY MotionState, capacity.solver().bodies, "motion states";
        /// Motion states at the start of the collision substep, for continuous collision.
        earlier_states: ARRAY MotionState, capacity.kept_states(), "motion states before";
        /// External forces.
        forces: ARRAY BodyForces, capacity.solver().bodies, "forces";
        /// External forces as the host sends them. Kernels clear the impulses of the copy.
        sent_forces: ARRAY BodyForces, capacity.solver().bodies, "forces as sent";
        /// How the step is divided into collision substeps.
        division: UNIFORM Division, 1u32, "division of the step";
        /// The number of the pace of each body; see the solver's `paces`.
        body_paces: ARRAY u32, capacity.solver().bodies, "paces of bodies";
        /// What each collider sweeps over in the step.
        sweeps: ARRAY Sweep, capacity.solver().bodies, "sweeps";
        /// What can meet in each group of bodies.
        meetings: ARRAY Meeting, capacity.solver().bodies, "meetings";
        /// Parameters of the first collision substep.
        first_collision_substep: ARRAY CollisionSubstep, 1u32, "first collision substep";
        /// Parameters of later collision substeps.
        later_collision_substep: ARRAY CollisionSubstep, 1u32, "later collision substeps";
        /// New numbers of bodies, by their numbers in the last step.
        first_new_numbers: ARRAY u32, capacity.solver().bodies, "new numbers of bodies, first collision substep";
        /// New numbers of bodies for later collision substeps: the identity.
        later_new_numbers: ARRAY u32, capacity.solver().bodies, "new numbers of bodies, later collision substeps";
        /// The new numbers in use.
        new_numbers: ARRAY u32, capacity.solver().bodies, "new numbers of bodies";
        /// Arguments of the solver's indirect dispatches.
        solver_arguments: INDIRECT u32, 3 * SLOTS, "solver arguments";
        /// Motion states after the last step. This buffer and the following ones persist between steps.
        last_step_states: ARRAY MotionState, capacity.solver().bodies, "motion states of the last step";
        /// The solver's counters.
        last_step_counters: ARRAY u32, COUNTERS, "solver counters of the last step";
        /// Saved pairs.
        last_step_pairs: ARRAY SavedPair, capacity.solver().pairs, "saved pairs of the last step";
        /// Saved points.
        last_step_points: ARRAY SavedPoint, capacity.solver().points, "saved points of the last step";
        /// The pairs of the last contact generation.
        last_step_contact_pairs: ARRAY ContactPair, capacity.solver().pairs, "contact pairs of the last step";
        /// Contact points of the last step.
        last_step_contact_points: ARRAY ContactPoint, capacity.solver().points, "contact points of the last step";
    }
}

impl StepBuffers {
    /// The buffers that persist between steps.
    pub fn memory(&self) -> [&Buffer; 6] {
        [
            &self.last_step_states,
            &self.last_step_counters,
            &self.last_step_pairs,
            &self.last_step_points,
            &self.last_step_contact_pairs,
            &self.last_step_contact_points,
        ]
    }
}
