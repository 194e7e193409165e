//! The number of batches in which pairs get their contact points.
//!
//! A pair needs most of its memory between the search for near triangles and its contact points, and nothing of it
//! afterwards. So batches of pairs follow each other in the same lists: those of [`ContactScratch`]. Each batch takes
//! as many dispatches as all pairs would at once, so there is one batch unless the lists become very long.
//!
//! The rule: as many batches as [`BatchSize::bytes`] fit into the scratch memory that all pairs would take at once,
//! rounded up. There are more when a list of a batch is too short, and fewer when half as many would have done for
//! hundreds of steps. What all pairs would take does not depend on the number of batches, so the number does not go
//! back and forth.
//!
//! A pair that takes more than a batch should makes the lists longer instead of adding batches, because it would be as
//! large in any batch. Only if a list would be longer than the device allows, the number of batches is doubled,
//! repeatedly, before that is an error: the list may hold several pairs.
//!
//! Batches are interleaved: see `shaders/manifolds/batches.wgsl`. The results do not depend on their number.

use super::buffers::{ContactCapacity, ContactScratch};
use crate::gpu::buffers::longest_list;
use crate::gpu::device::Gpu;
use crate::gpu::layout::{
    CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS, MARGIN_PAIRS, MAX_FEATURES, MAX_NEAR_PIECES, MAX_NEAR_TRIANGLES,
    MAX_SEGMENTS, STAGED_POINTS, TOTAL_FEATURES, TOTAL_NEAR_PIECES, TOTAL_NEAR_TRIANGLES, TOTAL_SEGMENTS,
};

/// How much memory a batch should take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BatchSize {
    /// Size of all its lists, bytes.
    pub bytes: u64,
    /// Largest size of one list, bytes.
    pub longest: u64,
}

/// Size of all lists of a batch, bytes. A batch of tori of 240 triangles has some 40,000 pairs then, with a workgroup
/// each: several times what a GPU runs at once.
const BYTES: u64 = 256 << 20;

/// With more, the program of a step becomes long, and its dispatches short.
const MAX_BATCHES: u32 = 256;

impl BatchSize {
    /// For a device.
    pub fn of(gpu: &Gpu) -> Self {
        Self::with_longest(longest_list(gpu))
    }

    /// The size for a device that binds lists of up to `longest` bytes. A batch takes no more than half of that,
    /// because lists have some room to spare.
    pub fn with_longest(longest: u64) -> Self {
        Self {
            bytes: BYTES.min(longest / 2),
            longest,
        }
    }

    /// The capacity that a run in `batches` batches needed, by its counters, and the number of batches that it should
    /// have had. The lists are those of its own batches.
    pub fn needed(&self, counters: &[u32], batches: u32) -> ContactCapacity {
        let of = |counter: u32| counters[counter as usize];
        let fullest = ContactCapacity {
            batches,
            margin_pairs: 0,
            slots: of(CONTACT_SLOTS),
            near_triangles: of(MAX_NEAR_TRIANGLES),
            pieces: of(MAX_NEAR_PIECES),
            features: of(MAX_FEATURES),
            segments: of(MAX_SEGMENTS),
            staged_points: of(STAGED_POINTS),
            pairs: of(CONTACT_PAIRS),
            points: of(CONTACT_POINTS),
        };
        let at_once = ContactCapacity {
            margin_pairs: of(MARGIN_PAIRS),
            near_triangles: of(TOTAL_NEAR_TRIANGLES),
            pieces: of(TOTAL_NEAR_PIECES),
            features: of(TOTAL_FEATURES),
            segments: of(TOTAL_SEGMENTS),
            ..ContactCapacity::default()
        };
        let mut wanted = self.batches_of(&at_once);
        let limit = max_batches(&at_once);
        while wanted < limit && !self.is_bound(&fullest.in_batches(wanted)) {
            wanted = (2 * wanted).min(limit);
        }
        ContactCapacity {
            batches: wanted,
            ..fullest
        }
    }

    /// The number of batches for pairs that would take these lists at once.
    pub fn batches_of(&self, at_once: &ContactCapacity) -> u32 {
        let bytes: u64 = ContactScratch::sizes(at_once).iter().map(|&(_, size)| size).sum();
        bytes.div_ceil(self.bytes.max(1)).clamp(1, max_batches(at_once).into()) as u32
    }

    /// Whether the device holds lists that have grown to this need.
    fn is_bound(&self, needed: &ContactCapacity) -> bool {
        let no_room = ContactCapacity {
            batches: needed.batches,
            ..ContactCapacity::default()
        };
        let grown = no_room.grown(*needed);
        ContactScratch::sizes(&grown)
            .iter()
            .all(|&(_, size)| size <= self.longest)
    }
}

/// More batches of these pairs would be of no use.
fn max_batches(at_once: &ContactCapacity) -> u32 {
    at_once.margin_pairs.clamp(1, MAX_BATCHES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::buffers::grow;
    use crate::gpu::layout::CONTACT_COUNTERS;

    const SIZE: BatchSize = BatchSize {
        bytes: 16 << 20,
        longest: 64 << 20,
    };

    /// The counters of a run in batches whose pairs have so many near triangles in all, and in the fullest batch.
    fn counters(pairs: u32, all: u32, most: u32) -> [u32; CONTACT_COUNTERS as usize] {
        let mut counters = [0; CONTACT_COUNTERS as usize];
        counters[MARGIN_PAIRS as usize] = pairs;
        counters[TOTAL_NEAR_TRIANGLES as usize] = all;
        counters[MAX_NEAR_TRIANGLES as usize] = most;
        counters
    }

    /// Near triangles that take so many bytes.
    fn taking(megabytes: u32) -> u32 {
        megabytes << 16
    }

    #[test]
    fn there_are_as_many_batches_as_fit_into_what_all_pairs_take() {
        let batches = |pairs, megabytes| {
            let all = taking(megabytes);
            SIZE.needed(&counters(pairs, all, all), 1).batches
        };
        assert_eq!([batches(0, 0), batches(1, 15), batches(100, 15)], [1, 1, 1]);
        assert_eq!([batches(100, 16), batches(100, 31), batches(100, 47)], [2, 2, 3]);
        // Poses of pairs take memory too.
        assert_eq!(batches(180_000, 0), 3);
        assert_eq!(batches(u32::MAX, 4000), MAX_BATCHES);
    }

    #[test]
    fn a_number_of_batches_that_was_right_stays_so() {
        for all in (10..200).map(taking) {
            let wanted = SIZE.needed(&counters(1000, all, all), 1).batches;
            for batches in [wanted, wanted / 2 + 1, 2 * wanted] {
                let again = SIZE.needed(&counters(1000, all, all / batches + 1), batches);
                assert_eq!((again.batches, again.near_triangles), (wanted, all / batches + 1));
            }
        }
    }

    #[test]
    fn a_large_pair_makes_longer_lists_and_more_batches_only_where_the_device_refuses_them() {
        let of = |most, batches| SIZE.needed(&counters(1000, taking(100), taking(most)), batches).batches;
        assert_eq!([of(100, 1), of(40, 7), of(50, 7)], [7, 7, 7]);
        assert_eq!([of(60, 7), of(60, 14), of(60, 28)], [14, 28, 56]);
        // What did not fit into fewer batches is not tried again.
        assert_eq!([of(50, 14), of(30, 14), of(20, 14)], [14, 14, 7]);
        assert_eq!(of(60, MAX_BATCHES), MAX_BATCHES);
        let two_pairs = SIZE.needed(&counters(2, taking(100), taking(60)), 2);
        assert_eq!(two_pairs.batches, 2);
    }

    #[test]
    fn lists_of_more_batches_are_shorter() {
        let has = ContactCapacity::default().grown(ContactCapacity {
            near_triangles: 1000,
            features: 10,
            ..ContactCapacity::default()
        });
        let needed = ContactCapacity {
            batches: 4,
            near_triangles: 10_000,
            features: 10,
            pairs: 3,
            ..ContactCapacity::default()
        };
        let grown = has.grown(needed);
        assert_eq!((grown.batches, grown.near_triangles), (4, grow(0, 2500)));
        assert_eq!((grown.features, grown.pairs), (has.in_batches(4).features, grow(0, 3)));
        // Whatever its number of batches should be, lists that suffice stay.
        let enough = ContactCapacity {
            near_triangles: 1000,
            ..needed
        };
        assert_eq!(has.grown(enough).batches, 1);
        assert_eq!(grown.grown(grown), grown);
        // In four batches the same is too long again.
        let again = grown.grown(ContactCapacity {
            near_triangles: 4000,
            ..needed
        });
        assert_eq!((again.batches, again.near_triangles), (4, grow(0, 4000)));
    }
}
