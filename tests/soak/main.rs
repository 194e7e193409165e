//! Long runs under random changes: see [`soak`].
//!
//! `cargo test --release --features cli --test soak -- --ignored --nocapture` runs half an hour of simulated time with 1,000
//! bodies on the CPU, and 10,000 steps of 300 bodies on a device. `FACEOFF_SOAK_SEED` chooses another seed,
//! `FACEOFF_SOAK_STEPS` another length.

mod checks;
mod soak;

use bevy_faceoff::prelude::*;
use soak::Plan;

/// A number from the environment.
fn number<N: std::str::FromStr>(name: &str, usual: N) -> N {
    std::env::var(name).map_or(usual, |text| {
        text.parse()
            .unwrap_or_else(|_| panic!("{name} is not a number: {text}"))
    })
}

fn seed() -> u64 {
    number("FACEOFF_SOAK_SEED", 1)
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
        steps: number("FACEOFF_SOAK_STEPS", 30 * 60 * 64),
        seed: seed(),
        steps_per_change: 4,
        ..SHORT
    });
    println!("CPU, 1,000 bodies: {report}");
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
        steps: number("FACEOFF_SOAK_STEPS", 10_000),
        seed: seed(),
        steps_per_change: 4,
        ..SHORT
    });
    println!("device, 300 bodies: {report}");
    assert!(report.growth.is_none_or(|growth| growth < 0.02));
}
