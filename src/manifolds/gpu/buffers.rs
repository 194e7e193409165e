//! The buffers of contact generation, and their capacity.

use crate::gpu::buffers::{buffers, grow};
use crate::gpu::layout::{
    CONTACT_COUNTERS, CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS, ContactLimits, ContactPair, ContactPoint,
    DEEP_PIECES, FEATURES, Feature, MarginPair, NEAR_PIECES, NEAR_TRIANGLES, NearPiece, PairSetup, Patch, SEGMENTS,
    STAGED_POINTS, Segment,
};
use crate::gpu::scan;

/// Capacity of the lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactCapacity {
    /// Pairs of bodies whose contact points are requested.
    pub margin_pairs: u32,
    /// The same, plus bodies times half-spaces.
    pub slots: u32,
    /// Pairs of triangles that are near each other.
    pub near_triangles: u32,
    /// Pieces of pairs of large meshes.
    pub pieces: u32,
    /// Features before the reduction.
    pub features: u32,
    /// Segments in which triangles cross.
    pub segments: u32,
    /// Points in any order.
    pub staged_points: u32,
    /// Pairs with points.
    pub pairs: u32,
    /// Points.
    pub points: u32,
}

impl ContactCapacity {
    /// At least `needed` of each, with some to spare where this capacity does not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            margin_pairs: grow(self.margin_pairs, needed.margin_pairs),
            slots: grow(self.slots, needed.slots),
            near_triangles: grow(self.near_triangles, needed.near_triangles),
            pieces: grow(self.pieces, needed.pieces),
            features: grow(self.features, needed.features),
            segments: grow(self.segments, needed.segments),
            staged_points: grow(self.staged_points, needed.staged_points),
            pairs: grow(self.pairs, needed.pairs),
            points: grow(self.points, needed.points),
        }
    }

    /// The larger of two, list by list.
    pub fn max(self, other: Self) -> Self {
        Self {
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

    /// The capacity that a run needed, by its counters.
    pub fn needed(counters: &[u32]) -> Self {
        let of = |counter: u32| counters[counter as usize];
        Self {
            margin_pairs: 0,
            slots: of(CONTACT_SLOTS),
            near_triangles: of(NEAR_TRIANGLES),
            pieces: of(NEAR_PIECES).saturating_add(of(DEEP_PIECES)),
            features: of(FEATURES),
            segments: of(SEGMENTS),
            staged_points: of(STAGED_POINTS),
            pairs: of(CONTACT_PAIRS),
            points: of(CONTACT_POINTS),
        }
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
    /// The buffers of contact generation. `shaders/shared/types.wgsl` explains their elements.
    ContactBuffers(ContactCapacity), |capacity| {
        /// Lengths of the lists.
        limits: UNIFORM ContactLimits, 1u32, "contact limits";
        /// The host writes the number of pairs, and zeroes the others.
        contact_counters: ARRAY u32, CONTACT_COUNTERS, "contact counters";
        /// Arguments of indirect dispatches.
        contact_arguments: INDIRECT u32, 16u32, "contact arguments";
        /// The same for pieces of pairs: three words for each of two searches.
        near_arguments: INDIRECT u32, 6u32, "contact arguments for pieces";
        /// Pairs of bodies, ascending.
        margin_pairs: ARRAY MarginPair, capacity.margin_pairs, "pairs with margins";
        /// Their relative poses.
        pair_setups: ARRAY PairSetup, capacity.margin_pairs, "setups of pairs";
        /// Pairs of triangles that are near each other.
        near_triangles: ARRAY [u32; 4], capacity.near_triangles, "near triangles";
        /// Pieces of pairs of large meshes, for both searches.
        near_pieces: ARRAY NearPiece, capacity.pieces, "pieces of pairs with margins";
        /// Their features.
        features: ARRAY Feature, capacity.features, "contact features";
        /// The segments in which they cross.
        segments: ARRAY Segment, capacity.segments, "contour segments";
        /// Links between segments: eight words per segment.
        contour_links: ARRAY u32, 8 * u64::from(capacity.segments), "contour links";
        /// The patches of a pair start at half the index of its first segment.
        patches: ARRAY Patch, capacity.segments / 2 + 1, "contour patches";
        /// Points in any order.
        staged: ARRAY ContactPoint, capacity.staged_points, "staged contact points";
        /// The range of points of each pair, and of each body and half-space.
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
