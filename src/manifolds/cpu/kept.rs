//! What a pair keeps from one call to the next: its candidates, and the pose in which they were found.

use super::candidates::{Candidates, FRACTIONS};
use super::moved::CachedPoints;
use super::pair::Pair;
use super::resting::RestingFeatures;
use super::search::{FeatureQuery, Search, Slack, Window};
use crate::geometry::features::MeshFeatures;
use glam::{DMat3, DVec3, Vec3};
use std::sync::{Arc, Weak};

/// Rounding allowance of motions, in units of the bodies' size. Surfaces that do not cross are at least this far apart.
const ROUNDING: f64 = 1.0e-9;
/// Upper bound of the distance of surfaces that the triangle test cannot tell from intersecting ones, in units of the
/// sum of the bounding radii and of the distances of the meshes' origins.
const UNDECIDED: f64 = 1.0e-13;
/// Most candidates of each kind kept for a pair: 4 MiB. The flanks of a finely tessellated thread have so many.
const MAX_CANDIDATES: usize = 1 << 18;

/// A search has the slack that the bodies need for this many calls, at their motion since the last search.
const CALLS: f64 = 4.0;
/// After this many calls, bodies have probably come to rest. If they have moved since the search, a new search leaves
/// fewer candidates to test.
const CALLS_TO_REST: u32 = 32;
/// Least slack, in units of the bodies' size.
const LEAST_SLACK: f64 = 0.004;
/// Memory is returned after this many searches that have not used it.
const SEARCHES: u32 = 256;

/// What a pair keeps: it saves searches and changes no result. It is valid for any two bodies with the same meshes,
/// scales and relative pose.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    /// Candidates of features within the margin, and of crossings.
    pub near: KeptCandidates,
    /// Candidates of overlapping features.
    pub deep: KeptCandidates,
    /// Neither body contained the other in the pose in which `near` was found, and surfaces did not cross.
    pub was_apart: bool,
    /// The contact points, for the later collision substeps of the same step.
    pub points: CachedPoints,
    /// The features of the pair while it hardly moves.
    pub resting: RestingFeatures,
}

/// Candidates with the motion in which they are valid.
#[derive(Clone, Debug, Default)]
pub struct KeptCandidates {
    /// The candidates of each share of the pair.
    pub shares: Vec<Candidates>,
    found_at: Option<RelativePose>,
    slack: Slack,
    /// More slack gives very many candidates.
    slack_limit: Option<f64>,
    /// The margin of the search.
    margin: f64,
    /// Window of the search, without the slack.
    window: Option<Window>,
    /// Number of times that the candidates were used.
    uses: u32,
    /// The searches since memory was last returned.
    recent_searches: RecentSearches,
    /// Whether the last search was worth more than one thread.
    pub is_large: bool,
}

/// Where the candidates of a pair come from.
pub enum Source {
    /// A new search.
    Search(Search),
    /// What is kept. The bodies have moved by `motion`, metres, and at most by this one of [`FRACTIONS`] of the slack.
    Kept { fraction: usize, motion: f64 },
}

/// Searches of a pair.
#[derive(Clone, Copy, Debug, Default)]
struct RecentSearches {
    searches: u32,
    /// Most candidates of one of them.
    most: usize,
}

/// The pose of a pair's second body relative to the first.
#[derive(Clone, Debug)]
pub struct RelativePose {
    meshes: [Weak<MeshFeatures>; 2],
    scales: [Vec3; 2],
    /// Rotation and centre of mass of the second body in the first one's axes.
    rotation: DMat3,
    center: DVec3,
}

impl Kept {
    /// Resets this to the state of a new pair. Small allocations stay.
    pub fn forget(&mut self) {
        self.begin(None);
        for kept in [&mut self.near, &mut self.deep] {
            for share in &mut kept.shares {
                share.clear();
                share.shrink(0);
            }
            kept.recent_searches = RecentSearches::default();
        }
    }

    /// Resets this for a single call, for which slack would be wasted. The allocations stay.
    pub fn for_one_call(&mut self) -> &mut Self {
        self.begin(Some(0.0));
        self
    }

    /// Whether the pair is worth more than one thread.
    pub fn is_large(&self) -> bool {
        self.near.is_large || self.deep.is_large
    }

    /// Whether what is kept shows that no surfaces cross in this pose, and that neither body contains the other.
    pub fn is_apart(&self, pair: &Pair) -> bool {
        let near = &self.near;
        // The triangle test counts what it cannot decide as touching.
        let [a, b] = pair.sides.each_ref().map(|side| side.place(Vec3::ZERO).length());
        let undecided = UNDECIDED * (f64::from(pair.pose.size) + a + b);
        if undecided > ROUNDING * pair.size {
            return false;
        }
        let fraction = near.motion_to(pair).and_then(|motion| near.fraction_of(motion));
        self.was_apart && fraction.is_some_and(|fraction| !near.may_cross(fraction))
    }

    fn begin(&mut self, slack_limit: Option<f64>) {
        self.points.clear();
        self.resting.clear();
        for kept in [&mut self.near, &mut self.deep] {
            (kept.found_at, kept.slack_limit, kept.is_large) = (None, slack_limit, false);
        }
    }
}

impl RelativePose {
    /// The relative pose of a pair's bodies.
    pub fn of(pair: &Pair) -> Self {
        Self {
            meshes: pair.sides.each_ref().map(|side| Arc::downgrade(side.mesh.features())),
            scales: pair.sides.each_ref().map(|side| side.scale),
            rotation: pair.relative_rotation,
            center: pair.sides[1].center,
        }
    }

    /// Whether a pair has the same meshes and scales.
    pub fn is_of(&self, pair: &Pair) -> bool {
        (0..2).all(|i| {
            let side = &pair.sides[i];
            self.scales[i] == side.scale && std::ptr::eq(self.meshes[i].as_ptr(), Arc::as_ptr(side.mesh.features()))
        })
    }

    /// Upper bound of the motion since then of the points of one body near the other, relative to it, metres; `None` if
    /// these are other bodies. `reach` bounds how far near points are apart.
    pub fn motion_to(&self, pair: &Pair, reach: f64) -> Option<f64> {
        if !self.is_of(pair) {
            return None;
        }
        let (rotation, center) = (pair.relative_rotation, pair.sides[1].center);
        // The points near the smaller body move least in the axes of the larger one.
        let travel = if pair.radii[0] >= pair.radii[1] {
            center.distance(self.center)
        } else {
            (rotation.transpose() * center).distance(self.rotation.transpose() * self.center)
        };
        let turn = rotation - self.rotation;
        let squares = turn.x_axis.length_squared() + turn.y_axis.length_squared() + turn.z_axis.length_squared();
        // The largest stretch of the difference of two rotations is its Frobenius norm over the square root of 2.
        Some(travel + (0.5 * squares).sqrt() * arm(pair, reach) + ROUNDING * pair.size)
    }
}

/// Largest distance from the smaller body's centre of mass of a point near it.
fn arm(pair: &Pair, reach: f64) -> f64 {
    f64::from(pair.radii[0].min(pair.radii[1])) + reach
}

impl KeptCandidates {
    /// How to find the candidates for `query`. Those that a new search finds are then kept here.
    pub fn source(&mut self, pair: &Pair, query: &FeatureQuery) -> Source {
        let motion = self.motion_to(pair);
        if let Some(motion) = motion
            && let Some(fraction) = self.fraction(query, motion)
        {
            self.uses += 1;
            return Source::Kept { fraction, motion };
        }
        let distance = self.next_slack(pair, query.margin, motion);
        let slack = Slack {
            distance,
            rotation: distance / arm(pair, query.margin + distance),
        };
        // The patches change, too.
        let window = query.window.map(|window| window.grown(2.0 * distance, 0.0));
        self.found_at = Some(RelativePose::of(pair));
        (self.slack, self.margin, self.window, self.uses) = (slack, query.margin, window, 0);
        Source::Search(Search {
            range: query.range.clone(),
            reach: query.reach,
            slack,
            crossings: window.is_none(),
            window: window.map(|window| window.grown(distance, slack.rotation)),
        })
    }

    /// Index of the smallest of [`FRACTIONS`] of the slack with which all candidates for `query` are among these after
    /// this motion.
    fn fraction(&self, query: &FeatureQuery, motion: f64) -> Option<usize> {
        let is_covered = match (&query.window, &self.window) {
            (Some(now), Some(then)) => now.is_within(then),
            _ => true,
        };
        // A wider margin is like a motion.
        let needed = motion + (query.margin - self.margin).max(0.0);
        let fraction = self.fraction_of(needed).filter(|_| is_covered);
        fraction.filter(|&fraction| fraction == 0 || self.uses < CALLS_TO_REST)
    }

    /// Index of the smallest of [`FRACTIONS`] of the slack that covers a motion.
    fn fraction_of(&self, motion: f64) -> Option<usize> {
        FRACTIONS
            .iter()
            .position(|fraction| motion <= fraction * self.slack.distance)
    }

    /// Upper bound of the motion since the last search; `None` without one, and if it was of other bodies.
    fn motion_to(&self, pair: &Pair) -> Option<f64> {
        self.found_at.as_ref()?.motion_to(pair, self.reach())
    }

    fn reach(&self) -> f64 {
        self.margin + self.slack.distance
    }

    /// The slack with which to search now, metres, after the motion since the last search of the same pair.
    fn next_slack(&self, pair: &Pair, margin: f64, motion: Option<f64>) -> f64 {
        // How much slack pays is not known before the second search.
        let Some(motion) = motion else { return 0.0 };
        let each = motion / f64::from(self.uses + 1);
        let wanted = (CALLS * each).max(LEAST_SLACK * pair.size);
        let possible = wanted.min(self.slack_limit.unwrap_or(f64::INFINITY));
        // Slack that does not last for one more call costs time and saves none.
        if wanted > margin || possible <= each {
            0.0
        } else {
            possible
        }
    }

    /// Makes room for the candidates of `shares` shares. Surplus ones stay, empty, so that their memory is kept.
    pub fn make_room(&mut self, shares: usize) {
        if self.shares.len() < shares {
            self.shares.resize_with(shares, Candidates::default);
        }
        self.shares[shares..].iter_mut().for_each(Candidates::clear);
    }

    /// Whether any candidates may cross after a motion within this one of [`FRACTIONS`] of the slack.
    pub fn may_cross(&self, fraction: usize) -> bool {
        self.shares.iter().any(|share| share.may_cross[fraction])
    }

    fn len(&self) -> usize {
        self.shares.iter().map(Candidates::len).sum()
    }

    /// Drops very many candidates, and searches with less slack from now on. Returns memory that was only needed by
    /// earlier searches.
    pub fn limit(&mut self) {
        if self.uses > 0 {
            return;
        }
        if self.len() > MAX_CANDIDATES {
            *self = Self {
                found_at: self.found_at.take(),
                slack_limit: Some(0.5 * self.slack.distance),
                is_large: self.is_large,
                ..Self::default()
            };
        } else {
            // Some lists are long in every other search only.
            self.recent_searches.most = self.recent_searches.most.max(self.len());
            self.recent_searches.searches += 1;
            if self.recent_searches.searches == SEARCHES {
                let most = self.recent_searches.most;
                self.shares.iter_mut().for_each(|share| share.shrink(most));
                self.recent_searches = RecentSearches::default();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pair::Worker;
    use super::super::pair_of_bodies;
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::{TriMesh, shapes};
    use crate::state::mesh_arena::MeshArena;
    use crate::state::{Bodies, Body};
    use crate::testing::scenes::any_vector;
    use glam::Quat;

    fn meshes() -> (MeshArena, Vec<u32>) {
        let open = shapes::torus(12, 10, 0.7, 0.3);
        let open = TriMesh::new(open.vertices().to_vec(), open.triangles()[..200].to_vec()).unwrap();
        let shapes = [
            shapes::knot_1120(),
            shapes::cube(0.8),
            shapes::torus_240(),
            shapes::ball(0.5, 2),
            open,
            shapes::ball(0.5, 2).flipped(),
        ];
        let mut arena = MeshArena::default();
        let slots = shapes.iter().map(|shape| arena.add(CollisionMesh::new(shape)));
        let slots = slots.collect();
        (arena, slots)
    }

    /// All features of both bodies and the reduced ones, as text, which shows every bit.
    fn features(worker: &mut Worker, bodies: &Bodies, meshes: &MeshArena, margin: f32, kept: &mut Kept) -> [String; 2] {
        let pair = pair_of_bodies(bodies, meshes, [0, 1]).unwrap();
        let all = format!("{:?}", worker.all(&pair, margin, kept, 1));
        [
            all,
            format!("{:?}", worker.reduced(&pair, margin, &mut kept.clone(), 1)),
        ]
    }

    #[test]
    fn what_is_kept_gives_the_points_of_a_new_search_to_the_bit() {
        let (arena, slots) = meshes();
        let mut random = fastrand::Rng::with_seed(8);
        let (mut worker, mut calls, mut searches, mut with_points) = (Worker::default(), 0, [0; 2], 0);
        for round in 0..180 {
            let scale = match round % 5 {
                0 => Vec3::new(1.0, 0.6, 1.3),
                1 => Vec3::new(-1.0, 1.0, 1.0),
                2 => Vec3::new(6.0, 5.0, 0.5),
                _ => Vec3::ONE,
            };
            let scales = [[Vec3::ONE, scale], [scale, Vec3::ONE]][round % 2];
            let mesh = [slots[round % 6], slots[round / 6 % 6]];
            let mut at = any_vector(&mut || random.f32());
            let mut turn = Quat::from_scaled_axis(3.0 * any_vector(&mut || random.f32()));
            let step = [1.0e-5, 1.0e-4, 1.0e-3, 1.0e-2][round % 4];
            let mut kept = Kept::default();
            for call in 0..30 {
                let mut bodies = Bodies::default();
                let first = Quat::from_scaled_axis(0.1 * step * any_vector(&mut || random.f32()));
                for (i, (at, turn)) in [(Vec3::ZERO, first), (at, turn)].into_iter().enumerate() {
                    let body = Body::at_rest(mesh[i], at, turn, scales[i]);
                    bodies.push(&body, &arena).unwrap();
                }
                let margin = 0.02 + step * random.f32();
                let uses = [kept.near.uses, kept.deep.uses];
                let reused = features(&mut worker, &bodies, &arena, margin, &mut kept);
                let afresh = features(&mut worker, &bodies, &arena, margin, &mut Kept::default());
                assert_eq!(reused, afresh, "round {round}, call {call}");
                calls += 1;
                searches[0] += u32::from(kept.near.uses <= uses[0]);
                searches[1] += u32::from(kept.deep.uses < uses[1]);
                with_points += u32::from(afresh[0].len() > 2);
                at += step * (any_vector(&mut || random.f32()) - 0.5 * at);
                turn = (Quat::from_scaled_axis(step * any_vector(&mut || random.f32())) * turn).normalize();
            }
        }
        println!("{searches:?} searches in {calls} calls, {with_points} with points");
        assert!(with_points > 2000 && 2 * searches[0] < calls, "{searches:?}");
    }
}
