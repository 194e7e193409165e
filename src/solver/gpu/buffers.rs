//! The buffers that the solver works on by itself. Bodies, contacts and what others hand to it are theirs.

use super::layout::*;
use crate::gpu::buffers::{buffers, grow};
use crate::gpu::layout::Impulse;
use crate::gpu::radix_sort::{self, DIGITS};
use crate::gpu::scan;

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

buffers! {
    /// What the solver works on by itself; `shaders/solver/types.wgsl` explains the elements. `solver_counters`, `kept_pairs`
    /// and `kept_points` are its memory and outlive an interval.
    SolverBuffers(Room), |room| {
        /// What an interval is told.
        interval: UNIFORM Interval, 1u32, "interval";
        solver_counters: ARRAY u32, COUNTERS, "solver counters";
        movers: ARRAY Mover, room.bodies, "movers";
        velocities: ARRAY Velocity, room.bodies, "velocities";
        masses: ARRAY Mass, room.bodies, "masses";
        shifts: ARRAY Shift, room.bodies, "shifts";
        links: ARRAY [u32; 4], room.bodies, "ends and old numbers by body";
        islands: ARRAY Island, room.bodies, "islands of bodies";
        solver_pairs: ARRAY SolverPair, room.pairs, "solver pairs";
        shapes: ARRAY PointShape, room.points, "shapes of points";
        points: ARRAY PointState, room.points, "states of points";
        kept_pairs: ARRAY KeptPair, room.pairs, "kept pairs";
        kept_points: ARRAY KeptPoint, room.points, "kept points";
        end_impulses: ARRAY Impulse, room.ends(), "impulses at ends";
        /// Bodies of ends, and ends; two pairs of arrays between which the sort moves them.
        end_keys: ARRAY u32, room.ends(), "bodies of ends";
        ends: ARRAY u32, room.ends(), "ends";
        other_end_keys: ARRAY u32, room.ends(), "bodies of ends, scratch";
        other_ends: ARRAY u32, room.ends(), "ends, scratch";
        end_digits: ARRAY u32, DIGITS * room.ends().div_ceil(radix_sort::BLOCK) + 1, "sort digits";
        end_sums: ARRAY u32, radix_sort::digit_groups(room.ends()).max(room.ends().div_ceil(scan::BLOCK)) + 1, "scan sums";
    }
}
