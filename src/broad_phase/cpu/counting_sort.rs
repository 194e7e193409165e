//! A parallel counting sort.

use crate::parallel::loops;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Minimum number of items per thread.
const MIN_ITEMS: usize = 2048;

/// The numbers `0..n` sorted by small keys. The order among equal keys depends on thread timing.
#[derive(Default)]
pub struct CountingSort {
    /// Start of each key's items, and the end of the last. The atomics let threads share the array; a relaxed load or
    /// store compiles to a plain move.
    starts: Vec<AtomicU32>,
    order: Vec<AtomicU32>,
}

impl CountingSort {
    /// Sorts by `keys`, which are all less than `limit`.
    pub fn sort(&mut self, limit: usize, keys: &[u32]) {
        // Clears the counts of the previous sort, whose size may differ.
        self.starts.truncate(limit + 1);
        loops::for_each(self.starts.par_iter_mut(), 8 * MIN_ITEMS, |start| *start.get_mut() = 0);
        self.starts.resize_with(limit + 1, AtomicU32::default);
        self.order.truncate(keys.len());
        self.order.resize_with(keys.len(), AtomicU32::default);
        let (starts, order) = (&self.starts, &self.order);
        loops::for_each(keys.par_iter(), MIN_ITEMS, |&key| {
            starts[key as usize + 1].fetch_add(1, Relaxed);
        });
        // Counts are shifted by one: once all items are placed, each entry has advanced to the start of the next key.
        let mut sum = 0;
        for start in &mut self.starts[1..] {
            let count = std::mem::replace(start.get_mut(), sum);
            sum += count;
        }
        let starts = &self.starts;
        let items = keys.par_iter().zip(0u32..keys.len() as u32);
        loops::for_each(items, MIN_ITEMS, |(&key, item)| {
            let at = starts[key as usize + 1].fetch_add(1, Relaxed);
            order[at as usize].store(item, Relaxed);
        });
    }

    /// The items in sorted order.
    pub fn order(&self) -> impl IndexedParallelIterator<Item = u32> + '_ {
        self.order.par_iter().map(|item| item.load(Relaxed))
    }

    /// Range of the sorted items whose keys lie from `first` to `last`.
    #[inline(always)]
    pub fn range(&self, first: u32, last: u32) -> Range<usize> {
        let at = |key: u32| self.starts[key as usize].load(Relaxed) as usize;
        at(first)..at(last + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_sorted_whatever_was_sorted_before() {
        let mut sort = CountingSort::default();
        let mut random = fastrand::Rng::with_seed(1);
        for (n, limit) in [(0, 1), (1, 1), (10_000, 300), (5, 70_000), (300, 4), (0, 9)] {
            let keys: Vec<u32> = (0..n).map(|_| random.u32(..limit)).collect();
            sort.sort(limit as usize, &keys);
            let order: Vec<u32> = sort.order().collect();
            assert!(order.is_sorted_by_key(|&item| keys[item as usize]));
            let mut items = order.clone();
            items.sort_unstable();
            assert!(items.into_iter().eq(0..n as u32));
            for key in 0..limit.min(50) {
                let of_key = order[sort.range(key, key)].iter();
                assert!(of_key.clone().all(|&item| keys[item as usize] == key));
                assert_eq!(of_key.len(), keys.iter().filter(|&&k| k == key).count());
            }
        }
    }
}
