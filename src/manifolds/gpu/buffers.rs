//! Every buffer of contact generation, and how large it is.

use crate::gpu::buffers::{buffers, grow};
use crate::gpu::layout::{
    CONTACT_COUNTERS, CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS, ContactLimits, ContactPair, ContactPoint,
    PairSetup, FEATURES, Feature, MarginPair, NEAR_TRIANGLES, Patch, SEGMENTS, STAGED_POINTS, Segment,
};
use crate::gpu::scan;

/// How many of each thing fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactCapacity {
    /// Pairs of bodies that are looked at.
    pub margin_pairs: u32,
    /// Those, and bodies times half-spaces.
    pub slots: u32,
    /// Pairs of triangles near each other.
    pub near_triangles: u32,
    /// Features before most are left out.
    pub features: u32,
    /// Segments in which triangles cross.
    pub segments: u32,
    /// Points, before they are put in order.
    pub staged_points: u32,
    /// Pairs with points.
    pub pairs: u32,
    /// Points.
    pub points: u32,
}

impl ContactCapacity {
    /// At least `needed` of each, with room to spare where these sizes do not suffice.
    pub fn grown(self, needed: Self) -> Self {
        Self {
            margin_pairs: grow(self.margin_pairs, needed.margin_pairs),
            slots: grow(self.slots, needed.slots),
            near_triangles: grow(self.near_triangles, needed.near_triangles),
            features: grow(self.features, needed.features),
            segments: grow(self.segments, needed.segments),
            staged_points: grow(self.staged_points, needed.staged_points),
            pairs: grow(self.pairs, needed.pairs),
            points: grow(self.points, needed.points),
        }
    }

    /// What a run needed, by its counters.
    pub fn needed(counters: &[u32]) -> Self {
        let of = |counter: u32| counters[counter as usize];
        Self {
            margin_pairs: 0,
            slots: of(CONTACT_SLOTS),
            near_triangles: of(NEAR_TRIANGLES),
            features: of(FEATURES),
            segments: of(SEGMENTS),
            staged_points: of(STAGED_POINTS),
            pairs: of(CONTACT_PAIRS),
            points: of(CONTACT_POINTS),
        }
    }

    /// What the kernels are told of them.
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
        }
    }
}

buffers! {
    /// Every buffer of contact generation; `shaders/shared/types.wgsl` explains their elements.
    ContactBuffers(ContactCapacity), |capacity| {
        /// How long the lists are.
        limits: UNIFORM ContactLimits, 1u32, "contact limits";
        /// The host writes how many pairs there are, and zeroes the others.
        contact_counters: ARRAY u32, CONTACT_COUNTERS, "contact counters";
        /// Of indirect dispatches.
        contact_arguments: INDIRECT u32, 16u32, "contact arguments";
        /// Pairs of bodies that are looked at, ascending.
        margin_pairs: ARRAY MarginPair, capacity.margin_pairs, "pairs with margins";
        /// How they lie to each other.
        pair_setups: ARRAY PairSetup, capacity.margin_pairs, "setups of pairs";
        /// Pairs of triangles near each other.
        near_triangles: ARRAY [u32; 4], capacity.near_triangles, "near triangles";
        /// What they have to say.
        features: ARRAY Feature, capacity.features, "contact features";
        /// Where they cross.
        segments: ARRAY Segment, capacity.segments, "contour segments";
        /// How segments are joined: eight words each.
        contour_links: ARRAY u32, 8 * u64::from(capacity.segments), "contour links";
        /// Patches of a pair start where its segments do.
        patches: ARRAY Patch, capacity.segments, "contour patches";
        /// Points in any order.
        staged: ARRAY ContactPoint, capacity.staged_points, "staged contact points";
        /// Where each pair's, and each body's and half-space's, are among them.
        slots: ARRAY ContactPair, capacity.slots, "contact slots";
        /// Where each slot's pair goes.
        pair_places: ARRAY u32, capacity.slots, "places of contact pairs";
        /// Where each slot's points go.
        point_places: ARRAY u32, capacity.slots, "places of contact points";
        /// Scratch of the scans.
        slot_sums: ARRAY u32, capacity.slots.div_ceil(scan::BLOCK) + 1, "contact scan sums";
        /// Result.
        contact_pairs: ARRAY ContactPair, capacity.pairs, "contact pairs";
        /// Result.
        contact_points: ARRAY ContactPoint, capacity.points, "contact points";
    }
}
