//! Step after step, each side on its own.

use super::band::Oracle;
use super::compare::{Tally, compare};
use super::scenes::{BALL, CUBE, Kit, RING, TORUS, crowd};
use crate::oracle::rng::Rng;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::{Body, StepConfig};
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::settings::Response;
use bevy_faceoff::types::solver_settings::SolverSettings;
use glam::Vec3;

const STEPS: usize = 50;
const BODIES: usize = 200;

/// How far two poses of a body are apart, as a part of its radius.
fn drift(a: &Body, b: &Body, radius: f32) -> f64 {
    let moved = a.position.distance(b.position);
    // A point at the radius moves by twice that of a quaternion.
    f64::from(moved / radius + 2.0 * (a.rotation.normalize() - b.rotation.normalize()).length())
}

/// Without response nothing magnifies rounding: both sides see the same pairs for many steps.
pub fn fifty_steps_without_response(gpu: &Gpu) {
    let mut scene = crowd(&mut Rng::new(50, 0), &[TORUS, RING, CUBE, BALL], 8.0);
    scene.bodies.truncate(BODIES);
    scene.shapes = Kit::new().0;
    scene.config = StepConfig {
        dt: 1.0 / 64.0,
        gravity: Vec3::NEG_Y * 9.81,
        response: Response::None,
        // Pairs that are near and do not touch are for other tests.
        solver: SolverSettings {
            contact_margin: 0.0,
            rest_offset: 0.0,
            ..SolverSettings::default()
        },
        ..StepConfig::default()
    };
    let mut on_device = scene.clone();
    let mut step = GpuStep::new(gpu.clone()).unwrap();
    let (mut all, mut worst, mut changes) = (Tally::default(), 0.0f64, 0);
    let mut last = Vec::new();
    for number in 0..STEPS {
        let (cpu, gpu) = (scene.on_cpu(), on_device.on_gpu(&mut step));
        let far = |i: usize| drift(&scene.bodies[i], &on_device.bodies[i], cpu.input.bodies.radius[i]);
        let drift = (0..BODIES).map(far).fold(0.0, f64::max);
        worst = worst.max(drift);
        let mut oracle = Oracle::new(&scene, &cpu);
        oracle.drift = drift;
        let (mut tally, _) = compare(&scene, &cpu, &gpu, &oracle);
        let named = |text: &String| format!("step {number}: {text}");
        tally.failures = tally.failures.iter().map(named).collect();
        all.add(tally);
        let touching: Vec<_> = cpu.results.contacts.pairs.iter().map(|pair| pair.bodies).collect();
        changes += usize::from(touching != last);
        last = touching;
        scene.take(&cpu);
        on_device.take(&gpu);
    }
    println!("\n{}\n{}", Tally::head(), all.row("50 steps"));
    println!("    drift {worst:.1e} of a radius");
    all.require_no_failures();
    all.require_few_excused(1000);
    // A rounding of 6e-8 a step in position and rotation.
    assert!(worst < 2.0e-5, "{worst}");
    assert!(changes > STEPS / 2 && all.touching > 20 * STEPS);
}
