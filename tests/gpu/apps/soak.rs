//! A world under random changes on a device: see `tests/soak`.

#[path = "../../soak/checks.rs"]
mod checks;
#[path = "../../soak/soak.rs"]
#[expect(clippy::module_inception, reason = "the file has this name for the test of the CPU")]
mod soak;

use crate::gpu::Test;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::prelude::*;
use soak::Plan;

pub const TESTS: &[Test] = &[
    ("random_changes_break_nothing", random_changes_break_nothing),
    ("random_changes_break_nothing_later", random_changes_break_nothing_later),
];

fn run(readback: Readback) {
    let report = soak::run(Plan {
        backend: Backend::Gpu,
        readback,
        threads: 1,
        bodies: 20,
        room: 0.6,
        steps: 120,
        seed: 1,
        steps_per_change: 2,
        live_bytes: None,
    });
    println!("{report}");
    assert!(report.on_device > 60, "{} steps on the device", report.on_device);
}

fn random_changes_break_nothing(_: &Gpu) {
    run(Readback::Lockstep);
}

fn random_changes_break_nothing_later(_: &Gpu) {
    run(Readback::Latent);
}
