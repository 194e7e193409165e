//! In how many batches contact points are made of the pairs.
//!
//! A pair needs most of its memory between the search for near triangles and its contact points, and nothing of it afterwards.
//! So batches of pairs follow each other in the same lists: those of [`ContactScratch`]. Each batch takes as many dispatches as
//! all pairs would at once, so there is one batch unless the lists become very long.
//!
//! The rule: as many batches as [`BatchSize::bytes`] fit into the scratch memory that all pairs would take at once, rounded up.
//! What they would take does not depend on the number of batches, and lists of some hundred steps must do with half as many
//! before there are fewer, so the number does not go back and forth. A pair that takes more than a batch should makes the
//! lists longer, and not the batches more: it may be the only one. But if a list were longer than the device allows, there are
//! twice as many batches, and again, before that is an error.
//!
//! Batches are interleaved: see `shaders/manifolds/batches.wgsl`. The results do not depend on their number.

use super::buffers::{ContactCapacity, ContactScratch};
use crate::gpu::buffers::longest_list;
use crate::gpu::device::Gpu;
use crate::gpu::layout::{
    ALL_FEATURES, ALL_NEAR_TRIANGLES, ALL_PIECES, ALL_SEGMENTS, CONTACT_PAIRS, CONTACT_POINTS, CONTACT_SLOTS,
    MARGIN_PAIRS, MOST_FEATURES, MOST_NEAR_TRIANGLES, MOST_PIECES, MOST_SEGMENTS, STAGED_POINTS,
};

/// How much memory a batch should take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BatchSize {
    /// Of all its lists, bytes.
    pub bytes: u64,
    /// Of its longest list at most, bytes.
    pub longest: u64,
}

/// Of all lists of a batch, bytes. A batch of convex or small bodies has hundreds of thousands of pairs then, which keep any
/// card busy.
const BYTES: u64 = 256 << 20;

/// More batches do not help: some pair is too large, and the programs of a step become long.
const MAX_BATCHES: u32 = 256;

impl BatchSize {
    /// For a device. Of one that binds little memory a batch takes half, because some lists have room to spare.
    pub fn of(gpu: &Gpu) -> Self {
        let longest = longest_list(gpu);
        Self {
            bytes: BYTES.min(longest / 2),
            longest,
        }
    }

    /// The capacity that a run in `batches` batches needed, by its counters, and the number of batches that it should have
    /// had. The lists are those of its own batches.
    pub fn needed(&self, counters: &[u32], batches: u32) -> ContactCapacity {
        let of = |counter: u32| counters[counter as usize];
        let most = ContactCapacity {
            batches,
            margin_pairs: 0,
            slots: of(CONTACT_SLOTS),
            near_triangles: of(MOST_NEAR_TRIANGLES),
            pieces: of(MOST_PIECES),
            features: of(MOST_FEATURES),
            segments: of(MOST_SEGMENTS),
            staged_points: of(STAGED_POINTS),
            pairs: of(CONTACT_PAIRS),
            points: of(CONTACT_POINTS),
        };
        let at_once = ContactCapacity {
            margin_pairs: of(MARGIN_PAIRS),
            near_triangles: of(ALL_NEAR_TRIANGLES),
            pieces: of(ALL_PIECES),
            features: of(ALL_FEATURES),
            segments: of(ALL_SEGMENTS),
            ..ContactCapacity::default()
        };
        let mut wanted = self.batches_of(&at_once);
        while wanted < MAX_BATCHES.min(at_once.margin_pairs) && !self.is_bound(&most.in_batches(wanted)) {
            wanted *= 2;
        }
        ContactCapacity {
            batches: wanted,
            ..most
        }
    }

    /// The number of batches for pairs that would take these lists at once.
    pub fn batches_of(&self, at_once: &ContactCapacity) -> u32 {
        let bytes: u64 = ContactScratch::sizes(at_once).iter().map(|&(_, size)| size).sum();
        bytes.div_ceil(self.bytes.max(1)).clamp(1, MAX_BATCHES.into()) as u32
    }

    /// Whether the device holds lists that have grown to this need.
    fn is_bound(&self, needed: &ContactCapacity) -> bool {
        let grown = ContactCapacity::default().grown(*needed);
        ContactScratch::sizes(&grown)
            .iter()
            .all(|&(_, size)| size <= self.longest)
    }
}
