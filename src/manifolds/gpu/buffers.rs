//! The buffers of contact generation, and their capacity.

use crate::gpu::buffers::{buffers, grow};
use crate::gpu::layout::{
    CONTACT_COUNTERS, ContactLimits, ContactPair, ContactPoint, Feature, MarginPair, NearPiece, PairSetup, Patch,
    Segment,
};
use crate::gpu::scan;

/// Capacity of the lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactCapacity {
    /// The number of batches in which the pairs share the lists of [`ContactScratch`]; at least 1.
    pub batches: u32,
    /// Pairs of bodies whose contact points are requested.
    pub margin_pairs: u32,
    /// `margin_pairs` plus bodies times planes.
    pub slots: u32,
    /// Pairs of triangles that are near each other, of a batch.
    pub near_triangles: u32,
    /// Pieces of pairs of large meshes, of a batch.
    pub pieces: u32,
    /// Features before the reduction, of a batch.
    pub features: u32,
    /// Segments in which triangles cross, of a batch.
    pub segments: u32,
    /// Points in any order.
    pub staged_points: u32,
    /// Pairs with points.
    pub pairs: u32,
    /// Points.
    pub points: u32,
}

impl Default for ContactCapacity {
    /// No elements, in one batch.
    fn default() -> Self {
        Self {
            batches: 1,
            margin_pairs: 0,
            slots: 0,
            near_triangles: 0,
            pieces: 0,
            features: 0,
            segments: 0,
            staged_points: 0,
            pairs: 0,
            points: 0,
        }
    }
}

impl ContactCapacity {
    /// At least `needed` of each, with some to spare where this capacity does not suffice. The lists of batches must
    /// have been measured with as many batches as this capacity has. If one of them is too short, there are at least as
    /// many batches as `needed` has; lists get longer only if they are still too short.
    pub fn grown(self, needed: Self) -> Self {
        let batches = if self.holds_batches_of(&needed) {
            self.batches
        } else {
            self.batches.max(needed.batches)
        };
        let measured = Self {
            batches: self.batches,
            ..needed
        };
        let [has, needed] = [self, measured].map(|lists| lists.in_batches(batches));
        Self {
            batches,
            margin_pairs: grow(has.margin_pairs, needed.margin_pairs),
            slots: grow(has.slots, needed.slots),
            near_triangles: grow(has.near_triangles, needed.near_triangles),
            pieces: grow(has.pieces, needed.pieces),
            features: grow(has.features, needed.features),
            segments: grow(has.segments, needed.segments),
            staged_points: grow(has.staged_points, needed.staged_points),
            pairs: grow(has.pairs, needed.pairs),
            points: grow(has.points, needed.points),
        }
    }

    fn holds_batches_of(&self, needed: &Self) -> bool {
        needed.near_triangles <= self.near_triangles
            && needed.pieces <= self.pieces
            && needed.features <= self.features
            && needed.segments <= self.segments
    }

    /// The capacity for these pairs in another number of batches, if all pairs need about the same. With fewer batches
    /// it is an upper bound.
    pub fn in_batches(self, batches: u32) -> Self {
        let share = |length: u32| {
            let all = u64::from(length) * u64::from(self.batches);
            all.div_ceil(u64::from(batches)).min(u32::MAX.into()) as u32
        };
        Self {
            batches,
            near_triangles: share(self.near_triangles),
            pieces: share(self.pieces),
            features: share(self.features),
            segments: share(self.segments),
            ..self
        }
    }

    /// The larger of two, list by list.
    pub fn max(self, other: Self) -> Self {
        Self {
            batches: self.batches.max(other.batches),
            margin_pairs: self.margin_pairs.max(other.margin_pairs),
            slots: self.slots.max(other.slots),
            near_triangles: self.near_triangles.max(other.near_triangles),
            pieces: self.pieces.max(other.pieces),
            features: self.features.max(other.features),
            segments: self.segments.max(other.segments),
            staged_points: self.staged_points.max(other.staged_points),
            pairs: self.pairs.max(other.pairs),
            points: self.points.max(other.points),
        }
    }

    /// Pairs of a batch.
    pub fn batch_pairs(&self) -> u32 {
        self.margin_pairs.div_ceil(self.batches)
    }

    /// The limits for the kernels.
    pub fn limits(&self, bodies: u32, planes: u32) -> ContactLimits {
        ContactLimits {
            near_triangles: self.near_triangles,
            features: self.features,
            segments: self.segments,
            staged_points: self.staged_points,
            pairs: self.pairs,
            points: self.points,
            bodies,
            planes,
            padding: [0; 3],
            pieces: self.pieces,
        }
    }
}

buffers! {
    /// The buffers of contact generation for all pairs. `shaders/shared/types.wgsl` explains their elements.
    ContactBuffers(ContactCapacity), |capacity| {
        /// Lengths of the lists.
        limits: UNIFORM ContactLimits, 1u32, "contact limits";
        /// The host zeroes them.
        contact_counters: ARRAY u32, CONTACT_COUNTERS, "contact counters";
        /// Arguments of indirect dispatches.
        contact_arguments: INDIRECT u32, 16u32, "contact arguments";
        /// Arguments of indirect dispatches for pieces of pairs: three words for each of two searches.
        near_arguments: INDIRECT u32, 6u32, "contact arguments for pieces";
        /// Pairs of bodies, ascending.
        margin_pairs: ARRAY MarginPair, capacity.margin_pairs, "pairs with margins";
        /// The numbers of pairs whose contact points are found, in any order.
        active_pairs: ARRAY u32, capacity.margin_pairs, "active pairs";
        /// Points in any order.
        staged: ARRAY ContactPoint, capacity.staged_points, "staged contact points";
        /// The range of points of each pair, and of each body and plane.
        slots: ARRAY ContactPair, capacity.slots, "contact slots";
        /// Position of each slot's pair in the result.
        pair_places: ARRAY u32, capacity.slots, "places of contact pairs";
        /// Position of each slot's points in the result.
        point_places: ARRAY u32, capacity.slots, "places of contact points";
        /// Scratch memory of the scans.
        slot_sums: ARRAY u32, capacity.slots.div_ceil(scan::BLOCK) + 1, "contact scan sums";
        /// Result: touching pairs.
        contact_pairs: ARRAY ContactPair, capacity.pairs, "contact pairs";
        /// Result: their points.
        contact_points: ARRAY ContactPoint, capacity.points, "contact points";
    }
}

buffers! {
    /// The buffers for one batch of pairs. Nothing of them is needed once its pairs have their points.
    ContactScratch(ContactCapacity), |capacity| {
        /// Relative poses of pairs.
        pair_setups: ARRAY PairSetup, capacity.batch_pairs(), "setups of pairs";
        /// Pairs of triangles that are near each other.
        near_triangles: ARRAY [u32; 4], capacity.near_triangles, "near triangles";
        /// Pieces of pairs of large meshes, for both searches.
        near_pieces: ARRAY NearPiece, capacity.pieces, "pieces of pairs with margins";
        /// Features of a batch.
        features: ARRAY Feature, capacity.features, "contact features";
        /// Segments in which triangles cross.
        segments: ARRAY Segment, capacity.segments, "contour segments";
        /// Links between segments: eight words per segment.
        contour_links: ARRAY u32, 8 * u64::from(capacity.segments), "contour links";
        /// The patches of a pair start at the index of its first segment.
        patches: ARRAY Patch, capacity.segments, "contour patches";
    }
}
