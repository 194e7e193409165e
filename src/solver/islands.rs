//! Islands: sets of bodies that contacts connect. No two islands share a body that impulses move, so each is solved on
//! its own.

use super::pace::Pace;
use crate::geometry::union_find::UnionFind;
use std::cmp::Reverse;
use std::ops::Range;

/// In place of an island, a slot or a pair that does not exist.
const NONE: u32 = u32::MAX;
/// Bodies without contacts per island.
const FREE_BODIES: usize = 256;

/// A part of the lists of [`Islands`].
#[derive(Clone, Debug)]
pub(super) struct Island {
    pub slots: Range<usize>,
    /// How many of the first slots have bodies that impulses move.
    pub movable: u32,
    pub pairs: Range<usize>,
    /// The common pace of its bodies.
    pub pace: Pace,
}

/// A pair of an island.
#[derive(Clone, Copy, Debug)]
pub(super) struct IslandPair {
    /// Number in the list of pairs from which the islands were built.
    pub number: u32,
    /// Numbers of its bodies within the island; in the order of bundles, within the bundle.
    pub slots: [u32; 2],
    /// One of its bodies does not move.
    pub is_fixed: bool,
}

/// What can change the velocity and the pose of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mobility {
    /// The body does not move.
    Fixed,
    /// The body moves with its own velocity, which impulses do not change.
    Moving,
    /// Impulses change its velocity.
    Movable,
    /// Impulses change its velocity, but it has completed its step and keeps its pose.
    Done,
}

impl Mobility {
    /// Whether impulses change its velocity.
    pub fn has_impulses(self) -> bool {
        matches!(self, Self::Movable | Self::Done)
    }
}

/// All islands. Bodies without contacts form islands without pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Islands {
    pub list: Vec<Island>,
    /// The body of each slot. Each island has its own slot for a body that impulses do not move.
    pub bodies: Vec<u32>,
    /// The first slot of bodies without contacts. Every body that moves without impulses has one there.
    pub first_free: usize,
    /// The pairs of all islands.
    pub pairs: Vec<IslandPair>,
    trees: Trees,
    /// The size of each tree with pairs.
    sizes: Vec<Size>,
    /// The numbers of trees in the order of the list, and the place of each tree in it.
    order: Vec<u32>,
    places: Vec<u32>,
    /// The slot of each body, from the first slot of all.
    slots: Vec<u32>,
    /// Bodies, and pairs, sorted by island: the island in the upper half.
    sorted_bodies: Vec<u64>,
    sorted_pairs: Vec<u64>,
}

/// What decides an island's place in the list.
#[derive(Clone, Copy, Debug)]
struct Size {
    pace: Pace,
    pairs: u32,
}

impl Islands {
    /// Sorts bodies and pairs into islands. `movers` are all bodies that are not static, ascending. `pairs` has the two
    /// bodies of every pair that is to be solved, and `None` for others. Impulses must change the velocity of at least
    /// one of the two.
    ///
    /// Islands of the same pace follow each other, those with more pairs first.
    pub fn build(
        &mut self,
        movers: impl Iterator<Item = usize> + Clone,
        mobility: &[Mobility],
        paces: &[Pace],
        pairs: &[Option<[u32; 2]>],
    ) {
        let is_movable = |body: u32| mobility[body as usize].has_impulses();
        let numbered = || {
            (0u32..)
                .zip(pairs)
                .filter_map(|(number, pair)| Some((number, (*pair)?)))
        };
        self.trees.reset(mobility.len(), movers.clone());
        let trees = self.trees.join(numbered().map(|(_, pair)| pair), is_movable);
        self.sizes.clear();
        self.sizes.resize(
            trees as usize,
            Size {
                pace: Pace::DONE,
                pairs: 0,
            },
        );
        for (_, [a, b]) in numbered() {
            let tree = self.trees.number(if is_movable(a) { a } else { b });
            let size = &mut self.sizes[tree as usize];
            size.pairs += 1;
            size.pace = size.pace.and(paces[a as usize]).and(paces[b as usize]);
        }
        self.find_places();
        self.sorted_pairs.clear();
        for (number, [a, b]) in numbered() {
            let tree = self.trees.number(if is_movable(a) { a } else { b });
            let island = self.places[tree as usize];
            self.sorted_pairs.push(u64::from(island) << 32 | u64::from(number));
        }
        self.sorted_pairs.sort_unstable();
        self.sorted_bodies.clear();
        for body in movers.clone().map(|i| i as u32).filter(|&body| is_movable(body)) {
            let tree = self.trees.number_if_any(body);
            let island = tree.map(|tree| self.places[tree as usize]);
            self.sorted_bodies
                .extend(island.map(|island| u64::from(island) << 32 | u64::from(body)));
        }
        self.sorted_bodies.sort_unstable();

        self.bodies.iter().for_each(|&body| self.slots[body as usize] = NONE);
        self.slots.resize(mobility.len(), NONE);
        self.list.clear();
        self.bodies.clear();
        self.pairs.clear();
        let mut bodies = 0;
        let mut first = 0;
        while first < self.sorted_pairs.len() {
            let island = self.sorted_pairs[first] >> 32;
            let size = self.sizes[self.order[island as usize] as usize];
            let mut start = self.start(size.pace);
            while let Some(&body) = self.sorted_bodies.get(bodies).filter(|&body| body >> 32 == island) {
                self.slot(body as u32, start.slots.start);
                bodies += 1;
            }
            start.movable = (self.bodies.len() - start.slots.start) as u32;
            while let Some(&member) = self.sorted_pairs.get(first).filter(|&pair| pair >> 32 == island) {
                let number = member as u32;
                let pair = pairs[number as usize].expect("only pairs that exist are sorted");
                let slots = pair.map(|body| self.slot(body, start.slots.start));
                let is_fixed = pair.iter().any(|&body| mobility[body as usize] == Mobility::Fixed);
                self.pairs.push(IslandPair {
                    number,
                    slots,
                    is_fixed,
                });
                first += 1;
            }
            self.list.push(start.ending_at(self.bodies.len(), self.pairs.len()));
        }
        self.add_free_bodies(movers, mobility, paces);
    }

    /// Sorts the trees with pairs by pace and by their number of pairs.
    fn find_places(&mut self) {
        let sizes = &self.sizes;
        self.order.clear();
        self.order.extend(0..sizes.len() as u32);
        self.order.sort_unstable_by_key(|&tree| {
            let Size { pace, pairs } = sizes[tree as usize];
            (pace.key(), Reverse(pairs), tree)
        });
        self.places.clear();
        self.places.resize(sizes.len(), 0);
        for (place, &tree) in (0..).zip(&self.order) {
            self.places[tree as usize] = place;
        }
    }

    /// An island that begins after all others.
    fn start(&self, pace: Pace) -> Island {
        Island {
            slots: self.bodies.len()..self.bodies.len(),
            movable: 0,
            pairs: self.pairs.len()..self.pairs.len(),
            pace,
        }
    }

    /// The slot of a body within the island whose slots begin at `first`. The body gets one when it is first met.
    fn slot(&mut self, body: u32, first: usize) -> u32 {
        let slot = self.slots[body as usize];
        // A body that impulses do not move may have slots in earlier islands.
        let known = slot != NONE && slot as usize >= first;
        if !known {
            self.slots[body as usize] = self.bodies.len() as u32;
            self.bodies.push(body);
        }
        self.slots[body as usize] - first as u32
    }

    /// Adds islands without pairs for the bodies that move and are in no other island. The bodies of each have the same
    /// pace.
    fn add_free_bodies(&mut self, movers: impl Iterator<Item = usize>, mobility: &[Mobility], paces: &[Pace]) {
        let first = self.bodies.len();
        self.first_free = first;
        let slots = &self.slots;
        // A body that impulses do not move has copies in the islands it touches. This slot is its own.
        let is_free = |body: &u32| match mobility[*body as usize] {
            Mobility::Fixed | Mobility::Done => false,
            Mobility::Moving => true,
            Mobility::Movable => slots[*body as usize] == NONE,
        };
        self.bodies.extend(movers.map(|i| i as u32).filter(is_free));
        let free = &mut self.bodies[first..];
        let pace_of = |body: u32| paces[body as usize];
        free.sort_unstable_by_key(|&body| (pace_of(body).key(), body));
        let mut end = first;
        for same in free.chunk_by(|&a, &b| pace_of(a) == pace_of(b)) {
            for bodies in same.chunks(FREE_BODIES) {
                self.list.push(Island {
                    slots: end..end + bodies.len(),
                    movable: 0,
                    pairs: self.pairs.len()..self.pairs.len(),
                    pace: pace_of(bodies[0]),
                });
                end += bodies.len();
            }
        }
    }
}

impl Island {
    fn ending_at(mut self, slot: usize, pair: usize) -> Self {
        (self.slots.end, self.pairs.end) = (slot, pair);
        self
    }
}

/// The bodies of each island, joined in a tree.
#[derive(Clone, Debug, Default)]
struct Trees {
    sets: UnionFind,
    /// For the root of each tree with pairs, the tree's number.
    numbers: Vec<u32>,
}

impl Trees {
    /// Makes each of the `members` of `bodies` bodies a tree of its own. All movable bodies of pairs must be members.
    fn reset(&mut self, bodies: usize, members: impl Iterator<Item = usize> + Clone) {
        self.sets.reset_members(bodies, members.clone());
        self.numbers.resize(bodies, NONE);
        members.for_each(|i| self.numbers[i] = NONE);
    }

    /// Joins the movable bodies of each pair, numbers the trees in the order of pairs, and returns how many there are.
    fn join(&mut self, pairs: impl Iterator<Item = [u32; 2]> + Clone, is_movable: impl Fn(u32) -> bool) -> u32 {
        for [a, b] in pairs.clone().filter(|pair| pair.iter().all(|&body| is_movable(body))) {
            self.sets.join(a, b);
        }
        let mut next = 0;
        for [a, b] in pairs {
            let root = self.sets.root(if is_movable(a) { a } else { b });
            if self.numbers[root as usize] == NONE {
                self.numbers[root as usize] = next;
                next += 1;
            }
        }
        next
    }

    /// The tree of a movable body that has pairs.
    fn number(&mut self, body: u32) -> u32 {
        let root = self.sets.root(body);
        self.numbers[root as usize]
    }

    fn number_if_any(&mut self, body: u32) -> Option<u32> {
        Some(self.number(body)).filter(|&number| number != NONE)
    }
}
