//! Long runs under random changes: see [`soak`].
//!
//! `cargo test --release --features cli --test soak -- --ignored --nocapture` runs half an hour of simulated time with
//! 1,000 bodies on the CPU, and 10,000 steps of 300 bodies on a device. `FACEOFF_SOAK_SEED`, `FACEOFF_SOAK_STEPS`,
//! `FACEOFF_SOAK_BODIES` and `FACEOFF_SOAK_EVERY` (steps between changes) choose other numbers.

#[path = "../common/app.rs"]
mod app;
mod checks;
mod soak;

use bevy_faceoff::prelude::*;
use soak::Plan;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

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

/// Most growth of the heap in the second half of a run. What is in memory at one moment depends on the pairs that touch
/// then, so empty worlds are compared. Bevy keeps a table for each set of components that it has ever seen.
const MOST_GROWTH: f32 = 0.02;

fn live_bytes() -> usize {
    let all = ALLOCATOR.stats();
    all.bytes_allocated - all.bytes_deallocated
}

const SHORT: Plan = Plan {
    backend: Backend::Cpu,
    readback: Readback::Lockstep,
    threads: 1,
    bodies: 30,
    room: 0.6,
    steps: 600,
    seed: 0,
    steps_per_change: 2,
    live_bytes: None,
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
        bodies: number("FACEOFF_SOAK_BODIES", 1000),
        steps: number("FACEOFF_SOAK_STEPS", 30 * 60 * 64),
        seed: seed(),
        steps_per_change: number("FACEOFF_SOAK_EVERY", 4),
        live_bytes: Some(live_bytes),
        ..SHORT
    });
    println!("CPU: {report}");
    assert!(report.growth.is_none_or(|growth| growth < MOST_GROWTH));
}

#[cfg(feature = "gpu")]
#[test]
#[ignore = "takes hours with a software driver"]
fn ten_thousand_steps_on_a_device() {
    let report = soak::run(Plan {
        backend: Backend::Gpu,
        threads: 0,
        bodies: number("FACEOFF_SOAK_BODIES", 300),
        // With piles a software driver takes 1.5 s a step.
        room: 1.5,
        steps: number("FACEOFF_SOAK_STEPS", 10_000),
        seed: seed(),
        steps_per_change: number("FACEOFF_SOAK_EVERY", 4),
        live_bytes: Some(live_bytes),
        ..SHORT
    });
    println!("device: {report}");
    let steps = number("FACEOFF_SOAK_STEPS", 10_000);
    assert!(2 * report.on_device > steps, "{} steps on the device", report.on_device);
    assert!(report.growth.is_none_or(|growth| growth < MOST_GROWTH));
}
