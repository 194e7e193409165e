//! Warm starting: the contact impulses of one collision substep are the first guess for the next.

use super::bodies::SolverBodies;
use super::constraints::Constraints;
use super::contact::Point;
use super::motion::unit;
use crate::parallel::loops;
use crate::state::ManifoldPoint;
use crate::state::merge::merge;
use crate::types::solver_settings::SolverSettings;
use glam::{Quat, Vec3};
use rayon::prelude::*;

/// Most saved points of a pair that are matched: each has a bit of a word.
pub(super) const MAX_MATCHED: usize = 64;
/// The largest factor on saved impulses when the length of the substep changes.
pub(super) const MAX_IMPULSE_SCALE: f32 = 2.0;

/// The impulses of the last collision substep. Pairs are identified by the keys of their colliders, so these may
/// be added, removed and renumbered.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WarmStart {
    /// Ascending by keys.
    pub(super) pairs: Vec<SavedPair>,
    pub(super) points: Vec<SavedPoint>,
}

/// A pair of the last collision substep. Its first body had the smaller number then.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct SavedPair {
    /// The smaller key first.
    pub keys: [u64; 2],
    pub first: u32,
    pub count: u32,
    /// Length of the solver substeps in which its impulses acted, seconds.
    pub substep: f32,
    /// The first body had the larger key.
    pub flipped: bool,
    pub depenetrating: bool,
    pub separating_direction: Vec3,
    /// From each body's axes to the world's.
    pub rotations: [Quat; 2],
}

/// A point of the last collision substep, in world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct SavedPoint {
    /// From the centres of mass.
    pub anchors: [Vec3; 2],
    pub normal: Vec3,
    pub normal_impulse: f32,
    pub friction_impulse: Vec3,
}

/// The last contact of a pair, in the present order of its bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastContact<'a> {
    pub pair: &'a SavedPair,
    pub points: &'a [SavedPoint],
    /// The first body then is the second now.
    swapped: bool,
}

impl WarmStart {
    /// Forgets all impulses. Needed when bodies are teleported.
    pub fn clear(&mut self) {
        self.pairs.clear();
        self.points.clear();
    }

    /// Number of saved pairs.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Whether the colliders with these keys had contact points.
    pub(crate) fn has(&self, keys: [u64; 2]) -> bool {
        self.find(keys).is_some()
    }

    /// The last contact between the colliders with these keys.
    pub(super) fn find(&self, keys: [u64; 2]) -> Option<LastContact<'_>> {
        let sorted = sorted(keys);
        let index = self.pairs.binary_search_by_key(&sorted, |pair| pair.keys).ok()?;
        let pair = &self.pairs[index];
        Some(LastContact {
            pair,
            points: self.points_of(pair),
            swapped: pair.flipped != (sorted != keys),
        })
    }

    fn points_of(&self, pair: &SavedPair) -> &[SavedPoint] {
        &self.points[pair.first as usize..][..pair.count as usize]
    }

    /// The impulses of pairs that are `wanted` by their keys.
    pub(crate) fn select(&self, wanted: impl Fn([u64; 2]) -> bool) -> Self {
        let mut some = Self::default();
        for pair in self.pairs.iter().filter(|pair| wanted(pair.keys)) {
            some.add_pair(pair, self);
        }
        some
    }

    /// These impulses and others, in order.
    pub(crate) fn merged(&self, others: &Self) -> Self {
        let mut all = Self::default();
        let pairs = [self, others].map(|some| some.pairs.iter().map(move |pair| (pair, some)));
        merge(
            pairs,
            |&(pair, _): &(&SavedPair, &Self)| pair.keys,
            |(pair, from)| all.add_pair(pair, from),
        );
        all
    }

    fn add_pair(&mut self, pair: &SavedPair, from: &Self) {
        self.pairs.push(SavedPair {
            first: self.points.len() as u32,
            ..*pair
        });
        self.points.extend_from_slice(from.points_of(pair));
    }

    /// Saves the impulses at the end of a collision substep. `before` are those from its start; pairs that were not
    /// solved keep them.
    pub(super) fn save(&mut self, before: &Self, constraints: &Constraints, bodies: &SolverBodies) {
        self.points.resize(constraints.points().len(), SavedPoint::default());
        let points = (&mut self.points, constraints.points()).into_par_iter();
        loops::for_each(points, 1024, |(saved, point)| *saved = SavedPoint::new(point));
        self.pairs.clear();
        for last in constraints.unsolved() {
            self.pairs.push(SavedPair {
                first: self.points.len() as u32,
                ..*last
            });
            self.points.extend_from_slice(before.points_of(last));
        }
        for pair in constraints.pairs() {
            let keys = pair.colliders.map(|i| bodies.keys[i as usize]);
            self.pairs.push(SavedPair {
                keys: sorted(keys),
                first: pair.first,
                count: pair.count,
                substep: pair.substep,
                flipped: sorted(keys) != keys,
                depenetrating: pair.depenetrating,
                separating_direction: pair.separating_direction,
                rotations: pair.bodies.map(|body| unit(bodies.motions[body as usize].rotation)),
            });
        }
        loops::sort_unstable_by_key(&mut self.pairs, |pair| (pair.keys, pair.first));
    }
}

pub(super) fn sorted([a, b]: [u64; 2]) -> [u64; 2] {
    [a.min(b), a.max(b)]
}

impl SavedPoint {
    fn new(point: &Point) -> Self {
        // A point with restitution separates: the impulse of its impact must not be applied again.
        let persists = point.valid && !point.bounced;
        Self {
            anchors: point.anchors.map(Vec3::from),
            normal: point.normal().into(),
            normal_impulse: if persists { point.normal_impulse } else { 0.0 },
            friction_impulse: point.friction_vector().into(),
        }
    }
}

impl LastContact<'_> {
    /// The direction that resolves a conflict between contact points, or zero; see
    /// [`Overlap::Conflicting`](super::overlap::Overlap::Conflicting).
    pub fn separating_direction(&self) -> Vec3 {
        if self.swapped {
            -self.pair.separating_direction
        } else {
            self.pair.separating_direction
        }
    }

    /// The sum of the normal impulses as a vector, or the sum of the normals if there was no impulse.
    pub fn normal_impulse(&self) -> Vec3 {
        let sum: Vec3 = self.points.iter().map(|p| p.normal * p.normal_impulse).sum();
        let sum = if sum == Vec3::ZERO {
            self.points.iter().map(|p| p.normal).sum()
        } else {
            sum
        };
        if self.swapped { -sum } else { sum }
    }
}

/// Matches the saved points of a pair with its new points. Each saved point is used at most once.
pub(super) struct PointMatcher<'a> {
    last: Option<&'a LastContact<'a>>,
    /// From each body's present rotation back to its saved one.
    rotations_back: [Quat; 2],
    max_distance_squared: f32,
    /// Smallest cosine of the angle between the normals.
    min_normal_cosine: f32,
    impulse_scale: f32,
    /// One bit for each saved point that is used. Only the first 64 can be matched.
    used: u64,
}

impl<'a> PointMatcher<'a> {
    pub fn new(
        last: Option<&'a LastContact<'a>>,
        rotations: [Quat; 2],
        settings: &SolverSettings,
        diameter: f32,
        substep: f32,
    ) -> Self {
        let last = last.filter(|last| !last.pair.depenetrating);
        // The impulse that supports a weight is proportional to the length of the substep.
        let impulse_scale = last
            .filter(|last| last.pair.substep > 0.0)
            .map_or(1.0, |last| (substep / last.pair.substep).min(MAX_IMPULSE_SCALE));
        let rotations_back = last.map_or([Quat::IDENTITY; 2], |last| {
            let [one, other] = last.pair.rotations;
            let before = if last.swapped { [other, one] } else { [one, other] };
            [0, 1].map(|side| before[side] * rotations[side].conjugate())
        });
        Self {
            last,
            rotations_back,
            max_distance_squared: (settings.match_distance * diameter).powi(2),
            min_normal_cosine: settings.match_normal,
            impulse_scale,
            used: 0,
        }
    }

    /// Normal impulse and friction impulse of the nearest saved point. Distances are measured on both bodies and the
    /// smaller one counts, because a point that slides along one body may be at rest on the other.
    pub fn find(&mut self, point: &ManifoldPoint) -> Option<(f32, Vec3)> {
        let last = self.last?;
        let sign = if last.swapped { -1.0 } else { 1.0 };
        let anchors = [
            self.rotations_back[0] * point.anchors[0],
            self.rotations_back[1] * point.anchors[1],
        ];
        let (mut nearest, mut found) = (self.max_distance_squared, None);
        for (i, saved) in last.points.iter().enumerate().take(MAX_MATCHED) {
            if self.used >> i & 1 == 1
                || saved.normal_impulse <= 0.0
                || sign * saved.normal.dot(point.normal) < self.min_normal_cosine
            {
                continue;
            }
            let at = if last.swapped {
                [saved.anchors[1], saved.anchors[0]]
            } else {
                saved.anchors
            };
            let distance = at[0]
                .distance_squared(anchors[0])
                .min(at[1].distance_squared(anchors[1]));
            if distance < nearest {
                (nearest, found) = (distance, Some((i, saved)));
            }
        }
        let (i, saved) = found?;
        self.used |= 1 << i;
        Some((
            self.impulse_scale * saved.normal_impulse,
            self.impulse_scale * sign * saved.friction_impulse,
        ))
    }
}
