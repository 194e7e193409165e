//! What is kept from one interval to the next: impulses, so that a pile need not find out anew what holds it up.

use super::bodies::SolverBodies;
use super::constraints::{Constraints, Point};
use super::motion::Movers;
use crate::state::ManifoldPoint;
use crate::types::solver_settings::SolverSettings;
use glam::{Quat, Vec3};
use rayon::prelude::*;

/// Kept points of a pair beyond this many are not looked at: a bit of a word stands for each.
pub(super) const MAX_MATCHED: usize = 64;
/// What holds up a weight is proportional to the length of a substep, up to this factor.
pub(super) const MAX_GROWTH: f32 = 2.0;

/// The impulses of the last collision substep, by the keys of bodies: bodies may come, go, and be numbered anew.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WarmStart {
    /// Ascending by keys.
    pairs: Vec<KeptPair>,
    points: Vec<KeptPoint>,
    /// Length of the substeps that the impulses belong to, seconds.
    substep: f32,
}

/// What is kept of a pair, whose first body is that of the smaller number then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KeptPair {
    /// The smaller key first.
    keys: [u64; 2],
    first: u32,
    count: u32,
    /// The order of numbers was not that of keys.
    flipped: bool,
    pub depenetrating: bool,
    direction: Vec3,
    /// From each body's axes to the world's.
    rotations: [Quat; 2],
}

/// What is kept of a point, as the world was then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct KeptPoint {
    /// From the centres of mass.
    anchors: [Vec3; 2],
    normal: Vec3,
    impulse: f32,
    friction: Vec3,
}

/// A pair as it was, seen from where its bodies are numbered now.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept<'a> {
    pub pair: &'a KeptPair,
    points: &'a [KeptPoint],
    /// The first body then is the second now.
    swapped: bool,
}

impl WarmStart {
    /// Forgets everything: for bodies that were put elsewhere.
    pub fn clear(&mut self) {
        self.pairs.clear();
        self.points.clear();
    }

    /// How many pairs are remembered.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// The pair of bodies with these keys.
    pub(super) fn find(&self, keys: [u64; 2]) -> Option<Kept<'_>> {
        let sorted = sorted(keys);
        let index = self.pairs.binary_search_by_key(&sorted, |pair| pair.keys).ok()?;
        let pair = &self.pairs[index];
        let first = pair.first as usize;
        Some(Kept {
            pair,
            points: &self.points[first..first + pair.count as usize],
            swapped: pair.flipped != (sorted != keys),
        })
    }

    /// By how much impulses grow for substeps of `h` seconds: what holds up a weight is proportional to time.
    pub(super) fn growth(&self, h: f32) -> f32 {
        if self.substep > 0.0 {
            (h / self.substep).min(MAX_GROWTH)
        } else {
            1.0
        }
    }

    /// Keeps what an interval with substeps of `h` seconds ended with.
    pub(super) fn keep(&mut self, constraints: &Constraints, movers: &Movers, bodies: &SolverBodies, h: f32) {
        self.substep = h;
        self.points.resize(constraints.points().len(), KeptPoint::default());
        (&mut self.points, constraints.points())
            .into_par_iter()
            .with_min_len(1024)
            .for_each(|(kept, point)| *kept = KeptPoint::new(point));
        self.pairs.clear();
        for pair in constraints.pairs() {
            let [a, b] = pair.bodies.map(|i| i as usize);
            if a >= bodies.len() || b >= bodies.len() || pair.count == 0 {
                continue;
            }
            let keys = [bodies.keys[a], bodies.keys[b]];
            self.pairs.push(KeptPair {
                keys: sorted(keys),
                first: pair.first,
                count: pair.count,
                flipped: sorted(keys) != keys,
                depenetrating: pair.depenetrating,
                direction: pair.direction,
                rotations: [a, b].map(|i| movers.rotation(i)),
            });
        }
        self.pairs.par_sort_unstable_by_key(|pair| (pair.keys, pair.first));
    }
}

fn sorted([a, b]: [u64; 2]) -> [u64; 2] {
    [a.min(b), a.max(b)]
}

impl KeptPoint {
    fn new(point: &Point) -> Self {
        // What bounces has left, or is about to: the impulse that stopped it must not be given again.
        let stays = point.usable && point.bounce == 0.0;
        Self {
            anchors: point.anchors.map(Vec3::from),
            normal: point.normal().into(),
            impulse: if stays { point.impulse } else { 0.0 },
            friction: point.friction_vector().into(),
        }
    }
}

impl Kept<'_> {
    /// The way out of a dispute, or zero.
    pub fn direction(&self) -> Vec3 {
        if self.swapped {
            -self.pair.direction
        } else {
            self.pair.direction
        }
    }

    /// The sum of normal impulses, or of normals where none pushed.
    pub fn push(&self) -> Vec3 {
        let sum: Vec3 = self.points.iter().map(|p| p.normal * p.impulse).sum();
        let sum = if sum == Vec3::ZERO {
            self.points.iter().map(|p| p.normal).sum()
        } else {
            sum
        };
        if self.swapped { -sum } else { sum }
    }
}

/// Hands out the impulses of a pair's old points, each to one new point.
pub(super) struct Match<'a> {
    kept: Option<&'a Kept<'a>>,
    /// How to turn the bodies back to where they were.
    back: [Quat; 2],
    /// The square of the distance.
    distance: f32,
    normal: f32,
    growth: f32,
    /// One bit for each old point that is given away. More than 64 are not matched.
    taken: u64,
}

impl<'a> Match<'a> {
    pub fn new(
        kept: Option<&'a Kept<'a>>,
        rotations: [Quat; 2],
        settings: &SolverSettings,
        diameter: f32,
        growth: f32,
    ) -> Self {
        let kept = kept.filter(|kept| !kept.pair.depenetrating);
        let back = kept.map_or([Quat::IDENTITY; 2], |kept| {
            let [one, other] = kept.pair.rotations;
            let before = if kept.swapped { [other, one] } else { [one, other] };
            [0, 1].map(|end| before[end] * rotations[end].conjugate())
        });
        Self {
            kept,
            back,
            distance: (settings.match_distance * diameter).powi(2),
            normal: settings.match_normal,
            growth,
            taken: 0,
        }
    }

    /// Normal impulse and friction impulse of the nearest old point, as near as either body sees it: what slides along one
    /// body rests on the other.
    pub fn take(&mut self, point: &ManifoldPoint) -> Option<(f32, Vec3)> {
        let kept = self.kept?;
        let sign = if kept.swapped { -1.0 } else { 1.0 };
        let anchors = [self.back[0] * point.anchors[0], self.back[1] * point.anchors[1]];
        let (mut nearest, mut found) = (self.distance, None);
        for (i, old) in kept.points.iter().enumerate().take(MAX_MATCHED) {
            if self.taken >> i & 1 == 1 || old.impulse <= 0.0 || sign * old.normal.dot(point.normal) < self.normal {
                continue;
            }
            let at = if kept.swapped {
                [old.anchors[1], old.anchors[0]]
            } else {
                old.anchors
            };
            let distance = at[0]
                .distance_squared(anchors[0])
                .min(at[1].distance_squared(anchors[1]));
            if distance < nearest {
                (nearest, found) = (distance, Some((i, old)));
            }
        }
        let (i, old) = found?;
        self.taken |= 1 << i;
        Some((self.growth * old.impulse, self.growth * sign * old.friction))
    }
}
