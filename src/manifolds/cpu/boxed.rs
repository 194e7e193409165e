//! A list of pairs of triangles whose boxes are near. It is filled without branches: processors mispredict those of few
//! pairs at a time.

use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::each_lane;

/// Pairs of triangles, as lanes of clusters: eight times the index of the cluster plus the lane.
#[derive(Default)]
pub struct BoxedPairs {
    /// What follows the pairs has no meaning.
    slots: Vec<[u32; 2]>,
    count: usize,
}

/// The list is full when it has so many pairs.
const FULL: usize = 256;
/// The pairs of two clusters, which are added to a list that is not full.
const ROOM: usize = CLUSTER * CLUSTER;

/// The lanes of each set of lanes, ascending, and then others.
const LANES: [[u8; CLUSTER]; 256] = {
    let mut all = [[0; CLUSTER]; 256];
    let mut set = 0;
    while set < all.len() {
        let (mut lane, mut count) = (0, 0);
        while lane < CLUSTER {
            if set >> lane & 1 == 1 {
                all[set][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    all
};

impl BoxedPairs {
    /// Removes all pairs.
    pub fn clear(&mut self) {
        self.count = 0;
        self.slots.resize(FULL + ROOM, [0; 2]);
    }

    /// Adds the pairs of a triangle with the triangles in these lanes of a cluster whose lane 0 is `second`.
    #[inline(always)]
    pub fn add(&mut self, first: u32, second: u32, lanes: u32) {
        let set = lanes as usize % LANES.len();
        let eight = self.slots[self.count..].first_chunk_mut().expect("room for a cluster");
        *eight = each_lane(|k| [first, second + u32::from(LANES[set][k])]);
        self.count += lanes.count_ones() as usize;
    }

    /// The pairs.
    pub fn all(&self) -> &[[u32; 2]] {
        &self.slots[..self.count]
    }

    /// Calls `take` with whole groups of eight of the pairs if the list is full, and removes them.
    #[inline(always)]
    pub fn take_if_full(&mut self, take: impl FnOnce(&[[u32; 2]])) {
        if self.count < FULL {
            return;
        }
        let whole = self.count / CLUSTER * CLUSTER;
        take(&self.slots[..whole]);
        self.slots.copy_within(whole..self.count, 0);
        self.count -= whole;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_is_taken_once_in_order() {
        let mut random = fastrand::Rng::with_seed(2);
        let (mut added, mut taken) = (Vec::new(), Vec::new());
        let mut boxed = BoxedPairs::default();
        boxed.clear();
        for second in 0..500 {
            for first in 0..8 {
                let lanes = random.u32(..256) & random.u32(..256);
                boxed.add(first, 8 * second, lanes);
                added.extend(
                    (0..8)
                        .filter(|lane| lanes >> lane & 1 == 1)
                        .map(|lane| [first, 8 * second + lane]),
                );
            }
            boxed.take_if_full(|pairs| {
                assert_eq!(pairs.len() % 8, 0);
                taken.extend_from_slice(pairs);
            });
        }
        assert!(taken.len() > 5000 && boxed.all().len() < FULL);
        taken.extend_from_slice(boxed.all());
        assert_eq!(added, taken);
    }
}
