//! Every buffer of contact generation, and how large it is.

use crate::gpu::buffers::{TooLarge, check, grow, make};
use crate::gpu::device::Gpu;
use crate::gpu::layout::{
    CONTACT_COUNTERS, CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS, ContactLimits, ContactPair, ContactPoint,
    ContactSetting, FEATURES, Feature, MarginPair, NEAR_TRIANGLES, Patch, SEGMENTS, STAGED_POINTS, Segment,
};
use crate::gpu::scan;
use wgpu::{Buffer, BufferUsages};

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

macro_rules! buffers {
    ($($(#[$doc:meta])* $name:ident: $what:literal, $element:ty, $usage:expr, |$sizes:ident| $count:expr;)*) => {
        /// Every buffer of contact generation; `shaders/shared/types.wgsl` explains their elements.
        #[derive(Debug)]
        pub struct ContactBuffers {
            /// What fits.
            pub sizes: ContactCapacity,
            $($(#[$doc])* pub $name: Buffer,)*
        }

        impl ContactBuffers {
            /// Makes all of them.
            ///
            /// # Errors
            /// If one is larger than the device allows; none is made then.
            pub fn new(gpu: &Gpu, sizes: ContactCapacity) -> Result<Self, TooLarge> {
                $(let $name = {
                    let $sizes = &sizes;
                    check(gpu, $what, u64::from($count) * size_of::<$element>() as u64)?
                };)*
                Ok(Self { sizes, $($name: make(gpu, $what, $name, $usage),)* })
            }

            /// Bytes of all of them.
            pub fn bytes(&self) -> u64 {
                [$(&self.$name),*].into_iter().map(Buffer::size).sum()
            }
        }
    };
}

const NONE: BufferUsages = BufferUsages::empty();

buffers! {
    /// Uniform.
    limits: "contact limits", ContactLimits, BufferUsages::UNIFORM, |_s| 1u32;
    /// The host writes how many pairs there are, and zeroes the others.
    counters: "contact counters", u32, NONE, |_s| CONTACT_COUNTERS;
    /// Of indirect dispatches.
    arguments: "contact arguments", u32, BufferUsages::INDIRECT, |_s| 16u32;
    /// Pairs of bodies that are looked at, ascending.
    margin_pairs: "pairs with margins", MarginPair, NONE, |s| s.margin_pairs;
    /// How they lie to each other.
    settings: "settings of pairs", ContactSetting, NONE, |s| s.margin_pairs;
    /// Pairs of triangles near each other.
    near_triangles: "near triangles", [u32; 4], NONE, |s| s.near_triangles;
    /// What they have to say.
    features: "contact features", Feature, NONE, |s| s.features;
    /// Where they cross.
    segments: "contour segments", Segment, NONE, |s| s.segments;
    /// How segments are joined.
    links: "contour links", [u32; 8], NONE, |s| s.segments;
    /// Patches of a pair start where its segments do.
    patches: "contour patches", Patch, NONE, |s| s.segments;
    /// Points in any order.
    staged: "staged contact points", ContactPoint, NONE, |s| s.staged_points;
    /// Where each pair's, and each body's and half-space's, are among them.
    slots: "contact slots", ContactPair, NONE, |s| s.slots;
    /// Where each slot's pair goes.
    pair_places: "places of contact pairs", u32, NONE, |s| s.slots;
    /// Where each slot's points go.
    point_places: "places of contact points", u32, NONE, |s| s.slots;
    /// Scratch of the scans.
    sums: "contact scan sums", u32, NONE, |s| s.slots.div_ceil(scan::BLOCK) + 1;
    /// Result.
    contact_pairs: "contact pairs", ContactPair, NONE, |s| s.pairs;
    /// Result.
    contact_points: "contact points", ContactPoint, NONE, |s| s.points;
}
