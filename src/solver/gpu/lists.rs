//! The solver's buffers: what it works on by itself, and what others hand to it.

use super::layout::*;
use crate::gpu::buffers::{TooLarge, check, grow, make};
use crate::gpu::device::Gpu;
use crate::gpu::layout::Impulse;
use crate::gpu::{radix_sort, scan};
use wgpu::{Buffer, BufferUsages};

/// How many of each thing fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Room {
    /// Bodies, half-spaces among them.
    pub bodies: u32,
    /// Pairs that touch.
    pub pairs: u32,
    /// Contact points.
    pub points: u32,
}

impl Room {
    /// At least `needed` of each, with some to spare where this does not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            bodies: grow(self.bodies, needed.bodies),
            pairs: grow(self.pairs, needed.pairs),
            points: grow(self.points, needed.points),
        }
    }

    /// Two ends a pair.
    fn ends(&self) -> u32 {
        self.pairs.saturating_mul(2)
    }

    /// Bits of a body's number, or of the one after the last.
    pub(super) fn body_bits(&self) -> u32 {
        32 - self.bodies.leading_zeros()
    }
}

macro_rules! lists {
    ($($name:ident: $what:literal, $element:ty, |$room:ident| $count:expr;)*) => {
        /// What the solver works on by itself; `shaders/solver/types.wgsl` explains the elements. `counters`, `kept_pairs`
        /// and `kept_points` are its memory and outlive an interval.
        #[derive(Debug)]
        #[allow(missing_docs)]
        pub struct Lists {
            /// What fits.
            pub room: Room,
            /// What an interval is told.
            pub interval: Buffer,
            $(pub $name: Buffer,)*
        }

        impl Lists {
            /// Makes all of them.
            ///
            /// # Errors
            /// If one is larger than the device allows; none is made then.
            pub fn new(gpu: &Gpu, room: Room) -> Result<Self, TooLarge> {
                $(let $name = {
                    let $room = &room;
                    check(gpu, $what, u64::from($count) * size_of::<$element>() as u64)?
                };)*
                Ok(Self {
                    room,
                    interval: make(gpu, "interval", 256, BufferUsages::UNIFORM),
                    $($name: make(gpu, $what, $name, BufferUsages::empty()),)*
                })
            }

            /// Bytes of all of them.
            pub fn bytes(&self) -> u64 {
                [&self.interval, $(&self.$name),*].into_iter().map(Buffer::size).sum()
            }
        }
    };
}

lists! {
    counters: "solver counters", u32, |_r| COUNTERS;
    movers: "movers", Mover, |r| r.bodies;
    velocities: "velocities", Velocity, |r| r.bodies;
    masses: "masses", Mass, |r| r.bodies;
    shifts: "shifts", Shift, |r| r.bodies;
    links: "ends and old numbers by body", [u32; 4], |r| r.bodies;
    islands: "islands of bodies", Island, |r| r.bodies;
    pairs: "solver pairs", SolverPair, |r| r.pairs;
    shapes: "shapes of points", PointShape, |r| r.points;
    points: "states of points", PointState, |r| r.points;
    kept_pairs: "kept pairs", KeptPair, |r| r.pairs;
    kept_points: "kept points", KeptPoint, |r| r.points;
    impulses: "impulses at ends", Impulse, |r| r.ends();
    keys: "bodies of ends", u32, |r| r.ends();
    values: "ends", u32, |r| r.ends();
    other_keys: "bodies of ends, scratch", u32, |r| r.ends();
    other_values: "ends, scratch", u32, |r| r.ends();
    digits: "sort digits", u32, |r| 256 * r.ends().div_ceil(radix_sort::BLOCK) + 1;
    sums: "scan sums", u32, |r| radix_sort::digit_groups(r.ends()).max(r.ends().div_ceil(scan::BLOCK)) + 1;
}

/// What the solver is handed: bodies and contacts, wherever they come from.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'b> {
    /// What bodies are: `SolverBody`. Half-spaces come after all others.
    pub bodies: &'b Buffer,
    /// Where they are: `BodyState`, read and written.
    pub states: &'b Buffer,
    /// What acts on them: `BodyForces`. Impulses are used up.
    pub forces: &'b Buffer,
    /// By the number that a body had in the interval before, its number now; `u32::MAX` if it is gone. As long as the
    /// interval's `old_bodies` say.
    pub renumbered: &'b Buffer,
    /// Pairs that touch: `ContactPair`, ascending.
    pub contact_pairs: &'b Buffer,
    /// Their points: `ContactPoint`.
    pub contact_points: &'b Buffer,
    /// Holds their numbers.
    pub contact_counters: &'b Buffer,
    /// Which counters are those of pairs and of points.
    pub counter_of: [u32; 2],
    /// Whether a list was too small so far (`OVERFLOW`); nothing is solved then.
    pub status: &'b Buffer,
    /// Arguments of indirect dispatches: the buffer that the program is recorded with.
    pub arguments: &'b Buffer,
    /// The first of [`SLOTS`] slots there.
    pub first_slot: u32,
}
