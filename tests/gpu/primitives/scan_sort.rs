//! Scan and sort on the device against the standard library's.

use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::testing::gpu_primitives::{exclusive_scan, sort};

/// Around the workgroup, the block of a scan and that of a sort, and the longest lists of one workgroup; several rounds
/// of a scan's second pass.
const SIZES: [usize; 21] = [
    0, 1, 2, 255, 256, 257, 1023, 1024, 1025, 2047, 2048, 2049, 4095, 4096, 4097, 16_383, 16_384, 16_385, 70_001,
    300_000, 1_000_000,
];

/// What a list of this length may grow to: itself, so that one workgroup handles short lists, and a long list, for
/// which it takes many.
fn longest(length: usize) -> [u32; 2] {
    [length as u32, 1_000_000]
}

fn random(count: usize, bits: u32, seed: u64) -> Vec<u32> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..count).map(|_| random.u32(..) >> (32 - bits)).collect()
}

fn check_scan(gpu: &Gpu, values: &[u32]) {
    for at_most in longest(values.len()) {
        check_scan_of(gpu, values, at_most);
    }
}

fn check_scan_of(gpu: &Gpu, values: &[u32], at_most: u32) {
    let (before, total) = exclusive_scan(gpu, values, at_most).unwrap();
    let mut sum = 0u64;
    let expected = values.iter().map(|value| {
        let before = sum as u32;
        sum += u64::from(*value);
        before
    });
    let expected: Vec<u32> = expected.collect();
    // Not `assert_eq`, which would print a million numbers.
    let wrong = (0..values.len()).find(|&i| expected[i] != before[i]);
    assert_eq!(wrong, None, "of {} values", values.len());
    let total_expected = u32::try_from(sum).unwrap_or(u32::MAX);
    assert_eq!(
        (before.len(), total),
        (values.len(), total_expected),
        "of {} values",
        values.len()
    );
}

pub fn scans(gpu: &Gpu) {
    for count in SIZES {
        check_scan(gpu, &random(count, 12, count as u64));
        check_scan(gpu, &vec![1; count]);
        check_scan(gpu, &vec![0; count]);
    }
    // One value alone, at the ends of blocks.
    for at in [0, 1023, 1024, 262_143, 262_144, 299_999] {
        let mut values = vec![0; 300_000];
        values[at] = 7;
        check_scan(gpu, &values);
    }
}

/// Sums wrap as words do, but not the total: no list is taken to be long enough for more than can be counted.
pub fn a_total_beyond_a_word_is_the_largest(gpu: &Gpu) {
    check_scan(gpu, &random(1_000_000, 21, 1));
    check_scan(gpu, &vec![1 << 21; 2040]);
    check_scan(gpu, &vec![1 << 21; 2048]);
    check_scan(gpu, &vec![1 << 12; 1_000_000]);
    check_scan(gpu, &vec![1 << 13; 1_000_000]);
}

/// Where each key was tells whether equal ones kept their order: the sort's values are the keys' places.
fn check_sort(gpu: &Gpu, keys: &[u32], bits: u32, what: &str) {
    for at_most in longest(keys.len()) {
        check_sort_of(gpu, keys, bits, at_most, what);
    }
}

fn check_sort_of(gpu: &Gpu, keys: &[u32], bits: u32, at_most: u32, what: &str) {
    let (sorted, from) = sort(gpu, keys, bits, at_most).unwrap();
    let mut expected: Vec<(u32, u32)> = keys.iter().copied().zip(0..).collect();
    expected.sort_by_key(|&(key, _)| key);
    let wrong = (0..keys.len()).find(|&i| expected[i] != (sorted[i], from[i]));
    assert_eq!(wrong, None, "{} {what} keys of {bits} bits", keys.len());
    assert_eq!((sorted.len(), from.len()), (keys.len(), keys.len()));
}

pub fn sorts(gpu: &Gpu) {
    for count in SIZES {
        let mut keys = random(count, 16, count as u64);
        check_sort(gpu, &keys, 16, "random");
        keys.sort_unstable();
        check_sort(gpu, &keys, 16, "sorted");
        keys.reverse();
        check_sort(gpu, &keys, 16, "reversed");
        check_sort(gpu, &vec![0xabcd; count], 16, "equal");
    }
}

pub fn sorts_keys_of_any_width(gpu: &Gpu) {
    for bits in [1, 7, 8, 9, 15, 16, 17, 24, 25, 31, 32] {
        check_sort(gpu, &random(10_000, bits, u64::from(bits)), bits, "random");
        check_sort(gpu, &random(3000, bits, u64::from(bits)), bits, "random");
    }
    check_sort(gpu, &random(1_000_000, 32, 5), 32, "random");
    // The largest key of all, and none in between.
    let ends: Vec<u32> = random(5000, 1, 3).into_iter().map(|key| key.wrapping_neg()).collect();
    check_sort(gpu, &ends, 32, "smallest and largest");
    // No bits at all: nothing moves.
    check_sort(gpu, &[0; 5000], 0, "equal");
}

/// Runs of equal keys that reach across workgroups and rounds.
pub fn a_sort_is_stable(gpu: &Gpu) {
    for distinct in [2, 3, 255, 256, 257] {
        let keys = random(100_000, 20, 11).into_iter().map(|key| key % distinct);
        let keys: Vec<u32> = keys.collect();
        check_sort(gpu, &keys, 9, "few distinct");
        check_sort(gpu, &keys[..4000], 9, "few distinct");
    }
    let runs: Vec<u32> = (0..100_000u32).map(|i| (i / 1000) % 7).collect();
    check_sort(gpu, &runs, 8, "runs of");
}
