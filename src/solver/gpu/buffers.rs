//! The buffers that only the solver uses. Bodies and contacts belong to others.

use super::layout::*;
use crate::gpu::buffers::{buffers, grow};
use crate::gpu::radix_sort::{self, DIGITS};
use crate::types::solver_settings::MAX_COLLISION_SUBSTEPS;

/// Capacity of the lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolverCapacity {
    /// Bodies and planes.
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
        /// The pace of bodies with one collision substep in the step, with two, and so on.
        paces: UNIFORM Pace, MAX_COLLISION_SUBSTEPS, "paces";
        solver_counters: ARRAY u32, COUNTERS, "solver counters";
        body_constants: ARRAY BodyConstants, capacity.bodies, "body constants";
        body_states: ARRAY BodyState, capacity.bodies, "body states";
        body_colors: ARRAY BodyColors, capacity.bodies, "colours of bodies";
        /// The number of each body in the last collision substep.
        old_numbers: ARRAY u32, capacity.bodies, "old numbers of bodies";
        islands: ARRAY Island, capacity.bodies, "islands of bodies";
        solver_pairs: ARRAY SolverPair, capacity.pairs, "solver pairs";
        point_constants: ARRAY PointConstants, capacity.points, "point constants";
        point_states: ARRAY PointState, capacity.points, "point states";
        saved_pairs: ARRAY SavedPair, capacity.pairs, "saved pairs";
        saved_points: ARRAY SavedPoint, capacity.points, "saved points";
        /// Small islands from the front, large ones from the back.
        island_ranges: ARRAY IslandRange, capacity.bodies, "islands";
        island_pairs: ARRAY IslandPair, capacity.pairs, "pairs of islands";
        /// Pairs by island; the sort moves keys and pairs between two pairs of arrays.
        island_keys: ARRAY u32, capacity.pairs, "islands of pairs";
        pair_order: ARRAY u32, capacity.pairs, "order of pairs";
        other_island_keys: ARRAY u32, capacity.pairs, "islands of pairs, scratch";
        other_pair_order: ARRAY u32, capacity.pairs, "order of pairs, scratch";
        island_digits: ARRAY u32, DIGITS * capacity.pairs.div_ceil(radix_sort::BLOCK) + 1, "sort digits";
        island_sums: ARRAY u32, radix_sort::digit_groups(capacity.pairs) + 1, "scan sums";
    }
}
