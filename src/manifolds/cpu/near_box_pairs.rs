//! A list of pairs of triangles whose boxes are near. It is filled without branches, because processors mispredict
//! branches over few pairs at a time.

use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{each_lane, push_some, set_lanes};

/// Pairs of triangles, as lanes of clusters: eight times the index of the cluster plus the lane.
#[derive(Default)]
pub struct NearBoxPairs(Vec<[u32; 2]>);

/// Number of pairs at which the list is full.
const FULL: usize = 256;

impl NearBoxPairs {
    /// Removes all pairs.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds the pairs of a triangle with the triangles in these lanes of a cluster whose lane 0 is `second`.
    #[inline(always)]
    pub fn add(&mut self, first: u32, second: u32, lanes: u32) {
        let others = set_lanes(lanes);
        let eight = each_lane(|k| [first, second + u32::from(others[k])]);
        push_some(&mut self.0, eight, lanes);
    }

    /// The pairs.
    pub fn all(&self) -> &[[u32; 2]] {
        &self.0
    }

    /// Calls `take` with whole groups of eight of the pairs if the list is full, and removes them.
    #[inline(always)]
    pub fn take_if_full(&mut self, take: impl FnOnce(&[[u32; 2]])) {
        if self.0.len() < FULL {
            return;
        }
        let whole = self.0.len() / CLUSTER * CLUSTER;
        take(&self.0[..whole]);
        self.0.drain(..whole);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_is_taken_once_in_order() {
        let mut random = fastrand::Rng::with_seed(2);
        let (mut added, mut taken) = (Vec::new(), Vec::new());
        let mut box_pairs = NearBoxPairs::default();
        for second in 0..500 {
            for first in 0..8 {
                let lanes = random.u32(..256) & random.u32(..256);
                box_pairs.add(first, 8 * second, lanes);
                added.extend(
                    (0..8)
                        .filter(|lane| lanes >> lane & 1 == 1)
                        .map(|lane| [first, 8 * second + lane]),
                );
            }
            box_pairs.take_if_full(|pairs| {
                assert_eq!(pairs.len() % 8, 0);
                taken.extend_from_slice(pairs);
            });
        }
        assert!(taken.len() > 5000 && box_pairs.all().len() < FULL);
        taken.extend_from_slice(box_pairs.all());
        assert_eq!(added, taken);
    }
}
