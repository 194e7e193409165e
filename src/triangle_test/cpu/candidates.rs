//! Candidates: pairs of triangles whose boxes overlap and which cross each other's planes.

use super::cull;
use super::interval_test::{TriangleLanes, beside, decide, decide_by};
use super::pair_setup::PairSetup;
use super::placed::{Candidate, PairScale, PlacedCluster, PlacedClusters, gather};
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::simd::descent::Descent;
use crate::simd::lanes::{
    Points, Simd, bitmask, bits, boxes_meet, each_lane, f32x8, heights, lane_of, load, load_points, splat, splat_point,
};
use crate::state::mesh_arena::{StoredPoints, points};
use glam::{DVec3, Vec3};

/// Memory kept between pairs.
#[derive(Default)]
pub struct Scratch {
    nodes: Vec<u32>,
    clusters: Vec<u32>,
    a: PlacedClusters,
    b: PlacedClusters,
    boxes: Vec<[StoredPoints; 2]>,
    descent: Descent,
    /// Index in `b` of each second cluster of the traversal.
    places: Vec<u32>,
    /// The result.
    candidates: Vec<Candidate>,
}

/// Minimum number of cluster pairs from which traversing both trees is faster than culling each body's clusters on
/// their own.
const MIN_DESCENT_PAIRS: usize = 20_000;

impl Scratch {
    /// Finds the candidates. Returns the number of triangle pairs whose boxes overlap.
    #[inline(always)]
    pub fn find<S: Simd>(&mut self, setup: &PairSetup<S>) -> u64 {
        self.candidates.clear();
        self.a.clear();
        self.b.clear();
        if setup.a.lanes.clusters.len() * setup.b.lanes.clusters.len() < MIN_DESCENT_PAIRS {
            self.all(setup)
        } else {
            self.descend(setup)
        }
    }

    /// Small meshes: culls the clusters of each body and compares all survivors.
    #[inline(always)]
    fn all<S: Simd>(&mut self, setup: &PairSetup<S>) -> u64 {
        let Self {
            nodes, clusters, a, b, ..
        } = self;
        let (simd, axis) = (setup.simd, setup.near.axis);
        let unit = setup.pair_scale.unit;
        cull::clusters(simd, setup.a.lanes, setup.a.scale, &setup.a_from_b(), nodes, clusters);
        let min_height = unit * (setup.near.b_above - setup.pad);
        let mut around_a = Aabb::EMPTY;
        for &cluster in clusters.iter() {
            let lanes = setup.a.filter.lanes(cluster);
            if lanes == 0 {
                continue;
            }
            let placed = a.push();
            setup.place_a(placed, cluster, lanes);
            placed.keep_beyond(simd, axis, min_height);
            if placed.lanes != 0 {
                around_a = around_a.union(placed.around());
            } else {
                a.pop();
            }
        }
        if a.is_empty() {
            return 0;
        }

        cull::clusters(simd, setup.b.lanes, setup.b.scale, &setup.b_from_a(), nodes, clusters);
        let max_height = unit * (setup.near.a_below + setup.pad);
        let mut around_b = Aabb::EMPTY;
        for &cluster in clusters.iter() {
            let lanes = setup.b.filter.lanes(cluster);
            if lanes == 0 {
                continue;
            }
            let placed = b.push();
            setup.place_b(placed, cluster, lanes);
            placed.keep_beyond(simd, -axis, -max_height);
            placed.keep_inside(simd, around_a);
            if placed.lanes != 0 {
                around_b = around_b.union(placed.around());
            } else {
                b.pop();
            }
        }
        for placed in a.iter_mut() {
            placed.keep_inside(simd, around_b);
        }
        self.product(simd, &setup.pair_scale)
    }

    /// Large meshes: traverses both trees down to pairs of clusters that may touch.
    #[inline(always)]
    fn descend<S: Simd>(&mut self, setup: &PairSetup<S>) -> u64 {
        let [tree_a, tree_b] = setup.trees();
        self.descent.run(&tree_a, &tree_b);
        let mut tests = 0;
        self.places.clear();
        for cluster in self.descent.second() {
            self.places.push(self.b.len() as u32);
            setup.place_b(self.b.push(), cluster, setup.b.filter.lanes(cluster));
        }
        for (cluster, others) in self.descent.pairs() {
            let lanes = setup.a.filter.lanes(cluster);
            if lanes == 0 {
                continue;
            }
            let index = self.a.len();
            let placed = self.a.push();
            setup.place_a(placed, cluster, lanes);
            for &other in others {
                let at = self.places[other as usize] as usize;
                tests += cluster_pair(
                    setup.simd,
                    [index, at],
                    [placed, &self.b[at]],
                    &setup.pair_scale,
                    &mut self.candidates,
                );
            }
        }
        tests
    }

    /// Compares all clusters of `a` with all of `b`: boxes of clusters, boxes of triangles, planes.
    #[inline(always)]
    fn product<S: Simd>(&mut self, simd: S, pair_scale: &PairScale) -> u64 {
        self.boxes.clear();
        for run in self.b.chunks(CLUSTER) {
            let mut lanes = [Aabb::EMPTY; CLUSTER];
            for (lane, placed) in lanes.iter_mut().zip(run) {
                *lane = placed.around();
            }
            self.boxes.push([points(|i| lanes[i].min), points(|i| lanes[i].max)]);
        }
        let mut tests = 0;
        for (i, a) in self.a.iter().enumerate() {
            let around = a.around();
            let (low, high) = (splat_point(simd, around.min), splat_point(simd, around.max));
            for (run, [min, max]) in self.boxes.iter().enumerate() {
                let meet = boxes_meet(low, high, load_points(simd, min), load_points(simd, max));
                for lane in bits(bitmask(meet)) {
                    let j = run * CLUSTER + lane;
                    tests += cluster_pair(simd, [i, j], [a, &self.b[j]], pair_scale, &mut self.candidates);
                }
            }
        }
        tests
    }
}

/// Whether triangles of two clusters certainly intersect; if not, the undecided pairs are added to `unsure`.
#[inline(always)]
pub fn any_triangles_hit<S: Simd>(
    simd: S,
    [a, b]: [&PlacedCluster; 2],
    pair_scale: &PairScale,
    unsure: &mut Vec<[u32; 2]>,
) -> bool {
    let (offset, error) = pair_scale.between(a, b);
    let mut tests = ClusterTests::new(simd, [a, b], offset, error);
    while let Some(crossing) = tests.next() {
        let (i, left) = (crossing.lane, crossing.left);
        // Tests eight lanes even if few remain: gathering candidates first costs more, and these may be enough.
        let one = TriangleLanes {
            corners: crossing.corners,
            normal: splat_point(simd, lane_of(&a.normal, i)),
            tolerance: splat(simd, error * a.height_error.0[i]),
            error: splat(simd, error),
        };
        let all = TriangleLanes {
            corners: tests.corners(),
            normal: load_points(simd, &b.normal),
            tolerance: splat(simd, error) * load(simd, &b.height_error),
            error: splat(simd, error),
        };
        let verdicts = decide_by([&one, &all], &crossing.heights[0], &crossing.heights[1]);
        if verdicts.hit & left != 0 {
            return true;
        }
        unsure.extend(bits(verdicts.unsure & left).map(|j| [a.first + i as u32, b.first + j as u32]));
    }
    false
}

#[inline(always)]
fn cluster_pair<S: Simd>(
    simd: S,
    indices: [usize; 2],
    [a, b]: [&PlacedCluster; 2],
    pair_scale: &PairScale,
    candidates: &mut Vec<Candidate>,
) -> u64 {
    let (offset, error) = pair_scale.between(a, b);
    let mut tests = ClusterTests::new(simd, [a, b], offset, error);
    while let Some(Crossing { lane: i, left, .. }) = tests.next() {
        for j in bits(left) {
            candidates.push(Candidate {
                lanes: [(indices[0] * CLUSTER + i) as u32, (indices[1] * CLUSTER + j) as u32],
                offset,
                error,
            });
        }
    }
    tests.count
}

/// Finds the triangles of a cluster that may intersect some of another.
struct ClusterTests<'a, S: Simd> {
    simd: S,
    a: &'a PlacedCluster,
    b: &'a PlacedCluster,
    /// Offset and error bound from [`PairScale::between`].
    offset: Vec3,
    error: f32,
    /// Lanes of `a` that are left to test.
    lanes: u32,
    /// Number of tested triangle pairs whose boxes overlap.
    count: u64,
}

/// A triangle of the first cluster that may intersect some of the second.
struct Crossing<S: Simd> {
    lane: usize,
    /// Lanes of the second cluster.
    left: u32,
    /// The triangle's corners in the second cluster's coordinates.
    corners: [Points<S>; 3],
    /// Heights of each triangle's corners over the other's plane.
    heights: [[f32x8<S>; 3]; 2],
}

impl<'a, S: Simd> ClusterTests<'a, S> {
    #[inline(always)]
    fn new(simd: S, [a, b]: [&'a PlacedCluster; 2], offset: Vec3, error: f32) -> Self {
        let (low, high) = (b.aabb.min + offset, b.aabb.max + offset);
        let meet = boxes_meet(
            load_points(simd, &a.min),
            load_points(simd, &a.max),
            splat_point(simd, low),
            splat_point(simd, high),
        );
        Self {
            simd,
            a,
            b,
            offset,
            error,
            lanes: bitmask(meet) & a.lanes,
            count: 0,
        }
    }

    /// The corners of the second cluster's triangles.
    #[inline(always)]
    fn corners(&self) -> [Points<S>; 3] {
        let [p, q, r] = &self.b.corners;
        [
            load_points(self.simd, p),
            load_points(self.simd, q),
            load_points(self.simd, r),
        ]
    }

    #[inline(always)]
    fn next(&mut self) -> Option<Crossing<S>> {
        let Self {
            simd,
            a,
            b,
            offset,
            error,
            ..
        } = *self;
        while self.lanes != 0 {
            let i = self.lanes.trailing_zeros() as usize;
            self.lanes &= self.lanes - 1;
            let (low, high) = (lane_of(&a.min, i) - offset, lane_of(&a.max, i) - offset);
            let meet = boxes_meet(
                load_points(simd, &b.min),
                load_points(simd, &b.max),
                splat_point(simd, low),
                splat_point(simd, high),
            );
            let overlapping = bitmask(meet) & b.lanes;
            if overlapping == 0 {
                continue;
            }
            self.count += overlapping.count_ones() as u64;
            let corner = |k: usize| lane_of(&a.corners[k], i) - offset;
            let corners = [
                splat_point(simd, corner(0)),
                splat_point(simd, corner(1)),
                splat_point(simd, corner(2)),
            ];
            let others = self.corners();
            let heights_b = heights(&others, corners[0], splat_point(simd, lane_of(&a.normal, i)));
            let left = overlapping & !beside(&heights_b, splat(simd, error * a.height_error.0[i]));
            if left == 0 {
                continue;
            }
            let heights_a = heights(&corners, others[0], load_points(simd, &b.normal));
            let left = left & !beside(&heights_a, splat(simd, error) * load(simd, &b.height_error));
            if left != 0 {
                return Some(Crossing {
                    lane: i,
                    left,
                    corners,
                    heights: [heights_a, heights_b],
                });
            }
        }
        None
    }
}

/// The decision about a candidate.
pub struct Decision {
    /// Triangles of the first and the second mesh.
    pub triangles: [u32; 2],
    /// The common segment in the first body's axes about its centre of mass, metres; `None` if single precision cannot
    /// decide.
    pub segment: Option<[DVec3; 2]>,
}

impl Scratch {
    /// Decides the candidates in order, and reports candidates that intersect or are undecided.
    #[inline(always)]
    pub fn decide<S: Simd>(&self, simd: S, pair_scale: &PairScale, mut report: impl FnMut(Decision)) {
        let metres = 1.0 / f64::from(pair_scale.unit);
        for run in self.candidates.chunks(CLUSTER) {
            // Unused lanes repeat the last candidate.
            let pairs: [Candidate; CLUSTER] = each_lane(|lane| run[lane.min(run.len() - 1)]);
            let verdicts = decide(&gather(simd, &self.a, &self.b, &pairs));
            let wanted = (1u32 << run.len()) - 1;
            for lane in bits((verdicts.hit | verdicts.unsure) & wanted) {
                let [a, b] = [0, 1].map(|end| pairs[lane].lanes[end] as usize);
                let (in_a, in_b) = (&self.a[a / CLUSTER], &self.b[b / CLUSTER]);
                let segment = (verdicts.hit >> lane & 1 == 1).then(|| verdicts.segment(lane));
                report(Decision {
                    triangles: [in_a.first + (a % CLUSTER) as u32, in_b.first + (b % CLUSTER) as u32],
                    segment: segment.map(|ends| ends.map(|p| (in_a.origin + p.as_dvec3()) * metres)),
                });
            }
        }
    }
}
