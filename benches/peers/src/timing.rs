//! Clocks, medians, and a control loop that measures the gain from a second thread on this machine.

use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// The time of `work` in seconds, and its result.
pub fn time<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// The median; NaN if there are no values.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The ratio of the times of `slow` and `fast`: the median over the ratios of each round. If the machine is slow for a
/// while, that affects both times of a ratio.
pub fn ratio(slow: &[f64], fast: &[f64]) -> f64 {
    median(slow.iter().zip(fast).map(|(slow, fast)| slow / fast))
}

/// A pool with `threads` threads.
pub fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads to work on")
}

/// Arithmetic in registers, in equal pieces. It uses no memory and never waits, so two threads halve its time if the
/// machine really has two free cores.
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
