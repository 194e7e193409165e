//! The buffers that only the solver uses. Bodies and contacts belong to others.

use super::layout::*;
use crate::gpu::buffers::{buffers, grow};
use crate::gpu::layout::Impulse;
use crate::gpu::radix_sort::{self, DIGITS};
use crate::gpu::scan;

/// Capacity of the lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolverCapacity {
    /// Bodies and half-spaces.
    pub bodies: u32,
    /// Touching pairs.
    pub pairs: u32,
    /// Contact points.
    pub points: u32,
}

impl SolverCapacity {
    /// At least `needed` of each, with some to spare where this capacity does not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            bodies: grow(self.bodies, needed.bodies),
            pairs: grow(self.pairs, needed.pairs),
            points: grow(self.points, needed.points),
        }
    }

    /// Two sides per pair.
    fn sides(&self) -> u32 {
        self.pairs.saturating_mul(2)
    }

    /// Number of bits of a body's index, or of the one after the last.
    pub(super) fn body_bits(&self) -> u32 {
        32 - self.bodies.leading_zeros()
    }
}

buffers! {
    /// The solver's own buffers. `shaders/solver/types.wgsl` explains their elements. `solver_counters`, `saved_pairs`
    /// and `saved_points` persist between collision substeps.
    SolverBuffers(SolverCapacity), |capacity| {
        /// Parameters.
        collision_substep: UNIFORM CollisionSubstep, 1u32, "collision substep";
        solver_counters: ARRAY u32, COUNTERS, "solver counters";
        body_constants: ARRAY BodyConstants, capacity.bodies, "body constants";
        velocities: ARRAY Velocity, capacity.bodies, "velocities";
        masses: ARRAY Mass, capacity.bodies, "masses";
        pose_changes: ARRAY PoseChange, capacity.bodies, "pose changes";
        body_adjacency: ARRAY BodyAdjacency, capacity.bodies, "body adjacency";
        islands: ARRAY Island, capacity.bodies, "islands of bodies";
        solver_pairs: ARRAY SolverPair, capacity.pairs, "solver pairs";
        point_constants: ARRAY PointConstants, capacity.points, "point constants";
        point_states: ARRAY PointState, capacity.points, "point states";
        saved_pairs: ARRAY SavedPair, capacity.pairs, "saved pairs";
        saved_points: ARRAY SavedPoint, capacity.points, "saved points";
        side_impulses: ARRAY Impulse, capacity.sides(), "impulses by side";
        /// Keys and sides; the sort moves them between two pairs of arrays.
        side_keys: ARRAY u32, capacity.sides(), "bodies of sides";
        sides: ARRAY u32, capacity.sides(), "sides";
        other_side_keys: ARRAY u32, capacity.sides(), "bodies of sides, scratch";
        other_sides: ARRAY u32, capacity.sides(), "sides, scratch";
        side_digits: ARRAY u32, DIGITS * capacity.sides().div_ceil(radix_sort::BLOCK) + 1, "sort digits";
        side_sums: ARRAY u32, radix_sort::digit_groups(capacity.sides()).max(capacity.sides().div_ceil(scan::BLOCK)) + 1, "scan sums";
    }
}
