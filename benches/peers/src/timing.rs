//! Clocks, medians, and a loop that shows what a second thread is worth on this machine.

use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// Seconds that `work` takes, and what it returns.
pub fn time<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// The middle value; NaN of none.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// How many times longer `slow` took than `fast`: the median of the ratios of each round, so that a machine that slows
/// down for a while slows down both ends of a ratio.
pub fn ratio(slow: &[f64], fast: &[f64]) -> f64 {
    median(slow.iter().zip(fast).map(|(slow, fast)| slow / fast))
}

/// A pool of `threads`.
pub fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads to work on")
}

/// Arithmetic in registers, in equal pieces: it needs no memory and waits for nothing, so that two threads halve its
/// time as far as the machine has two cores to give.
pub fn control() {
    (0..64_u32).into_par_iter().for_each(|piece| {
        let mut x = piece + 1;
        for _ in 0..200_000 {
            x ^= x << 13;
            x ^= x >> 17;
            x ^= x << 5;
        }
        black_box(x);
    });
}
