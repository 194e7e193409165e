//! Colours of an island's pairs: pairs of one colour have no body in common that impulses move, so they can be solved
//! at once, in the lanes of batches.
//!
//! Pairs with a body that impulses do not move have their own colours, which come last: first pairs with a moving one,
//! then pairs with one that does not move. What is solved last is satisfied best, and nothing may be pressed through
//! static bodies.

use super::islands::IslandPair;
use crate::geometry::cluster::CLUSTER;
use std::cmp::Reverse;

/// The most pairs of a batch: one in each lane.
pub(super) const LANES: usize = CLUSTER;
/// The set of all lanes.
pub(super) const ALL_LANES: u32 = (1 << LANES) - 1;
/// Colours that a body keeps account of, in the bits of a word.
const COLORS: u32 = u64::BITS;

/// The size of a batch: pairs of one colour that are solved at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BatchSize {
    /// Number of pairs.
    pub pairs: u32,
    /// The most points that one of its pairs has.
    pub points: u32,
    /// The sum of the points of its pairs.
    pub all_points: u32,
}

impl BatchSize {
    /// The size of a batch of these pairs.
    pub fn of(pairs: &[IslandPair], points_of: impl Fn(&IslandPair) -> u32) -> Self {
        let points = || pairs.iter().map(&points_of);
        Self {
            pairs: pairs.len() as u32,
            points: points().max().unwrap_or(0),
            all_points: points().sum(),
        }
    }
}

/// Colours pairs. It holds only scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Colors {
    /// The colours of the pairs of each body that impulses move.
    used: Vec<u64>,
    /// Sorted by colour, pairs with more points first.
    pairs: Vec<Colored>,
}

#[derive(Clone, Copy, Debug)]
struct Colored {
    color: u32,
    points: u32,
    pair: IslandPair,
}

impl Colors {
    /// Sorts the pairs of an island by batches, and adds the batches' sizes. Impulses move the bodies of the first
    /// `movable` slots. `points_of` tells the number of points of a pair.
    pub fn sort(
        &mut self,
        pairs: &mut [IslandPair],
        movable: u32,
        points_of: impl Fn(&IslandPair) -> u32,
        batches: &mut Vec<BatchSize>,
    ) {
        self.used.clear();
        self.used.resize(movable as usize, 0);
        self.pairs.clear();
        let group_of = |pair: &IslandPair| match pair.slots.into_iter().all(|slot| slot < movable) {
            true => 0,
            false => 1 + u32::from(pair.is_fixed),
        };
        let mut first = 0;
        for group in 0..3 {
            self.used.fill(0);
            let mut end = first;
            for pair in pairs.iter().filter(|pair| group_of(pair) == group) {
                let color = first + self.free_color(pair.slots, end - first);
                end = end.max(color + 1);
                self.pairs.push(Colored {
                    color,
                    points: points_of(pair),
                    pair: *pair,
                });
            }
            first = end;
        }
        self.pairs
            .sort_unstable_by_key(|it| (it.color, Reverse(it.points), it.pair.number));
        for (pair, colored) in pairs.iter_mut().zip(&self.pairs) {
            *pair = colored.pair;
        }
        let mut rest = &*pairs;
        for same in self.pairs.chunk_by(|a, b| a.color == b.color) {
            let own;
            (own, rest) = rest.split_at(same.len());
            batches.extend(own.chunks(LANES).map(|batch| BatchSize::of(batch, &points_of)));
        }
    }

    /// The first colour that no other pair of these bodies has. If they have all recorded colours, a new one after the
    /// `known` ones, for this pair alone.
    fn free_color(&mut self, slots: [u32; 2], known: u32) -> u32 {
        let used = slots.map(|slot| self.used.get(slot as usize).copied().unwrap_or(0));
        let color = (!(used[0] | used[1])).trailing_zeros();
        if color == COLORS {
            return known.max(COLORS);
        }
        for slot in slots {
            if let Some(used) = self.used.get_mut(slot as usize) {
                *used |= 1 << color;
            }
        }
        color
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sorts pairs of the slots 0 to `movable`, and of others. Each has as many points as its number modulo 5, plus
    /// one.
    fn sorted(slots: &[[u32; 2]], movable: u32) -> (Vec<IslandPair>, Vec<BatchSize>) {
        let pairs = (0..).zip(slots);
        let pair = |(number, &slots): (u32, &[u32; 2])| IslandPair {
            number,
            slots,
            is_fixed: number % 3 == 0,
        };
        let mut pairs: Vec<IslandPair> = pairs.map(pair).collect();
        let mut sizes = Vec::new();
        Colors::default().sort(&mut pairs, movable, |pair| pair.number % 5 + 1, &mut sizes);
        (pairs, sizes)
    }

    /// Requires that every pair is in one batch, that no batch moves a body twice, and that pairs with a body that does
    /// not move come last.
    fn check(slots: &[[u32; 2]], movable: u32) -> Vec<BatchSize> {
        let (pairs, sizes) = sorted(slots, movable);
        let mut numbers: Vec<u32> = pairs.iter().map(|pair| pair.number).collect();
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..slots.len() as u32));
        let mut rest = &pairs[..];
        for size in &sizes {
            let (batch, others) = rest.split_at(size.pairs as usize);
            rest = others;
            assert!((1..=LANES).contains(&batch.len()));
            let points = || batch.iter().map(|pair| pair.number % 5 + 1);
            assert_eq!(Some(size.points), points().max());
            assert_eq!(size.all_points, points().sum::<u32>());
            let mut moved: Vec<u32> = batch
                .iter()
                .flat_map(|pair| pair.slots)
                .filter(|&slot| slot < movable)
                .collect();
            let count = moved.len();
            moved.sort_unstable();
            moved.dedup();
            assert_eq!(moved.len(), count, "{batch:?}");
        }
        assert!(rest.is_empty());
        let group = |pair: &IslandPair| {
            let is_last = pair.slots.into_iter().any(|slot| slot >= movable);
            (is_last, is_last && pair.is_fixed)
        };
        assert!(pairs.is_sorted_by_key(group));
        sizes
    }

    #[test]
    fn a_tower_has_two_colors_and_one_for_the_floor() {
        let tower: Vec<[u32; 2]> = (0..10).map(|i| [i, i + 1]).collect();
        let sizes = check(&tower, 10);
        assert_eq!(sizes.iter().map(|size| size.pairs).collect::<Vec<_>>(), [5, 4, 1]);
    }

    #[test]
    fn a_body_with_many_pairs_has_a_color_for_each() {
        let star: Vec<[u32; 2]> = (0..200).map(|i| [200, i]).collect();
        assert_eq!(check(&star, 201).len(), 200);
        let two_colors = 67usize.div_ceil(LANES) + 133usize.div_ceil(LANES);
        assert_eq!(
            check(&star, 200).len(),
            two_colors,
            "what impulses do not move connects nothing"
        );
    }

    #[test]
    fn any_pairs_are_sorted_into_batches() {
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..100 {
            let (count, movable) = (random.usize(1..150), random.u32(2..40));
            let pairs: Vec<[u32; 2]> = (0..count)
                .map(|_| {
                    let a = random.u32(..movable);
                    [a, (a + random.u32(1..movable + 2)) % (movable + 2)]
                })
                .collect();
            check(&pairs, movable);
        }
    }
}
