//! Islands of a bundle that go through the same substeps, and the lanes in which their pairs are.

use super::colors::{ALL_LANES, LANES};
use super::islands::Island;
use crate::simd::lanes::bits;
use std::ops::Range;

/// Some islands of a bundle. If the bundle has one, its pairs have all lanes; otherwise each island has its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<'a> {
    /// The islands of the bundle.
    islands: &'a [Island],
    /// The numbers of the group's islands within the bundle, as bits.
    members: u32,
}

impl<'a> Group<'a> {
    /// All islands of a bundle.
    pub fn all(islands: &'a [Island]) -> Self {
        Self {
            islands,
            members: (1 << islands.len()) - 1,
        }
    }

    /// The islands of this group with the same factor as the first, and the others.
    pub fn split(self, factors: &[u32; LANES]) -> (Self, Self) {
        let first = factors[self.members.trailing_zeros() as usize];
        let equal = bits(self.members).filter(|&island| factors[island] == first);
        let members = equal.fold(0, |members, island| members | 1 << island);
        let of = |members| Self { members, ..self };
        (of(members), of(self.members & !members))
    }

    pub fn is_empty(&self) -> bool {
        self.members == 0
    }

    /// Whether these are all islands of the bundle.
    pub fn is_whole(&self) -> bool {
        self.members.count_ones() as usize == self.islands.len()
    }

    /// The number of the first island within the bundle.
    pub fn first(&self) -> usize {
        self.members.trailing_zeros() as usize
    }

    /// Whether several islands are side by side in the bundle.
    pub fn is_side_by_side(&self) -> bool {
        self.islands.len() > 1
    }

    /// The number within the bundle of the island with the pairs in a lane.
    pub fn island(&self, lane: usize) -> usize {
        if self.is_side_by_side() { lane } else { 0 }
    }

    /// The lanes of the group's pairs.
    pub fn lanes(&self) -> u32 {
        if self.is_side_by_side() {
            self.members
        } else {
            ALL_LANES
        }
    }

    /// The slots of the group's bodies, within the bundle.
    pub fn slots(&self) -> impl Iterator<Item = Range<usize>> + use<'a> {
        let Self { islands, members } = *self;
        let start = islands.first().map_or(0, |island| island.slots.start);
        bits(members).map(move |island| {
            let slots = &islands[island].slots;
            slots.start - start..slots.end - start
        })
    }
}
