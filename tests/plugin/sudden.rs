//! What a game does to bodies from one step to the next counts in the whole of that step.

use crate::app::{Sim, resting};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

fn push(impulse: Vec3) -> ExternalForces {
    ExternalForces { impulse, ..default() }
}

/// A force that in one step gives a body of 1 kg this speed.
fn force(speed: Vec3) -> ExternalForces {
    ExternalForces {
        force: 64.0 * speed,
        ..default()
    }
}

/// An impulse and a force of one step for this speed of a body of 1 kg, twice as much with the force, and the number of
/// steps for which the body rests before: it is awake after one, and asleep after many.
fn shots(speed: f32) -> [(ExternalForces, usize); 4] {
    let [impulse, force] = [push(Vec3::X * speed), force(Vec3::X * 2.0 * speed)];
    [(impulse, 1), (force, 1), (impulse, 80), (force, 80)]
}

/// A ball of 1 kg, which rests so far before a plate of 1 cm, and the plate.
fn range(sim: &mut Sim, distance: f32) -> (Entity, Entity) {
    let (ball, cube) = (sim.mesh(&shapes::ball(0.05, 2)), sim.mesh(&shapes::cube(1.0)));
    let plate = Transform::from_xyz(2.0, 0.0, 0.0).with_scale(Vec3::new(0.01, 1.0, 1.0));
    let plate = sim.spawn((cube, plate));
    (
        sim.spawn((resting(&ball, Vec3::X * (2.0 - distance)), Mass(1.0))),
        plate,
    )
}

pub fn a_bullet_that_is_fired_does_not_pass_a_plate() {
    for (shot, steps) in shots(300.0) {
        let mut sim = Sim::new();
        let (bullet, _) = range(&mut sim, 2.0);
        sim.step(steps);
        assert_eq!(sim.get::<Sleeping>(bullet).0, steps > 1);
        sim.set(bullet, (ContinuousCollision, shot));
        for _ in 0..3 {
            sim.step(1);
            sim.set(bullet, ExternalForces::default());
            assert!(sim.position(bullet).x < 2.0, "it passed the plate");
        }
        assert!(sim.velocity(bullet).x < 150.0, "it hit");
    }
}

pub fn a_push_counts_for_collision_substeps() {
    for (shot, steps) in shots(8.0) {
        let mut sim = Sim::new();
        let (ball, plate) = range(&mut sim, 0.1);
        sim.step(steps);
        assert_eq!(sim.get::<Sleeping>(ball).0, steps > 1);
        sim.set(ball, shot);
        sim.step(1);
        assert!(sim.report().collision_substeps > 1);
        assert!(sim.touch(ball, plate) || sim.velocity(ball).x < 1.0);
        assert!(sim.position(ball).x < 2.0, "it passed the plate");
    }
}

/// Two balls that touch. One is asleep, and the other is kicked into it.
pub fn an_impulse_into_a_sleeper_moves_it() {
    let mut sim = Sim::new();
    let ball = sim.mesh(&shapes::ball(0.5, 3));
    let [sleeper, kicked] = [0.0, 1.1].map(|x| sim.spawn((resting(&ball, Vec3::X * x), Mass(1.0))));
    sim.step(80);
    assert!(sim.get::<Sleeping>(sleeper).0);
    sim.set(kicked, push(Vec3::NEG_X * 16.0));
    sim.step(4);
    let sum = sim.velocity(sleeper).x + sim.velocity(kicked).x;
    assert!(sim.velocity(sleeper).x < -7.0, "{}", sim.velocity(sleeper));
    assert!((sum + 16.0).abs() < 0.1, "momentum {sum}");
}

/// A cube asleep on a slab that is kinematic and lies still.
fn on_a_slab() -> (Sim, Entity, Entity) {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let size = Transform::from_scale(Vec3::new(4.0, 1.0, 4.0));
    let slab = sim.spawn((RigidBody::Kinematic, cube.clone(), size));
    let body = sim.spawn(resting(&cube, Vec3::Y * 1.01));
    sim.step(100);
    assert!(
        sim.get::<Sleeping>(body).0,
        "a kinematic body that lies still lets others sleep"
    );
    (sim, slab, body)
}

pub fn a_sleeper_wakes_when_what_carries_it_is_replaced() {
    let replace: [(&str, fn(&mut Sim, Entity)); 3] = [
        ("teleported", |sim, slab| {
            let place = Transform::from_xyz(0.0, 0.3, 0.0).with_scale(Vec3::new(4.0, 1.0, 4.0));
            sim.set(slab, (place, Teleport));
        }),
        ("scaled", |sim, slab| {
            sim.set(slab, Transform::from_scale(Vec3::new(4.0, 1.6, 4.0)));
        }),
        ("given another mesh", |sim, slab| {
            let mesh = sim.mesh(&shapes::cube(1.6));
            sim.set(slab, mesh);
        }),
    ];
    for (name, replace) in replace {
        let (mut sim, slab, body) = on_a_slab();
        replace(&mut sim, slab);
        sim.step(3);
        assert!(!sim.get::<Sleeping>(body).0, "{name}");
        sim.step(150);
        let height = sim.position(body).y;
        assert!((1.29..1.32).contains(&height), "{name}: {height}");
        assert!(sim.get::<Sleeping>(body).0, "{name}: it sleeps again");
    }
}

pub fn a_sleeper_wakes_when_its_gravity_or_its_locks_change() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let floats = sim.spawn((resting(&cube, Vec3::ZERO), GravityScale(0.0)));
    let hangs = sim.spawn((resting(&cube, Vec3::X * 3.0), LockedAxes::TRANSLATION_Y));
    sim.step(80);
    assert!(sim.get::<Sleeping>(floats).0 && sim.get::<Sleeping>(hangs).0);
    sim.set(floats, GravityScale(1.0));
    sim.world().entity_mut(hangs).remove::<LockedAxes>();
    sim.step(30);
    for body in [floats, hangs] {
        assert!(sim.velocity(body).y < -2.0, "{}", sim.velocity(body));
    }
}

/// `ContinuousCollision` on it is for the sensors on its way.
pub fn a_flagged_kinematic_body_pushes_what_is_in_its_way() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let plate = |z| Transform::from_xyz(0.0, 0.0, z).with_scale(Vec3::new(1.0, 1.0, 0.05));
    let velocity = LinearVelocity(Vec3::Z * 20.0);
    sim.spawn((
        RigidBody::Kinematic,
        cube.clone(),
        plate(0.0),
        velocity,
        ContinuousCollision,
    ));
    let pushed = sim.spawn((RigidBody::Dynamic, cube, plate(0.2)));
    sim.step(2);
    assert!(sim.velocity(pushed).z > 19.0, "{}", sim.velocity(pushed));
}
