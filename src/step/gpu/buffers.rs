//! What passes between contact generation and solver in a step, and what outlives it.

use crate::gpu::buffers::{Sizes, buffers, grow};
use crate::gpu::layout::{ContactPair, ContactPoint, TALLIES, Touch};
use crate::manifolds::gpu::ContactCapacity;
use crate::solver::gpu::Room;
use crate::solver::gpu::layout::{BodyForces, BodyState, COUNTERS, Interval, KeptPair, KeptPoint, SLOTS, SolverBody};
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
    pub fn beside(mut self, sizes: &Sizes) -> Self {
        self.contacts.margin_pairs = sizes.pairs;
        self.contacts.slots = sizes.bodies.saturating_mul(sizes.planes).saturating_add(sizes.pairs);
        self.bodies = self.bodies.max(sizes.bodies.saturating_add(sizes.planes));
        self
    }

    /// What the solver's own buffers hold.
    pub fn solver(&self) -> Room {
        Room {
            bodies: self.bodies,
            pairs: self.contacts.pairs,
            points: self.contacts.points,
        }
    }
}

buffers! {
    /// Buffers beside those of contact generation and of the solver.
    StepBuffers(StepCapacity), |room| {
        /// What counts over all intervals of a step.
        tally: ARRAY u32, TALLIES, "tally of a step";
        /// Who touched whom and where, in any order.
        touches: ARRAY Touch, room.touches, "touches";
        /// What bodies are to the solver.
        solver_bodies: ARRAY SolverBody, room.bodies, "solver bodies";
        /// Where they are, as the host knows.
        arrivals: ARRAY BodyState, room.bodies, "bodies as the host knows them";
        /// Where they are while the step runs.
        states: ARRAY BodyState, room.bodies, "states of bodies";
        /// What acts on them.
        forces: ARRAY BodyForces, room.bodies, "forces";
        /// What the solver is told about the first interval, and about each other one.
        first_interval: ARRAY Interval, 1u32, "first interval";
        /// The other.
        other_interval: ARRAY Interval, 1u32, "other collision_substeps";
        /// The bodies' numbers by those they had before the first interval, and before each other one.
        first_numbers: ARRAY u32, room.bodies, "new numbers of bodies";
        /// The other.
        other_numbers: ARRAY u32, room.bodies, "numbers of bodies";
        /// One of the two.
        renumbered: ARRAY u32, room.bodies, "numbers of bodies in an interval";
        /// Of the solver's indirect dispatches.
        solver_arguments: INDIRECT u32, 3 * SLOTS, "solver arguments";
        /// Where the bodies were after the last step. Outlives a step, as do those that follow.
        settled: ARRAY BodyState, room.bodies, "settled bodies";
        /// How much the solver remembers.
        stored_counters: ARRAY u32, COUNTERS, "stored solver counters";
        /// Of pairs.
        stored_pairs: ARRAY KeptPair, room.contacts.pairs, "pairs stored between steps";
        /// Of points.
        stored_points: ARRAY KeptPoint, room.contacts.points, "points stored between steps";
        /// What contact generation found last.
        stored_contact_pairs: ARRAY ContactPair, room.contacts.pairs, "contact pairs stored between steps";
        /// The points.
        stored_contact_points: ARRAY ContactPoint, room.contacts.points, "contact points stored between steps";
    }
}

impl StepBuffers {
    /// What outlives a step.
    pub fn memory(&self) -> [&Buffer; 6] {
        [
            &self.settled,
            &self.stored_counters,
            &self.stored_pairs,
            &self.stored_points,
            &self.stored_contact_pairs,
            &self.stored_contact_points,
        ]
    }
}
