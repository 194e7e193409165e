//! Long runs under random changes: see [`soak`].
//!
//! `cargo test --release --features cli --test soak -- --ignored --nocapture` runs half an hour of simulated time with 1,000
//! bodies on the CPU, and 10,000 steps of 300 bodies on a device. `FACEOFF_SOAK_SEED` chooses another seed.

mod checks;
mod soak;

use bevy_faceoff::prelude::*;
use soak::Plan;

fn seed() -> u64 {
    std::env::var("FACEOFF_SOAK_SEED").map_or(1, |seed| seed.parse().expect("FACEOFF_SOAK_SEED is a number"))
}

const SHORT: Plan = Plan {
    backend: Backend::Cpu,
    readback: Readback::Lockstep,
    threads: 1,
    bodies: 30,
    steps: 600,
    seed: 0,
    steps_per_change: 2,
};

#[test]
fn random_changes_break_nothing() {
    for seed in seed()..seed() + 3 {
        soak::run(Plan { seed, ..SHORT });
    }
}

#[test]
#[ignore = "takes minutes"]
fn half_an_hour_of_a_thousand_bodies() {
    let report = soak::run(Plan {
        threads: 0,
        bodies: 1000,
        steps: 30 * 60 * 64,
        seed: seed(),
        steps_per_change: 4,
        ..SHORT
    });
    println!("CPU, 1,000 bodies, 115,200 steps: {report}");
    assert!(report.growth.is_none_or(|growth| growth < 0.02));
}

#[cfg(feature = "gpu")]
#[test]
#[ignore = "takes an hour with a software driver"]
fn ten_thousand_steps_on_a_device() {
    let report = soak::run(Plan {
        backend: Backend::Gpu,
        threads: 0,
        bodies: 300,
        steps: 10_000,
        seed: seed(),
        steps_per_change: 4,
        ..SHORT
    });
    println!("device, 300 bodies, 10,000 steps: {report}");
    assert!(report.growth.is_none_or(|growth| growth < 0.02));
}
