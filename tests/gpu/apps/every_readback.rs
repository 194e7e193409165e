//! Bodies that rest on each other, hit each other and sleep do the same in every [`Readback`].

use super::readback::app;
use crate::app::{Sim, resting};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::plugin::settings::LATENCY;
use bevy_faceoff::prelude::*;

pub const TESTS: &[Test] = &[
    (
        "contacts_are_the_same_wherever_components_say_bodies_are",
        same_contacts,
    ),
    ("impacts_are_the_same_whenever_results_are_read", same_impacts),
    ("a_kinematic_body_is_as_fast_in_every_readback", kinematic_speed),
    ("sleepers_are_counted_on_the_gpu_alone", sleepers),
    ("what_lies_on_a_kinematic_body_sleeps", on_a_slab),
];

fn sleepers(_: &Gpu) {
    let mut sim = app(Backend::Gpu, Readback::Resident);
    sim.app
        .insert_resource(Response::Contacts)
        .insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let bodies = [0.0, 5.0, 10.0].map(|x| sim.spawn(resting(&cube, Vec3::new(x, 0.505, 0.0))));
    sim.step(128);
    assert_eq!(sim.report().sleeping, 3);
    sim.set(bodies[1], Sleeping(false));
    sim.step(1 + LATENCY);
    assert_eq!(sim.report().sleeping, 2);
    sim.step(128);
    assert_eq!(sim.report().sleeping, 3);
}

/// The slab's centre of mass is not at its origin, so that the device places it with a rounding error.
fn on_a_slab(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent, Readback::Resident] {
        let mut sim = app(Backend::Gpu, readback);
        sim.app
            .insert_resource(Response::Contacts)
            .insert_resource(Gravity::default());
        let (shape, center) = (shapes::cube(1.0), Vec3::new(0.37, 0.0, 0.21));
        let vertices = shape.vertices().iter().map(|&v| v + center).collect();
        let [cube, slab] = [
            sim.mesh(&shape),
            sim.mesh(&TriMesh::new(vertices, shape.triangles().to_vec()).unwrap()),
        ];
        let place = Transform::from_xyz(1.3, 0.0, -0.7)
            .with_rotation(Quat::from_rotation_y(0.4))
            .with_scale(Vec3::new(6.1, 1.0, 6.1));
        sim.spawn((RigidBody::Kinematic, slab, place));
        sim.spawn(resting(&cube, place.transform_point(center) + Vec3::Y * 1.01));
        sim.step(128);
        assert_eq!(sim.report().sleeping, 1, "{readback:?}");
    }
}

/// A step of the same world with each `Readback`, after which all bodies are at the same places.
fn step_alike(worlds: &mut [Sim; 3], step: u32) {
    let [wanted, latent, resident] = worlds.each_mut().map(|sim| {
        sim.step(1);
        let snapshot = Snapshot::take(sim.world());
        snapshot
            .bodies()
            .map(|(entity, motion)| (entity, *motion))
            .collect::<Vec<_>>()
    });
    assert_eq!(latent, wanted, "latent, step {step}");
    assert_eq!(resident, wanted, "resident, step {step}");
}

/// Cubes fall from one place, far from where they end, with each `Readback`.
fn same_contacts(_: &Gpu) {
    let mut worlds = [Readback::Lockstep, Readback::Latent, Readback::Resident].map(|readback| {
        let mut sim = app(Backend::Gpu, readback);
        sim.app
            .insert_resource(Response::Contacts)
            .insert_resource(Gravity::default());
        let cube = sim.mesh(&shapes::cube(0.5));
        sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
        for i in 0..6 {
            let place = Vec3::new(0.07 * i as f32, 0.3 + 0.6 * i as f32, 40.0);
            let body = sim.spawn(resting(&cube, place));
            sim.set(body, AngularVelocity(Vec3::new(0.3, 0.1 * i as f32, 0.2)));
        }
        sim
    });
    for step in 0..60 {
        step_alike(&mut worlds, step);
    }
}

/// Balls hit thin plates that stand on a floor, so that the number of collision substeps changes often. Where results
/// come later, steps are recorded for other numbers, and repeated at other times.
fn same_impacts(_: &Gpu) {
    let mut worlds = [Readback::Lockstep, Readback::Latent, Readback::Resident].map(|readback| {
        let mut sim = app(Backend::Gpu, readback);
        sim.app
            .insert_resource(Response::Contacts)
            .insert_resource(Gravity::default());
        sim.spawn(PlaneCollider::through(Vec3::Y * -0.5, Vec3::Y));
        let (ball, cube) = (sim.mesh(&shapes::ball(0.1, 3)), sim.mesh(&shapes::cube(1.0)));
        for i in 0..5 {
            let plate = sim.spawn(resting(&cube, Vec3::X * 3.0 * i as f32));
            sim.set(
                plate,
                Transform::from_xyz(3.0 * i as f32, 0.0, 0.0).with_scale(Vec3::new(0.06, 1.0, 1.0)),
            );
            let flier = sim.spawn(resting(&ball, Vec3::new(-1.5 - 4.0 * i as f32, 0.1 * i as f32, 0.0)));
            sim.set(flier, LinearVelocity(Vec3::X * (40.0 - 9.0 * i as f32)));
        }
        sim
    });
    let mut counts = Vec::new();
    let mut submissions = [0; 3];
    for step in 0..50 {
        step_alike(&mut worlds, step);
        counts.push(worlds[0].report().collision_substeps);
        for (sum, sim) in submissions.iter_mut().zip(&worlds) {
            *sum += sim.report().gpu.map_or(0, |work| work.submissions);
        }
    }
    counts.dedup();
    println!("{counts:?} collision substeps, {submissions:?} submissions");
    assert!(counts.len() > 4, "{counts:?}");
    assert!(submissions.iter().all(|&sum| sum > 50), "some steps were repeated");
}

/// The number of collision substeps follows from the speeds of bodies, whenever results are read.
fn kinematic_speed(_: &Gpu) {
    let collision_substeps = [Readback::Lockstep, Readback::Latent, Readback::Resident].map(|readback| {
        let mut sim = app(Backend::Gpu, readback);
        sim.app.insert_resource(Response::Contacts);
        let cube = sim.mesh(&shapes::cube(0.2));
        sim.spawn(resting(&cube, Vec3::ZERO));
        // So near that a corner of each would reach it.
        sim.spawn(PlaneCollider::through(Vec3::Y * -0.12, Vec3::Y));
        for k in 1..4 {
            let body = sim.spawn(resting(&cube, Vec3::Z * 2.0 * k as f32));
            sim.set(body, (RigidBody::Kinematic, LinearVelocity(Vec3::X * 10.0)));
        }
        sim.step(8);
        sim.report().collision_substeps
    });
    // 10 m/s are 0.16 m a step, a quarter of the thickness is 0.05 m.
    assert_eq!(collision_substeps, [4; 3]);
}
