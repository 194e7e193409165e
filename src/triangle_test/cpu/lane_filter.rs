//! View culling: the lanes of each cluster that a [`View`] leaves in the test.

use crate::asset::BakedMesh;
use crate::simd::lanes::{Points, Simd, SimdBase, bitmask, dot, splat, splat_point};
use crate::state::View;
use glam::Vec3;

/// A [`View`], prepared for tests cluster by cluster.
pub enum LaneFilter<'a> {
    All,
    /// Lane masks, a byte per cluster.
    Masks(&'a [u8]),
    Facing(Vec3),
}

impl<'a> LaneFilter<'a> {
    /// Prepares a view. `scratch` may be overwritten.
    pub fn new(view: View, mesh: &'a BakedMesh, scratch: &'a mut Vec<u8>) -> Self {
        match (view, &mesh.faces) {
            (View::Group(id), Some(table)) => Self::Masks(table.distinct(id).lane_masks(scratch)),
            (View::Facing(direction), _) => Self::Facing(direction),
            (View::All | View::Group(_), _) => Self::All,
        }
    }

    /// Lanes of a cluster that may be in view, before the cluster is placed.
    #[inline(always)]
    pub fn lanes(&self, cluster: u32) -> u32 {
        match self {
            Self::All | Self::Facing(_) => 0xff,
            Self::Masks(masks) => masks[cluster as usize].into(),
        }
    }

    /// Lanes of a placed cluster that are in view, by its normals; `None` if all are.
    #[inline(always)]
    pub fn facing<S: Simd>(&self, simd: S, normals: Points<S>) -> Option<u32> {
        match self {
            Self::Facing(direction) => {
                let along = dot(normals, splat_point(simd, *direction));
                Some(bitmask(along.simd_gt(splat(simd, 0.0))))
            }
            Self::All | Self::Masks(_) => None,
        }
    }
}
