//! Bundles: sets of islands that one task solves, batch by batch.
//!
//! The pairs of a large island fill the lanes of its batches: see [`colors`](super::colors). A small island has few
//! pairs of one colour, often only one. So up to eight small islands are solved side by side, each in its own lane,
//! with its pairs in the same order. The result has the same bits either way.

use super::colors::{BatchSize, Colors, LANES};
use super::islands::{Island, IslandPair};
use std::ops::Range;

/// Islands with more pairs are not solved side by side: each is enough work for a thread.
const MAX_PAIRS: usize = 16;

/// Islands that are solved together, and their parts of the lists.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bundle {
    /// Several if they are side by side.
    pub islands: Range<usize>,
    pub slots: Range<usize>,
    pub pairs: Range<usize>,
    pub batches: Range<usize>,
}

/// All bundles. It holds only scratch memory besides.
#[derive(Clone, Debug, Default)]
pub(super) struct Bundles {
    pub list: Vec<Bundle>,
    /// The sizes of their batches, in order.
    pub batches: Vec<BatchSize>,
    colors: Colors,
    alone: SeparateBatches,
    sorted: Vec<IslandPair>,
}

/// The batches that each island would have alone.
#[derive(Clone, Debug, Default)]
struct SeparateBatches {
    sizes: Vec<BatchSize>,
    /// Where the pairs of each island end.
    ends: Vec<usize>,
}

impl Bundles {
    /// Sorts islands into bundles, and their pairs by the bundles' batches. Islands that can be side by side must be
    /// contiguous, with more pairs first.
    pub fn build(&mut self, islands: &[Island], pairs: &mut [IslandPair], points_of: impl Fn(&IslandPair) -> u32) {
        let Self { colors, alone, .. } = self;
        alone.sizes.clear();
        alone.ends.clear();
        for Island {
            movable, pairs: own, ..
        } in islands
        {
            colors.sort(&mut pairs[own.clone()], *movable, &points_of, &mut alone.sizes);
            alone.ends.push(alone.sizes.len());
        }
        self.list.clear();
        self.batches.clear();
        let mut first = 0;
        while first < islands.len() {
            let count = self.side_by_side(first, islands, pairs, &points_of);
            let own = &islands[first..first + count];
            let start = self.batches.len();
            if count == 1 {
                self.batches.extend_from_slice(self.alone.of(first..first + 1));
            } else {
                self.interleave(own, pairs, &points_of);
            }
            let last = &own[count - 1];
            self.list.push(Bundle {
                islands: first..first + count,
                slots: own[0].slots.start..last.slots.end,
                pairs: own[0].pairs.start..last.pairs.end,
                batches: start..self.batches.len(),
            });
            first += count;
        }
    }

    /// How many islands from `first` on are solved side by side: up to one per lane, if that is less than half of the
    /// work of solving each alone.
    fn side_by_side(
        &self,
        first: usize,
        islands: &[Island],
        pairs: &[IslandPair],
        points_of: impl Fn(&IslandPair) -> u32,
    ) -> usize {
        let pace = islands[first].pace;
        let is_small = |island: &&Island| (1..=MAX_PAIRS).contains(&island.pairs.len()) && island.pace == pace;
        let count = islands[first..].iter().take(LANES).take_while(is_small).count();
        let own = &islands[first..first + count];
        let alone: u32 = self
            .alone
            .of(first..first + count)
            .iter()
            .map(|batch| batch.points)
            .sum();
        let together: u32 = rows(own)
            .map(|row| row.map(|(_, pair)| points_of(&pairs[pair])).max().unwrap_or(0))
            .sum();
        if 2 * together < alone { count } else { 1 }
    }

    /// Sorts the pairs of islands side by side: first the first pair of each, and so on.
    fn interleave(&mut self, islands: &[Island], pairs: &mut [IslandPair], points_of: impl Fn(&IslandPair) -> u32) {
        let Island { slots, pairs: own, .. } = &islands[0];
        self.sorted.clear();
        for row in rows(islands) {
            let start = self.sorted.len();
            self.sorted.extend(row.map(|(island, pair)| {
                let before = (island.slots.start - slots.start) as u32;
                let own = pairs[pair];
                IslandPair {
                    slots: own.slots.map(|slot| before + slot),
                    ..own
                }
            }));
            self.batches.push(BatchSize::of(&self.sorted[start..], &points_of));
        }
        pairs[own.start..own.start + self.sorted.len()].copy_from_slice(&self.sorted);
    }
}

impl SeparateBatches {
    /// The batches of some islands.
    fn of(&self, islands: Range<usize>) -> &[BatchSize] {
        let end_of = |count: usize| if count == 0 { 0 } else { self.ends[count - 1] };
        &self.sizes[end_of(islands.start)..end_of(islands.end)]
    }
}

/// For each batch of islands side by side: the islands with a pair in it, and the pairs' numbers. The first island has
/// most pairs.
fn rows(islands: &[Island]) -> impl Iterator<Item = impl Iterator<Item = (&Island, usize)>> {
    let most = islands.first().map_or(0, |island| island.pairs.len());
    (0..most).map(move |row| {
        let with_pair = islands.iter().take_while(move |island| row < island.pairs.len());
        with_pair.map(move |island| (island, island.pairs.start + row))
    })
}

#[cfg(test)]
mod tests {
    use super::super::pace::Pace;
    use super::*;

    /// Islands with chains of these `lengths`. Each pair has its number modulo 5, plus one, points.
    fn chains(lengths: &[usize], paces: &[Pace]) -> (Vec<Island>, Vec<IslandPair>) {
        let (mut islands, mut pairs) = (Vec::new(), Vec::new());
        let mut slots = 0;
        for (i, &length) in lengths.iter().enumerate() {
            let start = pairs.len();
            pairs.extend((0..length as u32).map(|k| IslandPair {
                number: start as u32 + k,
                slots: [k, k + 1],
                is_fixed: false,
            }));
            islands.push(Island {
                slots: slots..slots + length + 1,
                movable: length as u32 + 1,
                pairs: start..pairs.len(),
                pace: paces[i % paces.len()],
            });
            slots += length + 1;
        }
        (islands, pairs)
    }

    const PACE: Pace = Pace { dt: 0.01, substeps: 4 };

    fn points_of(pair: &IslandPair) -> u32 {
        pair.number % 5 + 1
    }

    fn build(lengths: &[usize], paces: &[Pace]) -> (Bundles, Vec<Island>, Vec<IslandPair>) {
        let (islands, mut pairs) = chains(lengths, paces);
        let mut bundles = Bundles::default();
        bundles.build(&islands, &mut pairs, points_of);
        (bundles, islands, pairs)
    }

    fn counts(bundles: &Bundles) -> Vec<usize> {
        bundles.list.iter().map(|bundle| bundle.islands.len()).collect()
    }

    #[test]
    fn small_islands_are_side_by_side_and_large_ones_alone() {
        let (bundles, ..) = build(&[100, 20, 3, 3, 3, 3, 2, 2, 1, 1, 1, 1, 1, 1, 1, 0, 0], &[PACE]);
        assert_eq!(counts(&bundles), [1, 1, 8, 5, 1, 1]);
        let (bundles, ..) = build(&[16, 1], &[PACE]);
        assert_eq!(counts(&bundles), [1, 1], "one lane would wait for the other");
        let other = Pace { dt: 0.02, ..PACE };
        let paces: Vec<Pace> = (0..12).map(|i| if i < 6 { PACE } else { other }).collect();
        let (bundles, ..) = build(&[1; 12], &paces);
        assert_eq!(counts(&bundles), [6, 6]);
    }

    #[test]
    fn islands_side_by_side_keep_their_lanes_and_the_order_of_their_pairs() {
        let lengths = [5, 4, 4, 3, 3, 2, 1, 1, 1];
        let (bundles, islands, pairs) = build(&lengths, &[PACE]);
        assert_eq!(counts(&bundles), [8, 1]);
        let (mut alone, mut expected) = chains(&lengths, &[PACE]);
        for island in &mut alone {
            let own = &mut expected[island.pairs.clone()];
            Colors::default().sort(own, island.movable, points_of, &mut Vec::new());
        }
        let mut found = vec![Vec::new(); 8];
        let mut rest = &pairs[bundles.list[0].pairs.clone()];
        for size in &bundles.batches[bundles.list[0].batches.clone()] {
            let own;
            (own, rest) = rest.split_at(size.pairs as usize);
            assert_eq!(*size, BatchSize::of(own, points_of));
            for (lane, pair) in own.iter().enumerate() {
                found[lane].push((pair.number, pair.slots.map(|slot| slot as usize)));
            }
        }
        assert!(rest.is_empty());
        for (island, found) in islands.iter().zip(found) {
            let own = &expected[island.pairs.clone()];
            let expected = own.iter().map(|pair| {
                let slots = pair.slots.map(|slot| island.slots.start + slot as usize);
                (pair.number, slots)
            });
            assert!(expected.eq(found));
        }
    }
}
