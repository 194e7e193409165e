//! View culling: the lanes of each cluster that a [`View`] leaves in the test.

use crate::asset::BakedMesh;
use crate::simd::lanes::{dot, splat};
use crate::state::View;
use crate::state::mesh_arena::Points;
use wide::f32x8;

/// A [`View`], prepared for tests cluster by cluster.
pub enum LaneFilter<'a> {
    All,
    /// Lane masks, a byte per cluster.
    Masks(&'a [u8]),
    Facing(Points),
}

impl<'a> LaneFilter<'a> {
    /// Prepares a view. `scratch` may be overwritten.
    pub fn new(view: View, mesh: &'a BakedMesh, scratch: &'a mut Vec<u8>) -> Self {
        match (view, &mesh.faces) {
            (View::Group(id), Some(table)) => Self::Masks(table.distinct(id).lane_masks(scratch)),
            (View::Facing(direction), _) => Self::Facing(splat(direction)),
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
    pub fn facing(&self, normals: Points) -> Option<f32x8> {
        match self {
            Self::Facing(direction) => Some(dot(normals, *direction).simd_gt(f32x8::ZERO)),
            Self::All | Self::Masks(_) => None,
        }
    }
}
