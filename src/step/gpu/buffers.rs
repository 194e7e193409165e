//! What passes between contact generation and solver in a step, and what outlives it.

use crate::gpu::buffers::{Capacity, buffers, grow};
use crate::gpu::layout::{ContactPair, ContactPoint, TALLIES, Touch};
use crate::manifolds::gpu::ContactCapacity;
use crate::solver::gpu::SolverCapacity;
use crate::solver::gpu::layout::{BodyForces, MotionState, COUNTERS, CollisionSubstep, SavedPair, SavedPoint, SLOTS, SolverBody};
use wgpu::Buffer;

/// How many of each thing fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepCapacity {
    /// What contact generation makes.
    pub contacts: ContactCapacity,
    /// Bodies and half-spaces.
    pub bodies: u32,
    /// Points of pairs that touch, in all intervals.
    pub touches: u32,
}

impl StepCapacity {
    /// At least `needed` of each, with room to spare where these do not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            contacts: self.contacts.grown(needed.contacts),
            bodies: grow(self.bodies, needed.bodies),
            touches: grow(self.touches, needed.touches),
        }
    }

    /// The same with as many pairs, slots and bodies as there can be: their lists are made on the device.
    pub fn covering(mut self, capacity: &Capacity) -> Self {
        self.contacts.margin_pairs = capacity.pairs;
        self.contacts.slots = capacity.bodies.saturating_mul(capacity.planes).saturating_add(capacity.pairs);
        self.bodies = self.bodies.max(capacity.bodies.saturating_add(capacity.planes));
        self
    }

    /// What the solver's own buffers hold.
    pub fn solver(&self) -> SolverCapacity {
        SolverCapacity {
            bodies: self.bodies,
            pairs: self.contacts.pairs,
            points: self.contacts.points,
        }
    }
}

buffers! {
    /// Buffers beside those of contact generation and of the solver.
    StepBuffers(StepCapacity), |capacity| {
        /// What counts over all intervals of a step.
        tally: ARRAY u32, TALLIES, "tally of a step";
        /// Who touched whom and where, in any order.
        touches: ARRAY Touch, capacity.touches, "touches";
        /// What bodies are to the solver.
        solver_bodies: ARRAY SolverBody, capacity.bodies, "solver bodies";
        /// Where they are, as the host knows.
        host_states: ARRAY MotionState, capacity.bodies, "bodies as the host knows them";
        /// Where they are while the step runs.
        motion_states: ARRAY MotionState, capacity.bodies, "states of bodies";
        /// What acts on them.
        forces: ARRAY BodyForces, capacity.bodies, "forces";
        /// What the solver is told about the first interval, and about each other one.
        first_collision_substep: ARRAY CollisionSubstep, 1u32, "first collision_substep";
        /// The other.
        later_collision_substep: ARRAY CollisionSubstep, 1u32, "other collision_substeps";
        /// The bodies' numbers by those they had before the first interval, and before each other one.
        first_new_numbers: ARRAY u32, capacity.bodies, "new numbers of bodies";
        /// The other.
        later_new_numbers: ARRAY u32, capacity.bodies, "numbers of bodies";
        /// One of the two.
        new_numbers: ARRAY u32, capacity.bodies, "numbers of bodies in an collision_substep";
        /// Of the solver's indirect dispatches.
        solver_arguments: INDIRECT u32, 3 * SLOTS, "solver arguments";
        /// Where the bodies were after the last step. Outlives a step, as do those that follow.
        last_step_states: ARRAY MotionState, capacity.bodies, "last_step_states bodies";
        /// How much the solver remembers.
        last_step_counters: ARRAY u32, COUNTERS, "stored solver counters";
        /// Of pairs.
        last_step_pairs: ARRAY SavedPair, capacity.contacts.pairs, "pairs stored between steps";
        /// Of points.
        last_step_points: ARRAY SavedPoint, capacity.contacts.points, "points stored between steps";
        /// What contact generation found last.
        last_step_contact_pairs: ARRAY ContactPair, capacity.contacts.pairs, "contact pairs stored between steps";
        /// The points.
        last_step_contact_points: ARRAY ContactPoint, capacity.contacts.points, "contact points stored between steps";
    }
}

impl StepBuffers {
    /// What outlives a step.
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
