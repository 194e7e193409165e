//! The input of a pair's test: both meshes, their relative pose, filters and error bounds, in the pair's own unit of
//! length.

use super::contact::PairFrame;
use super::cull::OtherBounds;
use super::lane_filter::LaneFilter;
use super::placed::{ClusterTransform, PairScale, PlacedCluster};
use crate::geometry::Aabb;
use crate::simd::lanes::Simd;
use crate::simd::rounding::{PAD, unit_of};
use crate::simd::tree::{RelativePose, Tree};
use crate::state::mesh_arena::MeshLanes;
use crate::state::{NearPair, PlacedMesh};
use glam::{DVec3, Mat3, Vec3};

/// Slabs are tested only for meshes of more clusters than this: the nodes of coarser ones are too round for slabs to
/// pay off.
const MAX_COARSE_CLUSTERS: usize = 300;

/// A pair to be tested.
pub struct PairSetup<'a, S: Simd> {
    pub simd: S,
    pub a: PairMesh<'a, S>,
    pub b: PairMesh<'a, S>,
    /// Rounding allowance, metres.
    pub pad: f32,
    pub pair_scale: PairScale,
    pub near: &'a NearPair,
    pair_frame: &'a PairFrame,
    back: Mat3,
}

/// The mesh of one body of a pair.
pub struct PairMesh<'a, S: Simd> {
    pub lanes: &'a MeshLanes,
    pub filter: LaneFilter<'a>,
    pub scale: Vec3,
    pub radius: f32,
    transform: ClusterTransform<S>,
}

impl<'a, S: Simd> PairSetup<'a, S> {
    /// Prepares a pair. `masks` may be overwritten.
    #[inline(always)]
    pub fn new(
        simd: S,
        [a, b]: [&PlacedMesh<'a>; 2],
        near: &'a NearPair,
        pair_frame: &'a PairFrame,
        masks: &'a mut [Vec<u8>; 2],
    ) -> Self {
        let [masks_a, masks_b] = masks;
        let size = a.radius + b.radius;
        let (unit, pad) = (unit_of(size), PAD * size);
        let (scale_a, scale_b) = (a.scale, b.scale);
        let a = PairMesh {
            lanes: a.mesh.lanes(),
            filter: LaneFilter::new(near.views[0], a.mesh, masks_a),
            scale: scale_a,
            radius: a.radius,
            transform: ClusterTransform::new(simd, Mat3::from_diagonal(unit * scale_a)),
        };
        let b = PairMesh {
            lanes: b.mesh.lanes(),
            filter: LaneFilter::new(near.views[1], b.mesh, masks_b),
            scale: scale_b,
            radius: b.radius,
            transform: ClusterTransform::new(simd, near.rotation * Mat3::from_diagonal(unit * scale_b)),
        };
        let longest_side = |mesh: &PairMesh<S>| 3f32.sqrt() * mesh.lanes.longest_side * mesh.scale.abs().max_element();
        Self {
            simd,
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

    /// Places the `lanes` of a cluster of the first body that are in view.
    #[inline(always)]
    pub fn place_a(&self, placed: &mut PlacedCluster, cluster: u32, lanes: u32) {
        let origin = self.pair_frame.place_a(self.a.lanes.clusters[cluster as usize].origin);
        self.a.place(placed, cluster, lanes, origin, &self.pair_scale);
    }

    /// Places the `lanes` of a cluster of the second body that are in view.
    #[inline(always)]
    pub fn place_b(&self, placed: &mut PlacedCluster, cluster: u32, lanes: u32) {
        let origin = self.pair_frame.place_b(self.b.lanes.clusters[cluster as usize].origin);
        self.b.place(placed, cluster, lanes, origin, &self.pair_scale);
    }

    /// Bounds of the second body for culling the first.
    pub fn a_from_b(&self) -> OtherBounds {
        OtherBounds {
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
    pub fn b_from_a(&self) -> OtherBounds {
        OtherBounds {
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
    #[inline(always)]
    pub fn trees(&self) -> [Tree<'a, S>; 2] {
        let PairScale { unit, pad, .. } = self.pair_scale;
        let slabs = self.a.lanes.clusters.len().max(self.b.lanes.clusters.len()) > MAX_COARSE_CLUSTERS;
        let relative = |other: OtherBounds| RelativePose {
            rotation: other.rotation,
            translation: unit * other.translation,
            axis: other.axis,
            min_height: unit * other.min_height,
        };
        let (a, b) = (relative(self.a_from_b()), relative(self.b_from_a()));
        [
            Tree::new(self.simd, self.a.lanes, false, unit * self.a.scale, a, pad, slabs),
            Tree::new(self.simd, self.b.lanes, true, unit * self.b.scale, b, pad, slabs),
        ]
    }
}

impl<S: Simd> PairMesh<'_, S> {
    #[inline(always)]
    fn place(&self, placed: &mut PlacedCluster, cluster: u32, lanes: u32, origin: DVec3, pair_scale: &PairScale) {
        self.transform
            .place(placed, self.lanes, cluster, lanes, origin, pair_scale);
        placed.keep_visible(self.transform.simd(), &self.filter);
    }
}

fn scaled(aabb: Aabb, scale: Vec3) -> Aabb {
    Aabb::around([aabb.min * scale, aabb.max * scale])
}
