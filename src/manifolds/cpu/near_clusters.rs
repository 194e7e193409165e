//! Pairs of clusters that are near each other, by a traversal of both bounding-volume trees.

use super::placed_cluster::{ClusterTransform, PlacedCluster};
use super::search::{Limits, Search};
use super::side::Side;
use super::small_triangle::SmallTriangle;
use crate::geometry::cluster::CLUSTER;
use crate::simd::descent::Descent;
use crate::simd::lanes::Simd;
use crate::simd::level::with_simd;
use crate::simd::rounding::unit_of;
use crate::simd::tree::{RelativePose, Tree};
use arrayvec::ArrayVec;
use glam::{Mat3, Vec3};
use std::ops::Range;

/// Slabs are tested only for meshes of more clusters than this: the nodes of coarser ones are too round for slabs to
/// pay off.
const MAX_COARSE_CLUSTERS: usize = 300;

/// The relative pose of a pair in single precision.
pub struct PairPose {
    /// Rotation from the second body's axes to the first's.
    pub rotation: Mat3,
    /// From the first body's centre of mass to the second's, in the first's axes, metres.
    pub translation: Vec3,
    /// Sum of the bounding radii, metres.
    pub size: f32,
}

/// Pairs of clusters that are near each other, and memory kept between pairs of bodies.
#[derive(Default)]
pub struct NearClusters {
    descent: Descent,
    /// Clusters of the second body, in the order of the traversal, and then some of earlier pairs.
    seconds: Vec<PlacedCluster>,
    /// The triangles of these clusters.
    triangles: Vec<[SmallTriangle; CLUSTER]>,
    /// Number of clusters of the second body.
    second_count: usize,
    /// Number of pairs of clusters.
    count: usize,
}

impl NearClusters {
    /// Finds all pairs of clusters that may hold a pair of triangles to search for, and some others.
    pub fn run(&mut self, sides: &[Side; 2], pose: &PairPose, search: &Search) {
        with_simd!(simd => self.run_with(simd, sides, pose, search));
    }

    #[inline(always)]
    fn run_with<S: Simd>(&mut self, simd: S, sides: &[Side; 2], pose: &PairPose, search: &Search) {
        let limits = Limits::new(search, pose.size);
        let mut within = ArrayVec::new();
        if let Some(window) = &search.window {
            within = window.boxes(limits.pad, unit_of(pose.size));
        }
        let [tree_a, tree_b] = trees(simd, sides, pose, limits.reach);
        self.descent.run(&tree_a.within(&within), &tree_b.within(&within));
        let transform = ClusterTransform::new(simd, sides, 1);
        self.second_count = self.descent.second().count();
        if self.seconds.len() < self.second_count {
            self.seconds.resize_with(self.second_count, PlacedCluster::default);
            self.triangles.resize(self.second_count, Default::default());
        }
        let places = self.seconds.iter_mut().zip(&mut self.triangles);
        for ((placed, triangles), cluster) in places.zip(self.descent.second()) {
            placed.place(triangles, &sides[1], &transform, cluster, search, limits.pad);
            placed.fit(simd);
        }
        self.count = self.descent.pairs().map(|(_, others)| others.len()).sum();
    }

    /// The near clusters of the first body in a range, each with those of the second that are near it, by their indices
    /// in [`NearClusters::seconds`].
    pub fn pairs(&self, range: Range<usize>) -> impl Iterator<Item = (u32, &[u32])> {
        self.descent.pairs().skip(range.start).take(range.len())
    }

    /// The near clusters of the second body.
    pub fn seconds(&self) -> &[PlacedCluster] {
        &self.seconds[..self.second_count]
    }

    /// The triangles of the second body's clusters.
    pub fn triangles(&self) -> &[[SmallTriangle; CLUSTER]] {
        &self.triangles[..self.second_count]
    }

    /// Number of pairs of clusters.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Splits the clusters of the first body into `shares` consecutive ranges with about equally many pairs each.
    pub fn split(&self, shares: usize, mut share: impl FnMut(Range<usize>)) {
        let (mut first, mut passed, mut done) = (0, 0, 0);
        for (end, (_, others)) in (1..).zip(self.descent.pairs()) {
            passed += others.len();
            if passed * shares >= self.count * (done + 1) {
                share(first..end);
                (first, done) = (end, done + 1);
            }
        }
    }
}

/// Both trees. Nodes that are no farther apart than `reach` count as touching.
#[inline(always)]
fn trees<'a, S: Simd>(simd: S, sides: &[Side<'a>; 2], pose: &PairPose, reach: f32) -> [Tree<'a, S>; 2] {
    let unit = unit_of(pose.size);
    let clusters = sides.each_ref().map(|side| side.mesh.lanes().clusters.len());
    let slabs = clusters[0].max(clusters[1]) > MAX_COARSE_CLUSTERS;
    let back = pose.rotation.transpose();
    let relative = |rotation: Mat3, translation: Vec3| RelativePose {
        rotation,
        translation: unit * translation,
        // No support axis is used here.
        axis: Vec3::ZERO,
        min_height: f32::NEG_INFINITY,
    };
    let (a, b) = (
        relative(back, -(back * pose.translation)),
        relative(pose.rotation, pose.translation),
    );
    let lanes = sides.each_ref().map(|side| side.mesh.lanes());
    let scales = sides.each_ref().map(|side| unit * side.scale);
    let pad = unit * reach;
    [
        Tree::new(simd, lanes[0], false, scales[0], a, pad, slabs),
        Tree::new(simd, lanes[1], true, scales[1], b, pad, slabs),
    ]
}
