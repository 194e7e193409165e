//! Placed clusters: triangles in the axes of a pair's first body, in the pair's own unit of length.
//!
//! Corners are relative to a corner of their cluster, whose position is known in double precision. Rounding errors are
//! therefore small compared with the cluster, however large the bodies are, and single precision can decide about small
//! triangles too.

use super::interval_test::Eight;
use super::lane_filter::LaneFilter;
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{Rows, bits, boxes_meet, cross, dot, each, lane_of, max, min, norm1, splat, sub};
use crate::state::mesh_arena::{Cluster, MeshLanes, Points, points};
use glam::{DVec3, Mat3, Vec3};
use std::ops::{Deref, DerefMut};
use wide::f32x8;

/// A list of placed clusters that keeps its memory. Clusters are placed at their final address: they are large, and
/// moving them costs as much as placing them.
#[derive(Default)]
pub struct PlacedClusters {
    /// The first `len` are in use.
    slots: Vec<PlacedCluster>,
    len: usize,
}

impl PlacedClusters {
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends a cluster with unspecified content.
    #[inline(always)]
    pub fn push(&mut self) -> &mut PlacedCluster {
        if self.len == self.slots.len() {
            self.slots.push(PlacedCluster::default());
        }
        self.len += 1;
        &mut self.slots[self.len - 1]
    }

    /// Removes the last.
    #[inline(always)]
    pub fn pop(&mut self) {
        self.len -= 1;
    }
}

impl Deref for PlacedClusters {
    type Target = [PlacedCluster];
    #[inline(always)]
    fn deref(&self) -> &[PlacedCluster] {
        &self.slots[..self.len]
    }
}

impl DerefMut for PlacedClusters {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [PlacedCluster] {
        &mut self.slots[..self.len]
    }
}

/// Eight placed triangles.
#[derive(Default)]
pub struct PlacedCluster {
    /// Index of the triangle in lane 0.
    pub first: u32,
    /// Origin of corners and boxes, relative to the first body's centre of mass.
    pub origin: DVec3,
    /// The origin in single precision.
    pub at: Vec3,
    pub corners: [Points; 3],
    pub min: Points,
    pub max: Points,
    pub normal: Points,
    /// Error of a height over the triangle's plane, times the normal's length, per error of a coordinate.
    pub height_error: f32x8,
    /// Lanes that remain in the test.
    pub lanes: u32,
    /// Bounding box of those lanes.
    pub aabb: Aabb,
    /// Largest absolute coordinate of all corners.
    pub extent: f32,
}

/// Relative error of a coordinate, in units of the extents of two clusters that meet: a handful of roundings of
/// `2^-24`.
const ERROR: f32 = 2.0e-6;

/// Unit of length and error bounds of a pair.
pub struct PairScale {
    /// Units per metre: a power of two near the inverse of the pair's size. Products of five lengths occur; in this
    /// unit none overflows or underflows, whatever the size of the bodies.
    pub unit: f32,
    /// Sum of the longest triangle sides of both meshes.
    pub longest_sides: f32,
    /// Rounding allowance of boxes.
    pub pad: f32,
    /// Error bound of an origin.
    pub origin_error: f32,
}

impl PairScale {
    /// Offset from the coordinates of `a` to those of `b`, and the error bound of a coordinate if their boxes meet.
    #[inline]
    pub fn between(&self, a: &PlacedCluster, b: &PlacedCluster) -> (Vec3, f32) {
        let offset = (b.origin - a.origin).as_vec3();
        (offset, ERROR * (a.extent + b.extent) + self.origin_error)
    }
}

/// Transforms the clusters of a mesh into the axes and unit of the pair.
pub struct ClusterTransform {
    matrix: Rows,
}

impl ClusterTransform {
    /// `matrix` maps the mesh's axes.
    pub fn new(matrix: Mat3) -> Self {
        Self {
            matrix: Rows::new(matrix),
        }
    }

    /// Places `lanes` of a cluster. `origin` is the placed position of its origin, metres.
    #[inline(always)]
    pub fn place(
        &self,
        placed: &mut PlacedCluster,
        mesh: &MeshLanes,
        cluster: u32,
        lanes: u32,
        origin: DVec3,
        pair_scale: &PairScale,
    ) {
        let Cluster {
            corners, lanes: all, ..
        } = &mesh.clusters[cluster as usize];
        let [p, q, r] = each(|k| self.matrix.times(corners[k]));
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        placed.first = cluster * CLUSTER as u32;
        placed.origin = origin * f64::from(pair_scale.unit);
        placed.at = placed.origin.as_vec3();
        placed.corners = [p, q, r];
        placed.normal = normal;
        // The height n . (x - p) errs by the errors of x and p along n, and by the error of n along x - p, which is at
        // most as long as both triangles together if their boxes overlap.
        placed.height_error =
            f32x8::splat(3.0) * (norm1(normal) + (norm1(u) + norm1(v)) * f32x8::splat(pair_scale.longest_sides));
        let pad = splat(Vec3::splat(0.5 * pair_scale.pad));
        let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
        placed.min = sub(low, pad);
        placed.max = each(|i| high[i] + pad[i]);
        placed.lanes = *all;
        placed.fit();
        placed.extent = placed.aabb.min.abs().max(placed.aabb.max.abs()).max_element();
        if lanes & all != *all {
            placed.lanes &= lanes;
            placed.fit();
        }
    }
}

impl PlacedCluster {
    #[inline]
    fn keep(&mut self, mask: f32x8) {
        let lanes = self.lanes & mask.to_bitmask();
        if lanes != self.lanes {
            self.lanes = lanes;
            self.fit();
        }
    }

    /// Keeps the lanes in view.
    #[inline]
    pub fn keep_visible(&mut self, filter: &LaneFilter) {
        if let Some(facing) = filter.facing(self.normal) {
            self.keep(facing);
        }
    }

    /// Keeps the lanes that extend to at least `min_height` along an axis.
    #[inline]
    pub fn keep_beyond(&mut self, axis: Vec3, min_height: f32) {
        let along = each(|k| dot(self.corners[k], splat(axis)));
        let min_height = f32x8::splat(min_height - self.at.dot(axis));
        self.keep(along[0].fast_max(along[1]).fast_max(along[2]).simd_ge(min_height));
    }

    /// Keeps the lanes that meet a box given relative to the first body's centre of mass.
    #[inline]
    pub fn keep_inside(&mut self, aabb: Aabb) {
        self.keep(boxes_meet(
            self.min,
            self.max,
            splat(aabb.min - self.at),
            splat(aabb.max - self.at),
        ));
    }

    /// The bounding box relative to the first body's centre of mass.
    #[inline]
    pub fn around(&self) -> Aabb {
        Aabb {
            min: self.aabb.min + self.at,
            max: self.aabb.max + self.at,
        }
    }

    fn fit(&mut self) {
        let mut around = Aabb::EMPTY;
        for lane in bits(self.lanes) {
            around = around.union(Aabb {
                min: lane_of(&self.min, lane),
                max: lane_of(&self.max, lane),
            });
        }
        self.aabb = around;
    }
}

/// A candidate: two triangles that may intersect.
#[derive(Clone, Copy)]
pub struct Candidate {
    /// Lanes of placed clusters: eight times the index of the cluster plus the lane.
    pub lanes: [u32; 2],
    /// [`PairScale::between`] for their clusters.
    pub offset: Vec3,
    pub error: f32,
}

/// Gathers eight candidates: the triangles of the first body, and those of the second in the coordinates of the first.
#[inline(always)]
pub fn gather(a: &[PlacedCluster], b: &[PlacedCluster], pairs: &[Candidate; CLUSTER]) -> [Eight; 2] {
    let error = f32x8::new(pairs.each_ref().map(|pair| pair.error));
    let offset = points(|lane| pairs[lane].offset);
    let mut of_b = eight(b, pairs, 1, error);
    of_b.corners = each(|k| each(|i| of_b.corners[k][i] + offset[i]));
    [eight(a, pairs, 0, error), of_b]
}

#[inline(always)]
fn eight(placed: &[PlacedCluster], pairs: &[Candidate; CLUSTER], end: usize, error: f32x8) -> Eight {
    let mut rows = [[0f32; CLUSTER]; 13];
    for (lane, pair) in pairs.iter().enumerate() {
        let at = pair.lanes[end] as usize;
        let (from, i) = (&placed[at / CLUSTER], at % CLUSTER);
        for axis in 0..3 {
            for k in 0..3 {
                rows[3 * k + axis][lane] = from.corners[k][axis].as_array()[i];
            }
            rows[9 + axis][lane] = from.normal[axis].as_array()[i];
        }
        rows[12][lane] = from.height_error.as_array()[i];
    }
    let at = |row: usize| each(|i| f32x8::new(rows[row + i]));
    Eight {
        corners: [at(0), at(3), at(6)],
        normal: at(9),
        tolerance: error * f32x8::new(rows[12]),
        error,
    }
}
