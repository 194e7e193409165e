//! The buffers that the solver works on by itself. Bodies, contacts and what others hand to it are theirs.

use super::layout::*;
use crate::gpu::buffers::{buffers, grow};
use crate::gpu::layout::Impulse;
use crate::gpu::radix_sort::{self, DIGITS};
use crate::gpu::scan;

/// How many of each thing fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolverCapacity {
    /// Bodies, half-spaces among them.
    pub bodies: u32,
    /// Pairs that touch.
    pub pairs: u32,
    /// Contact points.
    pub points: u32,
}

impl SolverCapacity {
    /// At least `needed` of each, with some to spare where this does not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            bodies: grow(self.bodies, needed.bodies),
            pairs: grow(self.pairs, needed.pairs),
            points: grow(self.points, needed.points),
        }
    }

    /// Two ends a pair.
    fn sides(&self) -> u32 {
        self.pairs.saturating_mul(2)
    }

    /// Bits of a body's number, or of the one after the last.
    pub(super) fn body_bits(&self) -> u32 {
        32 - self.bodies.leading_zeros()
    }
}

buffers! {
    /// What the solver works on by itself; `shaders/solver/types.wgsl` explains the elements. `solver_counters`, `saved_pairs`
    /// and `saved_points` are its memory and outlive an interval.
    SolverBuffers(SolverCapacity), |capacity| {
        /// What an interval is told.
        collision_substep: UNIFORM CollisionSubstep, 1u32, "collision_substep";
        solver_counters: ARRAY u32, COUNTERS, "solver counters";
        body_constants: ARRAY BodyConstants, capacity.bodies, "body_constants";
        velocities: ARRAY Velocity, capacity.bodies, "velocities";
        masses: ARRAY Mass, capacity.bodies, "masses";
        pose_changes: ARRAY PoseChange, capacity.bodies, "pose_changes";
        body_adjacency: ARRAY BodyAdjacency, capacity.bodies, "sides and old numbers by body";
        islands: ARRAY Island, capacity.bodies, "islands of bodies";
        solver_pairs: ARRAY SolverPair, capacity.pairs, "solver pairs";
        point_constants: ARRAY PointConstants, capacity.points, "point_constants of points";
        point_states: ARRAY PointState, capacity.points, "states of points";
        saved_pairs: ARRAY SavedPair, capacity.pairs, "kept pairs";
        saved_points: ARRAY SavedPoint, capacity.points, "kept points";
        side_impulses: ARRAY Impulse, capacity.sides(), "impulses at sides";
        /// Bodies of ends, and ends; two pairs of arrays between which the sort moves them.
        side_keys: ARRAY u32, capacity.sides(), "bodies of sides";
        sides: ARRAY u32, capacity.sides(), "sides";
        other_side_keys: ARRAY u32, capacity.sides(), "bodies of sides, scratch";
        other_sides: ARRAY u32, capacity.sides(), "sides, scratch";
        side_digits: ARRAY u32, DIGITS * capacity.sides().div_ceil(radix_sort::BLOCK) + 1, "sort digits";
        side_sums: ARRAY u32, radix_sort::digit_groups(capacity.sides()).max(capacity.sides().div_ceil(scan::BLOCK)) + 1, "scan sums";
    }
}
