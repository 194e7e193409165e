//! The input of a pair's test: both meshes, their relative pose, filters and error bounds, in the pair's own unit of
//! length.

use super::contact::PairFrame;
use super::cull::Other;
use super::lane_filter::LaneFilter;
use super::placed::{ClusterTransform, PairScale, PlacedCluster};
use crate::geometry::Aabb;
use crate::simd::rounding::{PAD, unit_of};
use crate::simd::tree::{RelativePose, Tree};
use crate::state::mesh_arena::{MeshArena, MeshLanes};
use crate::state::{Bodies, NearPair};
use glam::{DVec3, Mat3, Vec3};

/// Slabs are tested only for meshes of more clusters than this: the nodes of coarser ones are too round for slabs to
/// pay off.
const MAX_COARSE_CLUSTERS: usize = 300;

/// A pair to be tested.
pub struct PairSetup<'a> {
    pub a: Side<'a>,
    pub b: Side<'a>,
    /// Rounding allowance, metres.
    pub pad: f32,
    pub pair_scale: PairScale,
    pub near: &'a NearPair,
    pair_frame: &'a PairFrame,
    back: Mat3,
}

/// One body of a pair.
pub struct Side<'a> {
    pub lanes: &'a MeshLanes,
    pub filter: LaneFilter<'a>,
    pub scale: Vec3,
    pub radius: f32,
    transform: ClusterTransform,
}

impl<'a> PairSetup<'a> {
    /// Prepares a pair. `masks` may be overwritten.
    pub fn new(
        bodies: &Bodies,
        meshes: &'a MeshArena,
        near: &'a NearPair,
        pair_frame: &'a PairFrame,
        masks: &'a mut [Vec<u8>; 2],
    ) -> Self {
        let [masks_a, masks_b] = masks;
        let [ia, ib] = near.bodies.map(|i| i as usize);
        let size = bodies.radius[ia] + bodies.radius[ib];
        let (unit, pad) = (unit_of(size), PAD * size);
        let side = |i: usize, view, masks, rotation: Mat3| {
            let slot = &meshes[bodies.mesh[i]];
            let scale = bodies.scale[i];
            Side {
                lanes: &slot.lanes,
                filter: LaneFilter::new(view, &slot.mesh, masks),
                scale,
                radius: bodies.radius[i],
                transform: ClusterTransform::new(rotation * Mat3::from_diagonal(unit * scale)),
            }
        };
        let a = side(ia, near.views[0], masks_a, Mat3::IDENTITY);
        let b = side(ib, near.views[1], masks_b, near.rotation);
        let longest_side = |side: &Side| 3f32.sqrt() * side.lanes.longest_side * side.scale.abs().max_element();
        Self {
            pad,
            pair_scale: PairScale {
                unit,
                longest_sides: unit * (longest_side(&a) + longest_side(&b)),
                pad: unit * pad,
                origin_error: 2.0 * unit * pair_frame.placement_error as f32,
            },
            a,
            b,
            near,
            pair_frame,
            back: near.rotation.transpose(),
        }
    }

    /// Places `lanes` of a cluster of the first body, without those that are not in view.
    #[inline]
    pub fn place_a(&self, placed: &mut PlacedCluster, cluster: u32, lanes: u32) {
        let origin = self.pair_frame.place_a(self.a.lanes.clusters[cluster as usize].origin);
        self.a.place(placed, cluster, lanes, origin, &self.pair_scale);
    }

    /// Places `lanes` of a cluster of the second body, without those that are not in view.
    #[inline]
    pub fn place_b(&self, placed: &mut PlacedCluster, cluster: u32, lanes: u32) {
        let origin = self.pair_frame.place_b(self.b.lanes.clusters[cluster as usize].origin);
        self.b.place(placed, cluster, lanes, origin, &self.pair_scale);
    }

    /// Bounds of the second body for culling the first.
    pub fn a_from_b(&self) -> Other {
        Other {
            rotation: self.back,
            translation: -(self.back * self.near.translation),
            aabb: scaled(self.b.lanes.aabb, self.b.scale),
            center: self.near.translation,
            radius: self.b.radius,
            axis: self.near.axis,
            min_height: self.near.b_above,
            pad: self.pad,
        }
    }

    /// Bounds of the first body for culling the second.
    pub fn b_from_a(&self) -> Other {
        Other {
            rotation: self.near.rotation,
            translation: self.near.translation,
            aabb: scaled(self.a.lanes.aabb, self.a.scale),
            center: -(self.back * self.near.translation),
            radius: self.a.radius,
            axis: -(self.back * self.near.axis),
            min_height: self.near.translation.dot(self.near.axis) - self.near.a_below,
            pad: self.pad,
        }
    }

    /// The bounding-volume trees of both bodies.
    pub fn trees(&self) -> [Tree<'a>; 2] {
        let PairScale { unit, pad, .. } = self.pair_scale;
        let slabs = self.a.lanes.clusters.len().max(self.b.lanes.clusters.len()) > MAX_COARSE_CLUSTERS;
        let tree = |side: &Side<'a>, second, other: Other| {
            let relative = RelativePose {
                rotation: other.rotation,
                translation: unit * other.translation,
                axis: other.axis,
                min_height: unit * other.min_height,
            };
            Tree::new(side.lanes, second, unit * side.scale, relative, pad, slabs)
        };
        [
            tree(&self.a, false, self.a_from_b()),
            tree(&self.b, true, self.b_from_a()),
        ]
    }
}

impl Side<'_> {
    #[inline(always)]
    fn place(&self, placed: &mut PlacedCluster, cluster: u32, lanes: u32, origin: DVec3, pair_scale: &PairScale) {
        self.transform
            .place(placed, self.lanes, cluster, lanes, origin, pair_scale);
        placed.keep_visible(&self.filter);
    }
}

fn scaled(aabb: Aabb, scale: Vec3) -> Aabb {
    Aabb::around([aabb.min * scale, aabb.max * scale])
}
