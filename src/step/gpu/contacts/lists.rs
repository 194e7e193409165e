//! What passes between contact generation and solver in a step, and what outlives it.

use crate::gpu::buffers::{TooLarge, check, grow, make};
use crate::gpu::device::Gpu;
use crate::gpu::layout::{ContactPair, ContactPoint, TALLIES, Touch};
use crate::manifolds::gpu::ContactCapacity;
use crate::solver::gpu::layout::{BodyForces, BodyState, COUNTERS, Interval, KeptPair, KeptPoint, SLOTS, SolverBody};
use wgpu::{Buffer, BufferUsages};

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
}

macro_rules! lists {
    ($($(#[$doc:meta])* $name:ident: $what:literal, $element:ty, $usage:expr, |$room:ident| $count:expr;)*) => {
        /// Buffers beside those of contact generation and of the solver.
        #[derive(Debug)]
        pub struct StepLists {
            $($(#[$doc])* pub $name: Buffer,)*
        }

        impl StepLists {
            /// Makes all of them.
            ///
            /// # Errors
            /// If one is larger than the device allows; none is made then.
            pub fn new(gpu: &Gpu, room: &StepCapacity) -> Result<Self, TooLarge> {
                $(let $name = {
                    let $room = room;
                    check(gpu, $what, u64::from($count) * size_of::<$element>() as u64)?
                };)*
                Ok(Self { $($name: make(gpu, $what, $name, $usage),)* })
            }

            /// Bytes of all of them.
            pub fn bytes(&self) -> u64 {
                [$(&self.$name),*].into_iter().map(Buffer::size).sum()
            }
        }
    };
}

const NONE: BufferUsages = BufferUsages::empty();

lists! {
    /// What counts over all intervals of a step.
    tally: "tally of a step", u32, NONE, |_r| TALLIES;
    /// Who touched whom and where, in any order.
    touches: "touches", Touch, NONE, |r| r.touches;
    /// What bodies are to the solver.
    bodies: "solver bodies", SolverBody, NONE, |r| r.bodies;
    /// Where they are, as the host knows.
    arrivals: "bodies as the host knows them", BodyState, NONE, |r| r.bodies;
    /// Where they are while the step runs.
    states: "states of bodies", BodyState, NONE, |r| r.bodies;
    /// What acts on them.
    forces: "forces", BodyForces, NONE, |r| r.bodies;
    /// What the solver is told about the first interval, and about each other one.
    first_interval: "first interval", Interval, NONE, |_r| 1u32;
    /// The other.
    other_interval: "other collision_substeps", Interval, NONE, |_r| 1u32;
    /// The bodies' numbers by those they had before the first interval, and before each other one.
    first_numbers: "new numbers of bodies", u32, NONE, |r| r.bodies;
    /// The other.
    other_numbers: "numbers of bodies", u32, NONE, |r| r.bodies;
    /// One of the two.
    renumbered: "numbers of bodies in an interval", u32, NONE, |r| r.bodies;
    /// Of the solver's indirect dispatches.
    arguments: "solver arguments", [u32; 3], BufferUsages::INDIRECT, |_r| SLOTS;
    /// Where the bodies were after the last step. Outlives a step, as do those that follow.
    settled: "settled bodies", BodyState, NONE, |r| r.bodies;
    /// How much the solver remembers.
    kept_counters: "kept solver counters", u32, NONE, |_r| COUNTERS;
    /// Of pairs.
    kept_pairs: "pairs kept between steps", KeptPair, NONE, |r| r.contacts.pairs;
    /// Of points.
    kept_points: "points kept between steps", KeptPoint, NONE, |r| r.contacts.points;
    /// What contact generation found last.
    last_pairs: "contact pairs of the last step", ContactPair, NONE, |r| r.contacts.pairs;
    /// The points.
    last_points: "contact points of the last step", ContactPoint, NONE, |r| r.contacts.points;
}

impl StepLists {
    /// What outlives a step.
    pub fn memory(&self) -> [&Buffer; 6] {
        [
            &self.settled,
            &self.kept_counters,
            &self.kept_pairs,
            &self.kept_points,
            &self.last_pairs,
            &self.last_points,
        ]
    }
}
