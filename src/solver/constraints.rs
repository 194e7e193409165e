//! All contact constraints of a collision substep in flat lists, and the parallel loop over their bundles.

use super::batch::{Batch, PointLanes};
use super::bodies::SolverBodies;
use super::bundles::{Bundle, Bundles};
use super::contact::{Pair, Point};
use super::islands::{Island, IslandPair, Islands, Mobility};
use super::motion::{BodyStates, StatesMut};
use super::pace::Pace;
use super::warm_start::{SavedPair, WarmStart};
use crate::parallel::loops;
use crate::state::Manifolds;
use glam::Vec3;

/// Bundles with fewer points and bodies are solved by one task.
const GRAIN: usize = 512;

/// How many bodies cost as much as a pair.
const PAIR_WEIGHT: usize = 8;

/// All constraints of a collision substep, and the bodies on which they act.
#[derive(Clone, Debug, Default)]
pub(super) struct Constraints {
    pub islands: Islands,
    pub states: BodyStates,
    bundles: Bundles,
    /// In the order of the bundles.
    pairs: Vec<Pair>,
    points: Vec<Point>,
    /// The pairs in lanes, and their points.
    batches: Vec<Batch>,
    lanes: Vec<PointLanes>,
    /// The bodies of each manifold; `None` if it is not solved.
    solved: Vec<Option<[u32; 2]>>,
    /// For each point of the manifolds, its number among `points`; `u32::MAX` if it is not solved.
    numbers: Vec<u32>,
    /// What is saved of pairs that are not solved.
    unsolved: Vec<SavedPair>,
    /// Points in the manifolds, of pairs that are not solved, that had an impulse when they were last solved,
    /// ascending.
    pushing: Vec<u32>,
}

/// One or more bundles with their bodies, pairs and points.
pub(super) struct BundlesMut<'a> {
    bundles: &'a [Bundle],
    pub states: StatesMut<'a>,
    pub pairs: &'a mut [Pair],
    pub points: &'a mut [Point],
    pub batches: &'a mut [Batch],
    pub lanes: &'a mut [PointLanes],
}

impl Constraints {
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The point that was made from a point of the manifolds.
    fn point(&self, index: usize) -> Option<&Point> {
        self.points.get(*self.numbers.get(index)? as usize)
    }

    /// The total normal impulse of a point over the collision substep.
    pub fn impulse_of(&self, index: usize) -> f32 {
        self.point(index)
            .map_or(0.0, |p| p.total_normal_impulse + p.normal_impulse)
    }

    /// Whether a point has an impulse. Points of pairs that are not solved keep the impulse of their last solved
    /// substep.
    pub fn pushes(&self, index: usize) -> bool {
        self.point(index).map_or_else(
            || self.pushing.binary_search(&(index as u32)).is_ok(),
            |p| p.normal_impulse > 0.0 || p.total_normal_impulse + p.normal_impulse > 0.0,
        )
    }

    /// What is saved of pairs that are not solved.
    pub fn unsolved(&self) -> &[SavedPair] {
        &self.unsolved
    }

    /// Sorts bodies and manifolds into islands, and makes room for the constraints.
    pub fn begin(
        &mut self,
        bodies: &SolverBodies,
        mobility: &[Mobility],
        paces: &[Pace],
        manifolds: &Manifolds,
        warm: &WarmStart,
    ) {
        let is_movable = |body: u32| mobility[body as usize] == Mobility::Movable;
        let mut end = 0;
        self.solved.clear();
        self.solved.extend(manifolds.pairs.iter().map(|manifold| {
            // A manifold whose points overlap those of an earlier one, or exceed the list, is not solved.
            let range = manifold.first_point as usize..manifold.first_point as usize + manifold.point_count as usize;
            let fits = range.start >= end && range.end <= manifolds.points.len();
            end = if fits { range.end } else { end };
            if !fits || range.is_empty() || !bodies.may_touch(manifold.bodies) {
                return None;
            }
            let pair = manifold.bodies.map(|collider| bodies.body_of(collider));
            pair.into_iter().any(is_movable).then_some(pair)
        }));
        self.islands.build(bodies.movers(), mobility, paces, &self.solved);
        self.states.resize(self.islands.bodies.len());
        self.add_batches(manifolds);
        self.add_pairs(manifolds);
        self.find_unsolved(bodies, manifolds, warm);
    }

    /// Sorts the islands into bundles and the pairs by batches, and makes room for these.
    fn add_batches(&mut self, manifolds: &Manifolds) {
        let points_of = |pair: &IslandPair| manifolds.pairs[pair.number as usize].point_count;
        let Islands { list, pairs, .. } = &mut self.islands;
        self.bundles.build(list, pairs, points_of);
        let sizes = &self.bundles.batches;
        self.batches.clear();
        self.batches.extend(sizes.iter().copied().map(Batch::new));
        let points: u32 = sizes.iter().map(|size| size.points).sum();
        self.lanes.resize(points as usize, PointLanes::default());
    }

    fn add_pairs(&mut self, manifolds: &Manifolds) {
        self.pairs.clear();
        self.points.clear();
        self.numbers.clear();
        self.numbers.resize(manifolds.points.len(), u32::MAX);
        let mut end = 0;
        for pair in &self.islands.pairs {
            let number = pair.number as usize;
            let manifold = &manifolds.pairs[number];
            self.pairs.push(Pair {
                colliders: manifold.bodies,
                bodies: self.solved[number].expect("islands have only pairs that are solved"),
                slots: pair.slots,
                source: manifold.first_point,
                first: end,
                count: manifold.point_count,
                ..Pair::default()
            });
            for i in 0..manifold.point_count {
                self.numbers[(manifold.first_point + i) as usize] = end + i;
            }
            end += manifold.point_count;
        }
        self.points.resize(end as usize, Point::NONE);
    }

    /// Finds the pairs that are not solved, and which of their points pushed when they were.
    fn find_unsolved(&mut self, bodies: &SolverBodies, manifolds: &Manifolds, warm: &WarmStart) {
        self.unsolved.clear();
        self.pushing.clear();
        for (manifold, solved) in manifolds.pairs.iter().zip(&self.solved) {
            if solved.is_some() || !bodies.may_touch(manifold.bodies) {
                continue;
            }
            let keys = manifold.bodies.map(|body| bodies.keys[body as usize]);
            let Some(last) = warm.find(keys) else { continue };
            self.unsolved.push(*last.pair);
            if last.points.len() == manifold.point_count as usize {
                let indices = (manifold.first_point..).zip(last.points);
                let pushing = indices.filter(|(_, point)| point.normal_impulse > 0.0);
                self.pushing.extend(pushing.map(|(index, _)| index));
            }
        }
    }

    /// Writes the new poses and velocities to `bodies`, and clears the external impulses that were applied.
    pub fn write_back(&self, bodies: &mut SolverBodies, mobility: &[Mobility]) {
        bodies.for_each_mover(|bodies, i| {
            if !bodies.sleep[i].asleep {
                bodies.forces[i].impulse = Vec3::ZERO;
                bodies.forces[i].angular_impulse = Vec3::ZERO;
            }
        });
        for (slot, &body) in self.islands.bodies.iter().enumerate() {
            let is_own = match mobility[body as usize] {
                Mobility::Fixed => false,
                Mobility::Moving => slot >= self.islands.first_free,
                Mobility::Movable | Mobility::Done => true,
            };
            if is_own {
                self.states.write_back(slot, &mut bodies.motions[body as usize]);
            }
        }
    }

    /// Calls `f` with every bundle, its islands, and the bodies of its slots, in parallel.
    pub fn for_each_bundle(&mut self, f: impl Fn(&[Island], &[u32], &mut BundlesMut) + Sync) {
        let all = BundlesMut {
            bundles: &self.bundles.list,
            states: self.states.resize(self.islands.bodies.len()),
            pairs: &mut self.pairs,
            points: &mut self.points,
            batches: &mut self.batches,
            lanes: &mut self.lanes,
        };
        let Islands { list, bodies, .. } = &self.islands;
        all.for_each(&|bundle, data| f(&list[bundle.islands.clone()], &bodies[bundle.slots.clone()], data));
    }
}

impl BundlesMut<'_> {
    /// Splits the bundles in half until they are few enough for one task, and calls `f` with each.
    fn for_each<F: Fn(&Bundle, &mut BundlesMut) + Sync>(self, f: &F) {
        let count = self.bundles.len();
        if count == 0 {
            return;
        }
        if count == 1 {
            let bundle = &self.bundles[0];
            f(bundle, &mut { self });
            return;
        }
        let is_small = self.points.len() + self.states.velocities.len() <= GRAIN;
        let (first, second) = self.split();
        if is_small {
            first.for_each(f);
            second.for_each(f);
        } else {
            loops::join(|| first.for_each(f), || second.for_each(f));
        }
    }

    /// Two halves of about equal cost.
    fn split(self) -> (Self, Self) {
        let size = |bundle: &Bundle| bundle.slots.end + PAIR_WEIGHT * bundle.pairs.end;
        let (first, last) = (&self.bundles[0], &self.bundles[self.bundles.len() - 1]);
        let half = (first.slots.start + PAIR_WEIGHT * first.pairs.start + size(last)) / 2;
        let middle = self.bundles.partition_point(|bundle| size(bundle) <= half);
        let middle = middle.clamp(1, self.bundles.len() - 1);
        let (first, second) = self.bundles.split_at(middle);
        let slots = first[middle - 1].slots.end - first[0].slots.start;
        let pairs = first[middle - 1].pairs.end - first[0].pairs.start;
        let first_point = self.pairs.first().map_or(0, |pair| pair.first);
        let points = self
            .pairs
            .get(pairs)
            .map_or(self.points.len(), |pair| (pair.first - first_point) as usize);
        let batches = first[middle - 1].batches.end - first[0].batches.start;
        let lanes = self.batches[..batches].iter().map(|batch| batch.points).sum();
        let (states, more_states) = self.states.split_at(slots);
        let (pairs, more_pairs) = self.pairs.split_at_mut(pairs);
        let (points, more_points) = self.points.split_at_mut(points);
        let (batches, more_batches) = self.batches.split_at_mut(batches);
        let (lanes, more_lanes) = self.lanes.split_at_mut(lanes);
        (
            Self {
                bundles: first,
                states,
                pairs,
                points,
                batches,
                lanes,
            },
            Self {
                bundles: second,
                states: more_states,
                pairs: more_pairs,
                points: more_points,
                batches: more_batches,
                lanes: more_lanes,
            },
        )
    }
}
