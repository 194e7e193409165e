//! Apps with `ContinuousCollision`: one bullet does not move a world off the GPU, whenever results are read.

use super::readback::await_device;
use crate::app::{Sim, resting};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::prelude::*;
use std::f32::consts::FRAC_PI_4;

pub const TESTS: &[Test] = &[
    ("a_bullet_among_500_tori_stays_on_the_gpu", among_tori),
    ("bullets_are_the_same_two_steps_later", later),
    ("a_bullet_stays_on_the_gpu_and_hits", resident),
    ("a_bullet_that_becomes_an_ordinary_body_counts", becomes_ordinary),
    ("a_snapshot_of_a_bullet_goes_on_to_the_bit", snapshot),
];

/// Without gravity.
fn app(backend: Backend, readback: Readback) -> Sim {
    let mut sim = Sim::with_step(StepPlugin {
        backend,
        threads: 2,
        readback,
        ..default()
    });
    await_device(&mut sim);
    sim
}

/// 500 tori that part from each other, and a bullet that flies between them to a plate of 1 cm.
fn tori(sim: &mut Sim) -> (Entity, Vec<Entity>) {
    let torus = sim.mesh(&shapes::torus_240());
    let (ball, cube) = (sim.mesh(&shapes::ball(0.05, 2)), sim.mesh(&shapes::cube(1.0)));
    let plate = Vec3::new(30.0, 30.0, 0.01);
    sim.spawn((cube, Transform::from_xyz(0.0, 0.0, 20.0).with_scale(plate)));
    let bullet = sim.spawn((
        resting(&ball, Vec3::Z * -20.0),
        LinearVelocity(Vec3::Z * 300.0),
        ContinuousCollision,
    ));
    let tori = (0..500).map(|i| {
        let at = [i % 10, i / 10 % 10, i / 100].map(|k| 2.5 * k as f32);
        let at = Vec3::from_array(at) - Vec3::new(11.25, 11.25, 5.0);
        sim.spawn((
            resting(&torus, at),
            LinearVelocity(0.1 * at),
            AngularVelocity(Vec3::new(0.3, at.x * 0.1, -0.2)),
        ))
    });
    let tori = tori.collect();
    (bullet, tori)
}

fn among_tori(_: &Gpu) {
    let [mut cpu, mut gpu] = [Backend::Cpu, Backend::Gpu].map(|backend| app(backend, Readback::Lockstep));
    let (bullet, bodies) = tori(&mut cpu);
    assert_eq!(tori(&mut gpu), (bullet, bodies.clone()));
    let mut hits = 0;
    for step in 0..14 {
        for sim in [&mut cpu, &mut gpu] {
            sim.step(1);
        }
        let work = gpu.report().gpu.expect("the step ran on the GPU");
        assert!(work.submissions >= 2, "{work:?}");
        assert!(cpu.report().gpu.is_none());
        for &body in bodies.iter().chain([&bullet]) {
            let off = cpu.position(body).distance(gpu.position(body));
            assert!(off < 1.0e-3, "step {step}, {body}: {off} m");
        }
        assert!(gpu.position(bullet).z < 20.0, "it passed");
        hits += usize::from(gpu.velocity(bullet).z < 150.0);
    }
    assert!(hits > 0, "it hit");
    assert_eq!(cpu.velocity(bullet).z > 0.0, gpu.velocity(bullet).z > 0.0);
    // Once it is gone a step is one submission again.
    gpu.world().despawn(bullet);
    gpu.step(1);
    assert_eq!(gpu.report().gpu.unwrap().submissions, 1);
}

/// Balls that bounce between two walls of 1 cm, one through a sensor, and two that meet head-on. A game gives one of
/// them a push.
fn alley(sim: &mut Sim) -> Vec<Entity> {
    let (ball, cube) = (sim.mesh(&shapes::ball(0.05, 2)), sim.mesh(&shapes::cube(1.0)));
    for x in [-3.0, 3.0] {
        let thin = Vec3::new(0.01, 400.0, 400.0);
        sim.spawn((
            cube.clone(),
            Restitution::new(0.9),
            Transform::from_xyz(x, 0.0, 0.0).with_scale(thin),
        ));
    }
    let gate = Transform::from_xyz(0.0, 2.0, 0.0).with_scale(Vec3::new(0.2, 1.0, 1.0));
    sim.spawn((cube.clone(), Sensor, gate));
    let mut bullet = |at: Vec3, speed: f32| {
        sim.spawn((
            resting(&ball, at),
            LinearVelocity(Vec3::X * speed),
            Restitution::new(0.9),
            ExternalForces::default(),
            ContinuousCollision,
        ))
    };
    let mut bodies = vec![
        bullet(Vec3::new(0.0, -2.0, 0.0), 170.0),
        bullet(Vec3::new(-2.0, 2.0, 0.0), 100.0),
        bullet(Vec3::new(-2.0, 0.0, 0.0), 150.0),
        bullet(Vec3::new(2.0, 0.01, 0.0), -150.0),
    ];
    // An ordinary body, which rests.
    bodies.push(sim.spawn(resting(&cube, Vec3::new(20.0, 0.0, 0.0))));
    bodies
}

type Seen = (Vec<(Transform, Vec3)>, String);

fn seen(sim: &Sim, bodies: &[Entity]) -> Seen {
    let of = |&body: &Entity| (sim.get(body), sim.velocity(body));
    let collisions: Vec<_> = sim.collisions().iter().collect();
    let substeps = sim.report().collision_substeps;
    (bodies.iter().map(of).collect(), format!("{collisions:?} {substeps}"))
}

fn later(_: &Gpu) {
    let [mut waits, mut latent] = [Readback::Lockstep, Readback::Latent].map(|readback| app(Backend::Gpu, readback));
    let bodies = alley(&mut waits);
    assert_eq!(bodies, alley(&mut latent));
    let mut history = Vec::new();
    let mut passing = 0;
    for step in 0..40 {
        for sim in [&mut waits, &mut latent] {
            if step == 20 {
                let impulse = Vec3::new(0.0, 0.0, 30.0);
                sim.set(bodies[1], ExternalForces { impulse, ..default() });
            }
            sim.step(1);
        }
        passing += waits.collisions().iter().filter(|collision| collision.passing).count();
        history.push(seen(&waits, &bodies));
        if step >= LATENCY {
            assert_eq!(seen(&latent, &bodies), history[step - LATENCY], "step {step}");
        }
        assert!(waits.report().gpu.is_some() && (step < LATENCY || latent.report().gpu.is_some()));
        assert!(waits.position(bodies[0]).x.abs() < 3.0);
    }
    assert!(passing >= 1, "{passing}");
}

fn resident(_: &Gpu) {
    let mut sim = app(Backend::Gpu, Readback::Resident);
    let bodies = alley(&mut sim);
    for _ in 0..8 {
        sim.step(5);
        let now = Snapshot::take(sim.world());
        let of = |body: Entity| *now.bodies().find(|&(other, _)| other == body).unwrap().1;
        for &body in &bodies[..4] {
            let motion = of(body);
            assert!(motion.position.x.abs() < 3.0, "{motion:?}");
        }
        assert!(of(bodies[0]).position != Vec3::new(0.0, -2.0, 0.0));
    }
    let report = sim.report();
    assert!(report.gpu.is_some() && report.waits >= 40, "{report:?}");
}

/// Its speed, which only the GPU knows, then causes collision substeps.
fn becomes_ordinary(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent, Readback::Resident] {
        let mut sim = app(Backend::Gpu, readback);
        let ball = sim.mesh(&shapes::ball(0.05, 2));
        let cube = sim.mesh(&shapes::cube(1.0));
        sim.spawn((cube.clone(), Transform::from_xyz(0.0, 50.0, 0.0)));
        // Cubes that stand on edge beneath its way, so near that it might meet them.
        for i in 0..26 {
            let place = Transform::from_xyz(1.5 * i as f32, -0.9, 0.0);
            sim.spawn((cube.clone(), place.with_rotation(Quat::from_rotation_z(FRAC_PI_4))));
        }
        // An ordinary body, whose speed only the GPU knows too.
        sim.spawn(resting(&ball, Vec3::Y * 60.0));
        let bullet = sim.spawn((
            resting(&ball, Vec3::ZERO),
            ExternalForces::default(),
            ContinuousCollision,
        ));
        sim.step(3);
        // No component says how fast it is from now on.
        let impulse = Vec3::X * 100.0;
        sim.set(bullet, (Mass(1.0), ExternalForces { impulse, ..default() }));
        sim.step(6);
        assert_eq!(sim.report().collision_substeps, 1, "{readback:?}");
        sim.world().entity_mut(bullet).remove::<ContinuousCollision>();
        sim.step(1 + LATENCY);
        let report = sim.report();
        assert!(
            report.collision_substeps > 1,
            "{readback:?}: {}",
            report.collision_substeps
        );
        sim.step(6);
        assert!(sim.report().collision_substeps > 1, "{readback:?}");
    }
}

fn snapshot(_: &Gpu) {
    let mut sim = app(Backend::Gpu, Readback::Lockstep);
    let bodies = alley(&mut sim);
    // In flight, and right after an impact.
    for before in [1, 1, 1, 2, 3] {
        sim.step(before);
        let snapshot = Snapshot::take(sim.world());
        sim.step(6);
        let after = seen(&sim, &bodies);
        sim.step(3);
        assert!(snapshot.restore(sim.world()).is_empty());
        sim.step(6);
        assert_eq!(seen(&sim, &bodies), after, "{before}");
        assert!(snapshot.restore(sim.world()).is_empty());
    }
}
