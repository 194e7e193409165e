//! Pairs of triangles that are near each other, by a traversal of both bounding-volume trees.

use super::candidates::{CROSSING, NOT_LISTED, owned_features};
use super::eight::{Narrowing, SmallPair, SmallTriangle};
use super::placed_cluster::{ClusterTransform, PlacedCluster};
use super::search::{Limits, Search};
use super::side::{Side, Triangle};
use crate::geometry::cluster::CLUSTER;
use crate::simd::descent::Descent;
use crate::simd::lanes::{Simd, bits};
use crate::simd::level::with_simd;
use crate::simd::rounding::unit_of;
use crate::simd::tree::{RelativePose, Tree};
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
        let [tree_a, tree_b] = trees(simd, sides, pose, limits.reach);
        self.descent.run(&tree_a, &tree_b);
        let transform = ClusterTransform::new(simd, sides, 1);
        self.second_count = self.descent.second().count();
        if self.seconds.len() < self.second_count {
            self.seconds.resize_with(self.second_count, PlacedCluster::default);
        }
        for (placed, cluster) in self.seconds.iter_mut().zip(self.descent.second()) {
            placed.place(&sides[1], &transform, cluster, search, limits.pad);
        }
        self.count = self.descent.pairs().map(|(_, others)| others.len()).sum();
    }

    /// Number of pairs of clusters.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Splits the clusters of the first body into so many consecutive ranges, with about equally many pairs each.
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

/// Pairs of triangles that are near each other, and memory kept between pairs of bodies.
#[derive(Default)]
pub struct NearTriangles {
    /// Triangles of the first and of the second body that are near a triangle of the other.
    triangles: [Vec<SmallTriangle>; 2],
    pairs: Vec<SmallPair>,
    narrowing: Narrowing,
    /// For each of the second body's near clusters, the indices of its triangles in `triangles`, or [`NOT_LISTED`].
    seconds_listed: Vec<[u32; CLUSTER]>,
    /// Each of `triangles` in double precision, once it is needed.
    placed: [Vec<Triangle>; 2],
    uses: [Vec<Use>; 2],
}

/// What a triangle of near pairs is used for.
#[derive(Clone, Copy)]
struct Use {
    is_placed: bool,
    /// Its index in another list.
    listed: u32,
}

impl NearTriangles {
    /// Finds all pairs of triangles that may cross, or have a feature, after a motion within the slack, and some others.
    /// The first triangles are those of a range of the first body's near clusters. `size` is the sum of the bounding
    /// radii.
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
            triangles,
            pairs,
            narrowing,
            seconds_listed,
            ..
        } = self;
        let [firsts, seconds] = triangles;
        firsts.clear();
        seconds.clear();
        pairs.clear();
        seconds_listed.clear();
        seconds_listed.resize(clusters.second_count, [NOT_LISTED; CLUSTER]);
        let mut limits = Limits::new(search, size);
        // The normals of two-sided triangles may turn round.
        let one_sided = sides.iter().all(|side| side.features.one_sided.all());
        if !one_sided {
            (limits.lowest, limits.highest) = (-limits.reach, limits.reach);
        }
        let crossing = if search.crossings { CROSSING } else { 0 };
        let transform = ClusterTransform::new(simd, sides, 0);
        let mut a = PlacedCluster::default();
        for (cluster, others) in clusters.descent.pairs().skip(range.start).take(range.len()) {
            a.place(&sides[0], &transform, cluster, search, limits.pad);
            if a.lanes == 0 {
                continue;
            }
            let mut firsts_listed = [NOT_LISTED; CLUSTER];
            for &other in others {
                let b = &clusters.seconds[other as usize];
                let listed = &mut seconds_listed[other as usize];
                // All boxes first: processors mispredict the branches of one triangle after the other.
                let (mut boxes, mut rows) = ([0; CLUSTER], 0);
                for i in bits(a.lanes & a.near_box(simd, b, limits.reach)) {
                    boxes[i] = a.near_boxes(simd, i, b, &limits);
                    rows |= u32::from(boxes[i] != 0) << i;
                }
                for i in bits(rows) {
                    let near = a.near(simd, i, b, boxes[i], &limits);
                    for j in bits(near.any()) {
                        let parts = near.parts(j) & (owned_features([a.owned[i], b.owned[j]]) | crossing);
                        if parts != 0 {
                            let first = index(&a, i, &mut firsts_listed[i], firsts);
                            pairs.push(SmallPair {
                                triangles: [first, index(b, j, &mut listed[j], seconds)],
                                parts,
                                gap: 0.0,
                            });
                        }
                    }
                }
            }
        }
        narrowing.run(simd, triangles, pairs, one_sided, &limits);
    }

    /// Calls `found` for each pair that [`NearTriangles::run`] found, in order, with both triangles. It also gets, for both,
    /// an index that it may set; it is [`NOT_LISTED`] at first.
    #[inline(always)]
    pub fn for_each_pair(
        &mut self,
        sides: &[Side; 2],
        mut found: impl FnMut([&Triangle; 2], SmallPair, [&mut u32; 2]),
    ) {
        for side in 0..2 {
            let count = self.triangles[side].len();
            let unused = Use {
                is_placed: false,
                listed: NOT_LISTED,
            };
            self.uses[side].clear();
            self.uses[side].resize(count, unused);
            // Triangles that are not needed keep what is there.
            self.placed[side].resize(count.max(self.placed[side].len()), Triangle::default());
        }
        let ([firsts, seconds], [uses_a, uses_b]) = (&mut self.placed, &mut self.uses);
        for &pair in &self.pairs {
            let [i, j] = pair.triangles;
            let (i, j) = (i as usize, j as usize);
            let (a, b) = (&mut uses_a[i], &mut uses_b[j]);
            if !a.is_placed {
                (firsts[i], a.is_placed) = (sides[0].triangle(self.triangles[0][i].number), true);
            }
            if !b.is_placed {
                (seconds[j], b.is_placed) = (sides[1].triangle(self.triangles[1][j].number), true);
            }
            found([&firsts[i], &seconds[j]], pair, [&mut a.listed, &mut b.listed]);
        }
    }

    /// The triangles of both bodies in double precision, by their indices in pairs. Only those of pairs that
    /// [`NearTriangles::for_each_pair`] passed are placed.
    pub fn placed(&self) -> [&[Triangle]; 2] {
        self.placed.each_ref().map(Vec::as_slice)
    }
}

/// The index of a cluster's triangle in a list, to which it is added if needed.
#[inline]
fn index(cluster: &PlacedCluster, lane: usize, listed: &mut u32, triangles: &mut Vec<SmallTriangle>) -> u32 {
    if *listed == NOT_LISTED {
        *listed = triangles.len() as u32;
        triangles.push(cluster.triangle(lane));
    }
    *listed
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

#[cfg(test)]
pub(super) mod tests {
    use super::super::candidates::Candidates;
    use super::super::crossing::Crossings;
    use super::super::feature::{Feature, TrianglePair};
    use super::super::pair::Pair;
    use super::super::pair_of_bodies;
    use super::super::search::{Place, Slack, Window};
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::{TriMesh, shapes};
    use crate::state::{Bodies, Body};
    use crate::testing::scenes::any_vector;
    use glam::{DVec3, Quat};

    /// The middles of features, in a certain order.
    type Middles = Vec<DVec3>;

    /// The features of all pairs of triangles.
    fn every_feature(sides: &[Side; 2], reach: f64) -> Middles {
        let count = |side: &Side| side.features.triangles.len() as u32;
        let all: [Vec<Triangle>; 2] = [0, 1].map(|i| (0..count(&sides[i])).map(|t| sides[i].triangle(t)).collect());
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

    /// The features that a search finds, and those of its candidates, which are none without slack.
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
        candidates.select(&mut near, sides, &search, &mut Crossings::default(), |pair, parts| {
            pair.features(&search.range, parts, |feature| found.push(feature.middle()));
        });
        let (mut placed, mut crossings) = Default::default();
        candidates.for_each(sides, &mut placed, 0, reach, &mut crossings, |pair, parts| {
            pair.features(&search.range, parts, |feature| kept.push(feature.middle()));
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
            |pair, parts| {
                pair.features(&search.range, parts, |feature| found.push(feature));
            },
        );
        found
    }

    #[test]
    fn a_window_loses_no_feature_near_its_places_with_their_normals() {
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
            let places: Vec<Place> = (0..random.usize(1..7))
                .map(|_| {
                    let one = &all[random.usize(..all.len())];
                    let aside = any_vector(&mut || random.f32());
                    Place {
                        center: one.middle().as_vec3() + 0.1 * aside,
                        radius: 0.15 + 0.3 * random.f32(),
                        normal: (one.normal.as_vec3() + 0.5 * aside).normalize(),
                    }
                })
                .collect();
            let window = Window::new(places.iter().copied(), AGREEMENT);
            let one_sided = pair.sides.iter().all(|side| side.features.one_sided.all());
            search.window = Some(if one_sided { window } else { window.without_normals() });
            let found: Vec<String> = searched(pair, &search).iter().map(|f| format!("{f:?}")).collect();
            let is_wanted = |feature: &&Feature| {
                places.iter().any(|place| {
                    let radius = f64::from(place.radius) - 0.5 * REACH;
                    feature.middle().distance(place.center.as_dvec3()) < radius
                        && feature.normal.dot(place.normal.as_dvec3()) > AGREEMENT
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
