//! The energy that the report of a step tells.

use crate::app::{Sim, assert_near, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use bevy_faceoff::types::energy::Energy;

fn energy(sim: &Sim) -> Energy {
    sim.report().energy.expect("it was asked for")
}

fn asked() -> Sim {
    let mut sim = Sim::new();
    sim.world().insert_resource(MeasureEnergy(true));
    sim
}

#[track_caller]
fn assert_is(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} in place of {expected}");
}

#[test]
fn nobody_asks_and_nothing_is_told() {
    let mut sim = Sim::new();
    let ball = sim.mesh(&shapes::ball(0.5, 2));
    sim.spawn(resting(&ball, Vec3::ZERO));
    sim.step(1);
    assert_eq!(sim.report().energy, None);
    sim.world().insert_resource(MeasureEnergy(true));
    sim.step(1);
    assert_eq!(sim.report().energy, Some(Energy::default()));
}

#[test]
fn motion_rotation_and_height_count_by_formula() {
    let mut sim = asked();
    let cube = sim.mesh(&shapes::cube(1.0));
    let at = Vec3::new(3.0, 2.0, -1.0);
    // A cube of side a has the inertia m a^2 / 6 about any axis.
    let thrown = sim.spawn((
        resting(&cube, at),
        Mass(6.0),
        LinearVelocity(Vec3::new(1.0, 0.0, 2.0)),
        AngularVelocity(Vec3::new(0.0, 3.0, 0.0)),
    ));
    // Neither is dynamic.
    sim.spawn((cube.clone(), Transform::from_xyz(50.0, 0.0, 0.0)));
    sim.spawn((
        RigidBody::Kinematic,
        cube.clone(),
        LinearVelocity(Vec3::Y),
        Transform::from_xyz(70.0, 0.0, 0.0),
    ));
    sim.step(1);
    let found = energy(&sim);
    assert_is(found.kinetic, 0.5 * (6.0 * 5.0 + 1.0 * 9.0), 1e-4);
    assert_eq!(found.potential, 0.0);
    sim.world().insert_resource(Gravity(Vec3::NEG_Y * 10.0));
    let before = found.kinetic + 6.0 * 10.0 * 2.0;
    for _ in 0..64 {
        sim.step(1);
        let found = energy(&sim);
        assert_is(found.potential, 60.0 * f64::from(sim.position(thrown).y), 1e-3);
        assert_is(found.total(), before, 0.01 * before);
    }
}

#[test]
fn a_body_of_two_colliders_counts_once() {
    let mut sim = asked();
    let cube = sim.mesh(&shapes::cube(1.0));
    let part = |x: f32| (cube.clone(), Density(2.0), Transform::from_xyz(x, 0.0, 0.0));
    let body = (
        RigidBody::Dynamic,
        LinearVelocity(Vec3::Z * 3.0),
        AngularVelocity(Vec3::X),
        Transform::from_xyz(0.0, 5.0, 0.0),
    );
    sim.spawn((body, children![part(-1.0), part(1.0)]));
    sim.world().insert_resource(Gravity(Vec3::NEG_Y));
    sim.step(1);
    let found = energy(&sim);
    // Both turn about the line through their centres.
    let kinetic = 0.5 * (4.0 * 9.0 + 4.0 / 6.0);
    assert_is(found.total(), kinetic + 4.0 * 5.0, 0.01);
}

#[test]
fn what_sleeps_keeps_its_height() {
    let mut sim = asked();
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.world().insert_resource(Gravity::default());
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    let place = |i: i32| Vec3::new(3.0 * (i % 10) as f32, 0.5, 3.0 * (i / 10) as f32);
    let bodies: Vec<Entity> = (0..100)
        .map(|i| sim.spawn((resting(&cube, place(i)), Mass(2.0))))
        .collect();
    sim.step(200);
    assert_eq!((sim.report().sleeping, sim.report().dormant), (100, 100));
    let found = energy(&sim);
    assert_eq!(found.kinetic, 0.0);
    let heights: f32 = bodies.iter().map(|&body| sim.position(body).y).sum();
    assert_is(found.potential, 2.0 * 9.81 * f64::from(heights), 0.01);
    assert_near(Vec3::Y * heights, Vec3::Y * 50.0, 0.5);
}
