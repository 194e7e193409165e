//! Pairs that fly past each other or meet, on the device.

use super::fly_past::throw;

pub fn pass_or_hit() {
    for (seed, spins) in [(1, false), (2, true)] {
        let passes = throw(seed, 256, spins);
        println!("{passes:?}");
        assert!(passes.free > 50 && passes.hits > 50, "{passes:?}");
        assert_eq!((passes.deflected, passes.missed), (0, 0), "{passes:?}");
    }
}
