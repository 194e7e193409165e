//! An island in the form in which it is solved directly: gathered from the lanes of its batches, and written back.

use super::super::batch::{Batch, Batches, PointLanes};
use super::super::motion::StatesMut;
use super::blocks::{Matrix, N, Vector};
use super::mass::{BodyMass, vector};
use super::order::Pattern;
use super::point::{PairSides, Point};
use crate::simd::level::with_simd;
use glam::Vec3A;
use std::ops::Range;

/// Most products of blocks in one factorisation: for each body, and besides. Chains, towers and small piles have fewer.
/// A large pile has more, and gains less.
const PRODUCTS_PER_BODY: usize = 20;
const MORE_PRODUCTS: usize = 200;
/// Numbers of bodies of islands that are solved directly without a heavy load.
const LEAST_CHAIN: usize = 2;
const LONGEST_CHAIN: usize = 128;
/// No body, pair, lane or block.
pub(super) const NONE: u32 = u32::MAX;

/// An island that is solved directly.
#[derive(Clone, Debug)]
pub(in crate::solver) struct Direct {
    /// The slot of each body, in the order of elimination.
    pub(super) slots: Vec<u32>,
    /// In the order of the batches, and of the lanes of each. Pairs of other islands have no lane.
    pub(super) pairs: Vec<DirectPair>,
    pub(super) matrix: Matrix,
    pub(super) masses: Vec<BodyMass>,
    pub(super) points: Vec<Point>,
    /// The velocities before the solve, how far they have changed, and their change in this iteration.
    pub(super) start: Vec<Vector>,
    pub(super) moved: Vec<Vector>,
    pub(super) change: Vec<Vector>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct DirectPair {
    lane: u32,
    /// Slots of its bodies, and their places in the order of elimination; `NONE` for a body that impulses do not move.
    slots: [u32; 2],
    pub places: [u32; 2],
    /// The number of its block below the diagonal; `NONE` if impulses move only one body.
    pub block: u32,
    /// The end of its points.
    end: u32,
}

impl Direct {
    /// The island with its pairs in this lane, or in all lanes. `None` if an iteration would cost too much, or if the
    /// island is neither `loaded` nor like a chain.
    pub fn new(batches: &[Batch], states: &StatesMut, lane: Option<usize>, loaded: bool) -> Option<Self> {
        let mut numbers = vec![NONE; states.masses.len()];
        let mut slots = Vec::new();
        let mut pairs = Vec::new();
        for batch in batches {
            for own in 0..batch.pairs {
                let is_wanted = lane.is_none_or(|lane| lane == own);
                let both = [batch.slots[0][own], batch.slots[1][own]];
                let places = both.map(|slot| {
                    if !is_wanted || states.masses[slot as usize].is_immovable() {
                        return NONE;
                    }
                    let number = &mut numbers[slot as usize];
                    if *number == NONE {
                        *number = slots.len() as u32;
                        slots.push(slot);
                    }
                    *number
                });
                pairs.push(DirectPair {
                    lane: if is_wanted { own as u32 } else { NONE },
                    slots: both,
                    places,
                    block: NONE,
                    end: 0,
                });
            }
        }
        let places = pairs.iter().map(|pair| pair.places);
        let joined = places.filter(|places| !places.contains(&NONE));
        if !loaded && !is_chain(slots.len(), joined.clone().count()) {
            return None;
        }
        let pattern = Pattern::new(slots.len(), joined, PRODUCTS_PER_BODY * slots.len() + MORE_PRODUCTS)?;
        let matrix = Matrix::new(&pattern);
        let mut ordered = slots.clone();
        for (slot, &place) in slots.iter().zip(&pattern.place) {
            ordered[place as usize] = *slot;
        }
        for pair in &mut pairs {
            for place in pair.places.iter_mut().filter(|place| **place != NONE) {
                *place = pattern.place[*place as usize];
            }
            if let [a, b] = pair.places
                && a != NONE
                && b != NONE
            {
                pair.block = matrix.find(a.max(b), a.min(b));
            }
        }
        Some(Self {
            slots: ordered,
            pairs,
            matrix,
            masses: Vec::new(),
            points: Vec::new(),
            start: Vec::new(),
            moved: Vec::new(),
            change: Vec::new(),
        })
    }

    /// Finds the impulses and velocities of the island, and writes them. Changes nothing if it finds none.
    pub fn solve(&mut self, batches: &mut [Batch], points: &mut [PointLanes], states: &mut StatesMut) {
        self.gather(batches, points, states);
        if with_simd!(_simd => self.iterate()) {
            self.scatter(batches, points, states);
        }
    }

    fn gather(&mut self, batches: &mut [Batch], points: &mut [PointLanes], states: &StatesMut) {
        let velocity = |slot: u32| vector(&states.velocities[slot as usize]);
        let masses = self
            .slots
            .iter()
            .map(|&slot| BodyMass::new(&states.masses[slot as usize]));
        self.masses.clear();
        self.masses.extend(masses);
        self.start.clear();
        self.start.extend(self.slots.iter().map(|&slot| velocity(slot)));
        self.points.clear();
        let mut pairs = self.pairs.iter_mut();
        for (batch, points) in Batches::new(batches, points) {
            for pair in pairs.by_ref().take(batch.pairs) {
                if pair.lane != NONE {
                    let lane = pair.lane as usize;
                    let masses = &self.masses;
                    let sides = PairSides {
                        velocities: pair.slots.map(velocity),
                        free: pair
                            .places
                            .map(|place| masses.get(place as usize).map_or([0.0; N], |mass| mass.free)),
                    };
                    let active = points.iter().filter(|point| point.active >> lane & 1 == 1);
                    self.points
                        .extend(active.map(|point| Point::new(batch, point, lane, &sides)));
                }
                pair.end = self.points.len() as u32;
            }
        }
    }

    /// Writes impulses and velocities.
    fn scatter(&self, batches: &mut [Batch], points: &mut [PointLanes], states: &mut StatesMut) {
        let mut ranges = ranges(&self.pairs);
        for (batch, points) in Batches::new(batches, points) {
            for (pair, range) in ranges.by_ref().take(batch.pairs).filter(|(pair, _)| pair.lane != NONE) {
                let lane = pair.lane as usize;
                let active = points.iter_mut().filter(|point| point.active >> lane & 1 == 1);
                for (to, point) in active.zip(&self.points[range]) {
                    let [normal, t, u] = point.result();
                    to.normal_impulse.0[lane] = normal;
                    to.friction_impulse[0].0[lane] = t;
                    to.friction_impulse[1].0[lane] = u;
                    to.touched |= u32::from(normal > 0.0) << lane;
                }
            }
        }
        for ((&slot, start), change) in self.slots.iter().zip(&self.start).zip(&self.change) {
            let [x, y, z, p, q, r] = std::array::from_fn(|i| (start[i] + change[i]) as f32);
            let velocity = &mut states.velocities[slot as usize];
            velocity.linear = Vec3A::new(x, y, z);
            velocity.angular = Vec3A::new(p, q, r);
        }
    }
}

impl DirectPair {
    /// Adds the difference between the impulses of a point and those before the solve to the sums of the impulses on
    /// its bodies.
    #[inline(always)]
    pub fn push(&self, point: &Point, sums: &mut [Vector]) {
        let impulses = point.result();
        let changes = [0, 1, 2].map(|i| f64::from(impulses[i]) - point.start[i] * point.unit);
        for (side, &place) in self.places.iter().enumerate().filter(|(_, place)| **place != NONE) {
            let sum = &mut sums[place as usize];
            for (row, change) in point.rows.iter().zip(changes) {
                for (sum, coefficient) in sum.iter_mut().zip(&row[side]) {
                    *sum += coefficient * change;
                }
            }
        }
    }

    /// The vectors of its bodies; zero for one that impulses do not move.
    #[inline(always)]
    pub fn of(&self, vectors: &[Vector]) -> [Vector; 2] {
        self.places
            .map(|place| vectors.get(place as usize).copied().unwrap_or([0.0; N]))
    }
}

/// Whether an island of so many bodies and pairs of them is a chain, a tower or a tree: nearly as many bodies as pairs,
/// not too many. Passes take long to cross it, and it is cheap to factorise. Others move well enough if their passes do
/// not converge.
fn is_chain(bodies: usize, pairs: usize) -> bool {
    (LEAST_CHAIN..=LONGEST_CHAIN).contains(&bodies) && 4 * pairs <= 5 * bodies
}

/// The pairs, each with the range of its points.
#[inline(always)]
pub(super) fn ranges(pairs: &[DirectPair]) -> impl Iterator<Item = (&DirectPair, Range<usize>)> {
    let mut first = 0;
    pairs.iter().map(move |pair| {
        let range = first..pair.end as usize;
        first = range.end;
        (pair, range)
    })
}
