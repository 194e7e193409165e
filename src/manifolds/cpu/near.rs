//! Pairs of triangles that are near each other, of pairs of clusters that are.

use super::eight::{GapPair, Narrowing, SmallPair, eight_of, set_gaps};
use super::feature_bits::{CORNER_BITS, EDGE_BITS, owned_features};
use super::near_box_pairs::NearBoxPairs;
use super::near_clusters::NearClusters;
use super::near_lanes::NearLanes;
use super::placed_cluster::{ClusterTransform, PlacedCluster};
use super::search::{Limits, Search};
use super::side::{Side, Triangle};
use super::small_triangle::{EightTriangles, SmallTriangle};
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{Simd, bits, each_lane, push_some, set_lanes};
use crate::simd::level::with_simd;
use crate::simd::rounding::PAD;
use std::ops::Range;

/// Pairs of triangles that are near each other, and memory kept between pairs of bodies.
#[derive(Default)]
pub struct NearTriangles {
    /// The near clusters of the first body.
    firsts: Vec<[SmallTriangle; CLUSTER]>,
    /// Clusters of the second body, each with a lane of a cluster of the first that may be near: eight times the index
    /// of the cluster plus the lane.
    rows: Vec<u32>,
    box_pairs: NearBoxPairs,
    pairs: Vec<SmallPair>,
    /// Triangles that may have features between nearest points.
    nearest: Vec<GapPair>,
    narrowing: Narrowing,
    /// Indices in other lists, or [`NOT_LISTED`].
    listed: [Vec<u32>; 2],
    /// The triangles of `pairs`.
    numbers: [Vec<u32>; 2],
    /// The triangles of `numbers` in double precision.
    placed: [Vec<Triangle>; 2],
}

/// In place of an index: the triangle is not in the list.
pub const NOT_LISTED: u32 = u32::MAX;

impl NearTriangles {
    /// Finds all pairs of triangles that may cross, or have a feature, after a motion within the slack, and some
    /// others. The first triangles are those of a range of the first body's near clusters. `size` is the sum of the
    /// bounding radii.
    pub fn run(&mut self, sides: &[Side; 2], size: f32, search: &Search, clusters: &NearClusters, range: Range<usize>) {
        with_simd!(simd => self.run_with(simd, sides, size, search, clusters, range));
    }

    #[inline(always)]
    fn run_with<S: Simd>(
        &mut self,
        simd: S,
        sides: &[Side; 2],
        size: f32,
        search: &Search,
        clusters: &NearClusters,
        range: Range<usize>,
    ) {
        let Self {
            firsts,
            rows,
            box_pairs,
            pairs,
            nearest,
            narrowing,
            listed,
            numbers,
            ..
        } = self;
        firsts.clear();
        box_pairs.clear();
        pairs.clear();
        nearest.clear();
        let mut limits = Limits::new(search, size);
        // The normals of two-sided triangles may turn round.
        let one_sided = sides.iter().all(|side| side.features.one_sided.all());
        if !one_sided {
            (limits.lowest, limits.highest) = (-limits.reach, limits.reach);
        }
        let transform = ClusterTransform::new(simd, sides, 0);
        let mut a = PlacedCluster::default();
        let (seconds, triangles_b) = (clusters.seconds(), clusters.triangles());
        for (cluster, others) in clusters.pairs(range) {
            let mut triangles = [SmallTriangle::default(); CLUSTER];
            a.place(&mut triangles, &sides[0], &transform, cluster, search, limits.pad);
            if a.lanes == 0 {
                continue;
            }
            let first = (CLUSTER * firsts.len()) as u32;
            firsts.push(triangles);
            // First the triangles that may be near any of a cluster, in a loop without branches, too.
            rows.clear();
            for &other in others {
                let near = a.near_lanes(simd, &seconds[other as usize], &limits);
                let (second, lanes) = (CLUSTER as u32 * other, set_lanes(near));
                push_some(rows, each_lane(|k| second + u32::from(lanes[k])), near);
            }
            for &row in &*rows {
                let (other, i) = (row as usize / CLUSTER, row as usize % CLUSTER);
                let near = a.near_boxes(simd, i, &seconds[other], &limits);
                box_pairs.add(first + i as u32, (CLUSTER * other) as u32, near);
                box_pairs.take_if_full(
                    #[inline(always)]
                    |full| add_near(simd, [firsts, triangles_b], full, search, &limits, pairs, nearest),
                );
            }
        }
        let triangles = [&firsts[..], triangles_b];
        add_near(simd, triangles, box_pairs.all(), search, &limits, pairs, nearest);
        let triangles = triangles.map(<[_]>::as_flattened);
        narrowing.run(simd, triangles, pairs, one_sided, &limits);
        // The pairs get the indices of their triangles in the lists of remaining triangles.
        for (side, triangles) in triangles.into_iter().enumerate() {
            let (listed, numbers) = (&mut listed[side], &mut numbers[side]);
            listed.clear();
            listed.resize(triangles.len(), NOT_LISTED);
            numbers.clear();
            for pair in pairs.iter_mut() {
                let lane = pair.triangles[side] as usize;
                if listed[lane] == NOT_LISTED {
                    listed[lane] = numbers.len() as u32;
                    numbers.push(triangles[lane].number);
                }
                pair.triangles[side] = listed[lane];
            }
        }
    }

    /// Calls `found` for each pair that [`NearTriangles::run`] found, in order, with both triangles. It also gets, for
    /// both, an index that it may set; it is [`NOT_LISTED`] at first.
    #[inline(always)]
    pub fn for_each_pair(
        &mut self,
        sides: &[Side; 2],
        mut found: impl FnMut([&Triangle; 2], SmallPair, [&mut u32; 2]),
    ) {
        for ((placed, listed), (numbers, side)) in self
            .placed
            .iter_mut()
            .zip(&mut self.listed)
            .zip(self.numbers.iter().zip(sides))
        {
            placed.clear();
            for &number in numbers {
                placed.push(side.triangle(number));
            }
            listed.clear();
            listed.resize(numbers.len(), NOT_LISTED);
        }
        let ([firsts, seconds], [listed_a, listed_b]) = (&self.placed, &mut self.listed);
        for &pair in &self.pairs {
            let [i, j] = pair.triangles;
            let (i, j) = (i as usize, j as usize);
            found([&firsts[i], &seconds[j]], pair, [&mut listed_a[i], &mut listed_b[j]]);
        }
    }

    /// Calls `found` for each pair of triangles no farther apart than `most` that may have features between nearest
    /// points, by their numbers. `clusters` and `size` are those of [`NearTriangles::run`].
    pub fn for_each_nearest(&mut self, size: f32, clusters: &NearClusters, most: f64, mut found: impl FnMut(GapPair)) {
        let Self { firsts, nearest, .. } = self;
        let triangles = [&firsts[..], clusters.triangles()].map(<[_]>::as_flattened);
        let (most, pad) = (most as f32 * (1.0 + f32::EPSILON), PAD * size);
        let owns = |pair: &GapPair| {
            (0..2).any(|i| triangles[i][pair.triangles[i] as usize].owned & (CORNER_BITS | EDGE_BITS) != 0)
        };
        nearest.retain(|pair| pair.gap - pad <= most && owns(pair));
        with_simd!(simd => set_gaps(simd, triangles, nearest, pad));
        for pair in nearest.iter().filter(|pair| pair.gap <= most) {
            let [i, j] = pair.triangles.map(|i| i as usize);
            found(GapPair {
                triangles: [triangles[0][i].number, triangles[1][j].number],
                gap: pair.gap,
            });
        }
    }

    /// The triangles of both bodies in double precision, by their indices in pairs, once
    /// [`NearTriangles::for_each_pair`] has placed them.
    pub fn placed(&self) -> [&[Triangle]; 2] {
        self.placed.each_ref().map(Vec::as_slice)
    }
}

/// Adds those pairs of triangles that may have what is searched for.
#[inline(always)]
fn add_near<S: Simd>(
    simd: S,
    triangles: [&[[SmallTriangle; CLUSTER]]; 2],
    box_pairs: &[[u32; 2]],
    search: &Search,
    limits: &Limits,
    pairs: &mut Vec<SmallPair>,
    nearest: &mut Vec<GapPair>,
) {
    let [firsts, seconds] = triangles.map(<[_]>::as_flattened);
    let (groups, rest) = box_pairs.as_chunks();
    let last = (!rest.is_empty()).then(|| eight_of(rest).map(|pair| *pair));
    for (number, eight) in groups.iter().chain(&last).enumerate() {
        let a = EightTriangles::gather(simd, each_lane(|lane| &firsts[eight[lane][0] as usize]));
        let b = EightTriangles::gather(simd, each_lane(|lane| &seconds[eight[lane][1] as usize]));
        let near = NearLanes::of([&a, &b], search.crossings, limits);
        let count = CLUSTER.min(box_pairs.len() - CLUSTER * number);
        let used = (1u32 << count) - 1;
        let (nearest_lanes, nearest_set) = (set_lanes(near.nearest & used), near.nearest & used);
        let pair = each_lane(|k| {
            let lane = usize::from(nearest_lanes[k]);
            GapPair {
                triangles: eight[lane],
                gap: near.gaps[lane],
            }
        });
        push_some(nearest, pair, nearest_set);
        let features = near.features();
        let found = (near.crossing | features) & used;
        // Written without branches, which processors would mispredict. What has no part is dropped later.
        let (before, lanes) = (pairs.len(), set_lanes(found));
        let pair = each_lane(|k| {
            let lane = usize::from(lanes[k]);
            let [i, j] = eight[lane];
            SmallPair {
                triangles: [i, j],
                feature_bits: near.crossing_bit(lane),
                gap: 0.0,
            }
        });
        push_some(pairs, pair, found);
        for lane in bits(features & used) {
            let [i, j] = eight[lane].map(|at| at as usize);
            let owned = owned_features([firsts[i].owned, seconds[j].owned]);
            let earlier = found & ((1 << lane) - 1);
            pairs[before + earlier.count_ones() as usize].feature_bits |= near.feature_bits(lane) & owned;
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::candidates::Candidates;
    use super::super::crossing::Crossings;
    use super::super::feature::{Feature, TrianglePair};
    use super::super::pair::{Pair, ROUNDING};
    use super::super::pair_of_bodies;
    use super::super::search::{SearchRegion, Slack, Window};
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::{TriMesh, shapes};
    use crate::simd::level::baseline;
    use crate::state::{Bodies, Body};
    use crate::testing::scenes::any_vector;
    use glam::{DVec3, Quat, Vec3};

    /// The middles of features, in a certain order.
    type Middles = Vec<DVec3>;

    /// All triangles of both bodies.
    fn every_triangle(sides: &[Side; 2]) -> [Vec<Triangle>; 2] {
        let count = |side: &Side| side.features.triangles.len() as u32;
        [0, 1].map(|i| (0..count(&sides[i])).map(|t| sides[i].triangle(t)).collect())
    }

    /// The features of all pairs of triangles.
    fn every_feature(sides: &[Side; 2], reach: f64) -> Middles {
        let all = every_triangle(sides);
        let mut every = Vec::new();
        for a in &all[0] {
            for b in &all[1] {
                if let Some(pair) = TrianglePair::new(sides, [a, b], reach) {
                    pair.features(&(-reach..=reach), pair.owned_features(), |feature| {
                        every.push(feature.middle())
                    });
                }
            }
        }
        sorted(every)
    }

    /// The features that a search finds, and the features of its candidates. Without slack there are no candidates.
    fn found_features(pair: &Pair, reach: f64, slack: Slack) -> [Middles; 2] {
        let sides = &pair.sides;
        let mut clusters = NearClusters::default();
        let (mut near, mut candidates) = (NearTriangles::default(), Candidates::default());
        let search = Search {
            range: -reach..=reach,
            reach,
            slack,
            crossings: true,
            window: None,
        };
        clusters.run(sides, &pair.pose, &search);
        near.run(sides, pair.pose.size, &search, &clusters, 0..usize::MAX);
        let (mut found, mut kept) = (Vec::new(), Vec::new());
        candidates.select(
            &mut near,
            sides,
            &search,
            &mut Crossings::default(),
            |pair, feature_bits| {
                pair.features(&search.range, feature_bits, |feature| found.push(feature.middle()));
            },
        );
        let (mut placed, mut crossings) = Default::default();
        candidates.for_each(sides, &mut placed, 0, reach, &mut crossings, |pair, feature_bits| {
            pair.features(&search.range, feature_bits, |feature| kept.push(feature.middle()));
        });
        [sorted(found), sorted(kept)]
    }

    fn sorted(mut found: Middles) -> Middles {
        found.sort_by(|p, q| p.to_array().partial_cmp(&q.to_array()).unwrap());
        found
    }

    /// Bodies of several shapes, in random poses near each other, some scaled or mirrored.
    pub fn random_pairs(rounds: usize, mut each: impl FnMut(usize, &Pair)) {
        let open = shapes::torus(12, 10, 0.7, 0.3);
        let open = TriMesh::new(open.vertices().to_vec(), open.triangles()[..200].to_vec()).unwrap();
        let shapes = [
            shapes::ball(0.5, 2),
            shapes::cube(0.8),
            shapes::torus_240(),
            open,
            shapes::ball(0.5, 2).flipped(),
        ];
        let mut meshes = crate::state::mesh_arena::MeshArena::default();
        let slots = shapes.map(|shape| meshes.add(CollisionMesh::new(&shape)));
        let mut random = fastrand::Rng::with_seed(3);
        let mut number = || 2.0 * random.f32() - 1.0;
        for round in 0..rounds {
            let mut bodies = Bodies::default();
            for i in 0..2 {
                let at = Vec3::new(number(), number(), number()) * 0.9;
                let turn = Quat::from_xyzw(number(), number(), number(), number() + 0.01);
                let scale = match round % 4 {
                    0 => Vec3::new(1.0, 0.6, 1.3),
                    1 => Vec3::new(-1.0, 1.0, 1.0),
                    _ => Vec3::ONE,
                };
                let body = Body::at_rest(slots[(round + i * (1 + round / 5)) % 5], at, turn, scale);
                bodies.push(&body, &meshes).unwrap();
            }
            each(round, &pair_of_bodies(&bodies, &meshes, [0, 1]).unwrap());
        }
    }

    #[test]
    fn no_feature_is_lost_however_wide_the_margin() {
        let (mut found, mut pairs) = (0, 0);
        random_pairs(120, |round, pair| {
            let sides = &pair.sides;
            let every = every_feature(sides, 0.4);
            let some = Slack {
                distance: 0.01,
                rotation: 0.01,
            };
            for (slack, keeps) in [(Slack::default(), false), (some, true)] {
                let [now, kept] = found_features(pair, 0.4, slack);
                assert_eq!(every, now, "round {round}");
                assert!(kept == if keeps { now } else { Vec::new() }, "round {round}");
            }
            found += every.len();
            pairs += sides[0].features.triangles.len() * sides[1].features.triangles.len();
        });
        assert!(found > 200, "{found} features of {pairs} pairs");
    }

    /// The pairs of triangles that cross, among those that may.
    fn crossing(pair: &Pair, may_cross: &Crossings, triangles: [&[Triangle]; 2]) -> Vec<[u32; 2]> {
        let (mut segments, rounding) = (Vec::new(), ROUNDING * f64::from(pair.pose.size));
        may_cross.segments(baseline(), &pair.sides, triangles, rounding, &mut segments);
        let mut pairs: Vec<[u32; 2]> = segments.iter().map(|segment| segment.triangles).collect();
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn no_crossing_is_lost() {
        let mut crossings = 0;
        random_pairs(400, |round, pair| {
            let all = every_triangle(&pair.sides);
            let mut every = Crossings::default();
            for i in 0..all[0].len() as u32 {
                (0..all[1].len() as u32).for_each(|j| every.push([i, j]));
            }
            let every = crossing(pair, &every, all.each_ref().map(Vec::as_slice));
            for reach in [0.0, 0.05] {
                let search = Search {
                    range: -reach..=reach,
                    reach,
                    slack: Slack::default(),
                    crossings: true,
                    window: None,
                };
                let mut clusters = NearClusters::default();
                let (mut near, mut candidates) = (NearTriangles::default(), Candidates::default());
                clusters.run(&pair.sides, &pair.pose, &search);
                near.run(&pair.sides, pair.pose.size, &search, &clusters, 0..usize::MAX);
                let mut found = Crossings::default();
                candidates.select(&mut near, &pair.sides, &search, &mut found, |_, _| ());
                assert_eq!(every, crossing(pair, &found, near.placed()), "round {round}");
            }
            crossings += every.len();
        });
        assert!(crossings > 5000, "{crossings}");
    }

    /// The features of a search.
    fn searched(pair: &Pair, search: &Search) -> Vec<Feature> {
        let mut clusters = NearClusters::default();
        let (mut near, mut candidates) = (NearTriangles::default(), Candidates::default());
        clusters.run(&pair.sides, &pair.pose, search);
        near.run(&pair.sides, pair.pose.size, search, &clusters, 0..usize::MAX);
        let mut found = Vec::new();
        candidates.select(
            &mut near,
            &pair.sides,
            search,
            &mut Crossings::default(),
            |pair, feature_bits| {
                pair.features(&search.range, feature_bits, |feature| found.push(feature));
            },
        );
        found
    }

    #[test]
    fn a_window_loses_no_feature_near_its_regions_with_their_normals() {
        const REACH: f64 = 0.3;
        const AGREEMENT: f64 = 0.7;
        let mut random = fastrand::Rng::with_seed(5);
        let (mut wanted, mut left_out) = (0, 0);
        random_pairs(1500, |round, pair| {
            let mut search = Search {
                range: -REACH..=-1.0e-6,
                reach: REACH,
                slack: Slack::default(),
                crossings: false,
                window: None,
            };
            let all = searched(pair, &search);
            if all.is_empty() {
                return;
            }
            let regions: Vec<SearchRegion> = (0..random.usize(1..7))
                .map(|_| {
                    let one = &all[random.usize(..all.len())];
                    let aside = any_vector(&mut || random.f32());
                    SearchRegion {
                        center: one.middle().as_vec3() + 0.1 * aside,
                        radius: 0.15 + 0.3 * random.f32(),
                        normal: (one.normal.as_vec3() + 0.5 * aside).normalize(),
                    }
                })
                .collect();
            let window = Window::new(regions.iter().copied(), AGREEMENT);
            let one_sided = pair.sides.iter().all(|side| side.features.one_sided.all());
            search.window = Some(if one_sided { window } else { window.without_normals() });
            let found: Vec<String> = searched(pair, &search).iter().map(|f| format!("{f:?}")).collect();
            let is_wanted = |feature: &&Feature| {
                regions.iter().any(|region| {
                    let radius = f64::from(region.radius) - 0.5 * REACH;
                    feature.middle().distance(region.center.as_dvec3()) < radius
                        && feature.normal.dot(region.normal.as_dvec3()) > AGREEMENT
                })
            };
            for feature in all.iter().filter(is_wanted) {
                assert!(found.contains(&format!("{feature:?}")), "round {round}: {feature:?}");
                wanted += 1;
            }
            left_out += all.len() - found.len();
        });
        assert!(wanted > 100 && left_out > 100, "{wanted} wanted, {left_out} left out");
    }
}
