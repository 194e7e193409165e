//! Scan and sort against the standard library's, and dispatches of any size.
#![cfg(feature = "gpu")]

use bevy_faceoff::gpu::{device, radix_sort, scan};

#[test]
fn smoke() {
    let gpu = device::open(true).unwrap();
    println!("{:?}", gpu.info);
    for n in [0usize, 1, 255, 256, 257, 5000, 1_000_000] {
        let values: Vec<u32> = (0..n as u32).map(|i| i.wrapping_mul(2654435761) >> 20).collect();
        let (before, total) = scan::exclusive(&gpu, &values).unwrap();
        let mut sum = 0u32;
        for (v, b) in values.iter().zip(&before) {
            assert_eq!(sum, *b);
            sum += v;
        }
        assert_eq!(total, sum);
        let keys: Vec<u32> = values.iter().map(|v| v * 3).collect();
        let (sorted, from) = radix_sort::sort(&gpu, &keys, 16).unwrap();
        let mut want: Vec<(u32, u32)> = keys.iter().copied().zip(0..).collect();
        want.sort();
        let got: Vec<(u32, u32)> = sorted.into_iter().zip(from).collect();
        assert!(want == got, "{n}");
    }
}
