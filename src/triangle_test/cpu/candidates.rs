//! Candidates: pairs of triangles whose boxes overlap and which cross each other's planes.

use super::cull;
use super::interval_test::{Eight, beside, decide, decide_by, heights};
use super::pair_setup::PairSetup;
use super::placed::{Candidate, PairScale, PlacedCluster, PlacedClusters, gather};
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::simd::descent::Descent;
use crate::simd::lanes::{bits, boxes_meet, each, lane_of, splat};
use crate::state::mesh_arena::{Points, points};
use glam::{DVec3, Vec3};
use wide::f32x8;

/// Memory kept between pairs.
#[derive(Default)]
pub struct Scratch {
    nodes: Vec<u32>,
    clusters: Vec<u32>,
    a: PlacedClusters,
    b: PlacedClusters,
    boxes: Vec<[Points; 2]>,
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
    pub fn find(&mut self, setup: &PairSetup) -> u64 {
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
    fn all(&mut self, setup: &PairSetup) -> u64 {
        let Self {
            nodes, clusters, a, b, ..
        } = self;
        let axis = setup.near.axis;
        let unit = setup.pair_scale.unit;
        cull::clusters(setup.a.lanes, setup.a.scale, &setup.a_from_b(), nodes, clusters);
        let min_height = unit * (setup.near.b_above - setup.pad);
        let mut around_a = Aabb::EMPTY;
        for &cluster in clusters.iter() {
            let lanes = setup.a.filter.lanes(cluster);
            if lanes == 0 {
                continue;
            }
            let placed = a.push();
            setup.place_a(placed, cluster, lanes);
            placed.keep_beyond(axis, min_height);
            if placed.lanes != 0 {
                around_a = around_a.union(placed.around());
            } else {
                a.pop();
            }
        }
        if a.is_empty() {
            return 0;
        }

        cull::clusters(setup.b.lanes, setup.b.scale, &setup.b_from_a(), nodes, clusters);
        let max_height = unit * (setup.near.a_below + setup.pad);
        let mut around_b = Aabb::EMPTY;
        for &cluster in clusters.iter() {
            let lanes = setup.b.filter.lanes(cluster);
            if lanes == 0 {
                continue;
            }
            let placed = b.push();
            setup.place_b(placed, cluster, lanes);
            placed.keep_beyond(-axis, -max_height);
            placed.keep_inside(around_a);
            if placed.lanes != 0 {
                around_b = around_b.union(placed.around());
            } else {
                b.pop();
            }
        }
        for placed in a.iter_mut() {
            placed.keep_inside(around_b);
        }
        self.product(&setup.pair_scale)
    }

    /// Large meshes: traverses both trees down to pairs of clusters that may touch.
    fn descend(&mut self, setup: &PairSetup) -> u64 {
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
                tests += cluster_pair(index, placed, at, &self.b[at], &setup.pair_scale, &mut self.candidates);
            }
        }
        tests
    }

    /// Compares all clusters of `a` with all of `b`: boxes of clusters, boxes of triangles, planes.
    fn product(&mut self, pair_scale: &PairScale) -> u64 {
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
            let (low, high) = (splat(around.min), splat(around.max));
            for (run, [min, max]) in self.boxes.iter().enumerate() {
                for lane in bits(boxes_meet(low, high, *min, *max).to_bitmask()) {
                    let j = run * CLUSTER + lane;
                    tests += cluster_pair(i, a, j, &self.b[j], pair_scale, &mut self.candidates);
                }
            }
        }
        tests
    }
}

/// Whether triangles of two clusters certainly intersect; if not, the undecided pairs are added to `unsure`.
pub fn any_triangles_hit(
    a: &PlacedCluster,
    b: &PlacedCluster,
    pair_scale: &PairScale,
    unsure: &mut Vec<[u32; 2]>,
) -> bool {
    let (offset, error) = pair_scale.between(a, b);
    let mut hit = false;
    for_each_triangle(a, b, offset, error, |i, left, [heights_a, heights_b]| {
        // Tests eight lanes even if few remain: gathering candidates first costs more, and these may be enough.
        let error_lanes = f32x8::splat(error);
        let one = Eight {
            corners: each(|k| splat(lane_of(&a.corners[k], i) - offset)),
            normal: splat(lane_of(&a.normal, i)),
            tolerance: f32x8::splat(error * a.height_error.as_array()[i]),
            error: error_lanes,
        };
        let all = Eight {
            corners: b.corners,
            normal: b.normal,
            tolerance: error_lanes * b.height_error,
            error: error_lanes,
        };
        let verdicts = decide_by([&one, &all], heights_a, heights_b);
        hit = verdicts.hit & left != 0;
        if !hit {
            unsure.extend(bits(verdicts.unsure & left).map(|j| [a.first + i as u32, b.first + j as u32]));
        }
        !hit
    });
    hit
}

#[inline]
fn cluster_pair(
    index_a: usize,
    a: &PlacedCluster,
    index_b: usize,
    b: &PlacedCluster,
    pair_scale: &PairScale,
    candidates: &mut Vec<Candidate>,
) -> u64 {
    let (offset, error) = pair_scale.between(a, b);
    for_each_triangle(a, b, offset, error, |i, left, _| {
        for j in bits(left) {
            candidates.push(Candidate {
                lanes: [index_a * CLUSTER + i, index_b * CLUSTER + j].map(|at| at as u32),
                offset,
                error,
            });
        }
        true
    })
}

/// Calls `found` for each triangle of `a` that may intersect some of `b`, with the lanes of these and the heights of
/// each triangle's corners over the other's plane, until it returns false. Returns the number of triangle pairs whose
/// boxes overlap. `offset` and `error` are those of [`PairScale::between`].
#[inline(always)]
fn for_each_triangle(
    a: &PlacedCluster,
    b: &PlacedCluster,
    offset: Vec3,
    error: f32,
    mut found: impl FnMut(usize, u32, [&[f32x8; 3]; 2]) -> bool,
) -> u64 {
    let meet = boxes_meet(a.min, a.max, splat(b.aabb.min + offset), splat(b.aabb.max + offset));
    let mut tests = 0;
    for i in bits(meet.to_bitmask() & a.lanes) {
        let (low, high) = (lane_of(&a.min, i) - offset, lane_of(&a.max, i) - offset);
        let meet = boxes_meet(b.min, b.max, splat(low), splat(high));
        let overlapping = meet.to_bitmask() & b.lanes;
        if overlapping == 0 {
            continue;
        }
        tests += overlapping.count_ones() as u64;
        let corners = each(|k| splat(lane_of(&a.corners[k], i) - offset));
        let heights_b = heights(&b.corners, corners[0], splat(lane_of(&a.normal, i)));
        let left = overlapping & !beside(&heights_b, f32x8::splat(error * a.height_error.as_array()[i]));
        if left == 0 {
            continue;
        }
        let heights_a = heights(&corners, b.corners[0], b.normal);
        let left = left & !beside(&heights_a, f32x8::splat(error) * b.height_error);
        if left != 0 && !found(i, left, [&heights_a, &heights_b]) {
            break;
        }
    }
    tests
}

/// The decision about a candidate.
pub struct Decided {
    /// Triangles of the first and the second mesh.
    pub triangles: [u32; 2],
    /// The common segment in the first body's axes about its centre of mass, metres; `None` if single precision cannot
    /// decide.
    pub segment: Option<[DVec3; 2]>,
}

impl Scratch {
    /// Decides the candidates in order, and reports those that intersect or are undecided.
    pub fn decide(&self, pair_scale: &PairScale, mut report: impl FnMut(Decided)) {
        let metres = 1.0 / f64::from(pair_scale.unit);
        for run in self.candidates.chunks(CLUSTER) {
            // Unused lanes repeat the last candidate.
            let pairs: [Candidate; CLUSTER] = std::array::from_fn(|lane| run[lane.min(run.len() - 1)]);
            let verdicts = decide(&gather(&self.a, &self.b, &pairs));
            let wanted = (1u32 << run.len()) - 1;
            for lane in bits((verdicts.hit | verdicts.unsure) & wanted) {
                let [a, b] = [0, 1].map(|end| pairs[lane].lanes[end] as usize);
                let (in_a, in_b) = (&self.a[a / CLUSTER], &self.b[b / CLUSTER]);
                let segment = (verdicts.hit >> lane & 1 == 1).then(|| verdicts.segment(lane));
                report(Decided {
                    triangles: [in_a.first + (a % CLUSTER) as u32, in_b.first + (b % CLUSTER) as u32],
                    segment: segment.map(|ends| ends.map(|p| (in_a.origin + p.as_dvec3()) * metres)),
                });
            }
        }
    }
}
