//! Placed clusters: triangles in the axes of a pair's first body, in the pair's own unit of length.
//!
//! Corners are relative to a corner of their cluster, whose position is known in double precision. Rounding errors are
//! therefore small compared with the cluster, however large the bodies are, and single precision can decide about small
//! triangles too.

use super::interval_test::TriangleLanes;
use super::lane_filter::LaneFilter;
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{
    Rows, Simd, SimdBase, add, bitmask, bits, boxes_meet, cross, dot, lane_of, largest, load, load_points, max, min,
    norm1, splat, splat_point, store, store_points, sub,
};
use crate::state::mesh_arena::{Cluster, MeshLanes, Stored, StoredPoints, points};
use glam::{DVec3, Mat3, Vec3};
use std::ops::{Deref, DerefMut};

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
    pub corners: [StoredPoints; 3],
    pub min: StoredPoints,
    pub max: StoredPoints,
    pub normal: StoredPoints,
    /// Error of a height over the triangle's plane, times the normal's length, per error of a coordinate.
    pub height_error: Stored,
    /// Lanes that remain in the test.
    pub lanes: u32,
    /// Bounding box of the `lanes`.
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
pub struct ClusterTransform<S: Simd> {
    simd: S,
    matrix: Rows<S>,
}

impl<S: Simd> ClusterTransform<S> {
    /// `matrix` maps the mesh's axes.
    #[inline(always)]
    pub fn new(simd: S, matrix: Mat3) -> Self {
        Self {
            simd,
            matrix: Rows::new(simd, matrix),
        }
    }

    /// The instruction set.
    #[inline(always)]
    pub fn simd(&self) -> S {
        self.simd
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
        let simd = self.simd;
        let p = self.matrix.times(load_points(simd, &corners[0]));
        let q = self.matrix.times(load_points(simd, &corners[1]));
        let r = self.matrix.times(load_points(simd, &corners[2]));
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        placed.first = cluster * CLUSTER as u32;
        placed.origin = origin * f64::from(pair_scale.unit);
        placed.at = placed.origin.as_vec3();
        placed.corners = [store_points(p), store_points(q), store_points(r)];
        placed.normal = store_points(normal);
        // The height n . (x - p) errs by the errors of x and p along n, and by the error of n along x - p, which is at
        // most as long as both triangles together if their boxes overlap.
        let spread = (norm1(u) + norm1(v)) * splat(simd, pair_scale.longest_sides);
        placed.height_error = store(splat(simd, 3.0) * (norm1(normal) + spread));
        let pad = splat_point(simd, Vec3::splat(0.5 * pair_scale.pad));
        let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
        placed.min = store_points(sub(low, pad));
        placed.max = store_points(add(high, pad));
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
    #[inline(always)]
    fn keep(&mut self, lanes: u32) {
        let lanes = self.lanes & lanes;
        if lanes != self.lanes {
            self.lanes = lanes;
            self.fit();
        }
    }

    /// Keeps the lanes in view.
    #[inline(always)]
    pub fn keep_visible<S: Simd>(&mut self, simd: S, filter: &LaneFilter) {
        if let Some(facing) = filter.facing(simd, load_points(simd, &self.normal)) {
            self.keep(facing);
        }
    }

    /// Keeps the lanes that extend to at least `min_height` along an axis.
    #[inline(always)]
    pub fn keep_beyond<S: Simd>(&mut self, simd: S, axis: Vec3, min_height: f32) {
        let along = splat_point(simd, axis);
        let [p, q, r] = &self.corners;
        let heights = [
            dot(load_points(simd, p), along),
            dot(load_points(simd, q), along),
            dot(load_points(simd, r), along),
        ];
        let min_height = splat(simd, min_height - self.at.dot(axis));
        self.keep(bitmask(largest(heights).simd_ge(min_height)));
    }

    /// Keeps the lanes that meet a box given relative to the first body's centre of mass.
    #[inline(always)]
    pub fn keep_inside<S: Simd>(&mut self, simd: S, aabb: Aabb) {
        let (min, max) = (load_points(simd, &self.min), load_points(simd, &self.max));
        let (low, high) = (aabb.min - self.at, aabb.max - self.at);
        self.keep(bitmask(boxes_meet(
            min,
            max,
            splat_point(simd, low),
            splat_point(simd, high),
        )));
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
pub fn gather<S: Simd>(
    simd: S,
    a: &[PlacedCluster],
    b: &[PlacedCluster],
    pairs: &[Candidate; CLUSTER],
) -> [TriangleLanes<S>; 2] {
    let offset = load_points(simd, &points(|lane| pairs[lane].offset));
    let mut of_b = eight(simd, b, pairs, 1);
    let [p, q, r] = of_b.corners;
    of_b.corners = [add(p, offset), add(q, offset), add(r, offset)];
    [eight(simd, a, pairs, 0), of_b]
}

#[inline(always)]
fn eight<S: Simd>(simd: S, placed: &[PlacedCluster], pairs: &[Candidate; CLUSTER], end: usize) -> TriangleLanes<S> {
    let mut error = Stored::default();
    let mut rows = [Stored::default(); 13];
    for (lane, pair) in pairs.iter().enumerate() {
        let at = pair.lanes[end] as usize;
        let (from, i) = (&placed[at / CLUSTER], at % CLUSTER);
        for axis in 0..3 {
            for k in 0..3 {
                rows[3 * k + axis].0[lane] = from.corners[k][axis].0[i];
            }
            rows[9 + axis].0[lane] = from.normal[axis].0[i];
        }
        rows[12].0[lane] = from.height_error.0[i];
        error.0[lane] = pair.error;
    }
    let [a, b, c, d, e, f, g, h, i, x, y, z, height_error] = rows;
    let error = load(simd, &error);
    TriangleLanes {
        corners: [
            load_points(simd, &[a, b, c]),
            load_points(simd, &[d, e, f]),
            load_points(simd, &[g, h, i]),
        ],
        normal: load_points(simd, &[x, y, z]),
        tolerance: error * load(simd, &height_error),
        error,
    }
}
