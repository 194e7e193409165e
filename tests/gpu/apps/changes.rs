//! Bodies that become something else while their results are on their way: they go on from where they are, and not from
//! where their components were some steps before.

use super::readback::app;
use crate::app::{DT, Sim, assert_near, ball_like, resting};
use crate::gpu::Test;
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::gpu::layout::Moved;
use bevy_faceoff::gpu::readback::read_words;
use bevy_faceoff::prelude::*;
use bevy_faceoff::state::Motion;

pub const TESTS: &[Test] = &[
    ("a_platform_that_stops_does_not_move_again", stops),
    ("what_has_moved_by_itself_is_moved_by_its_transform", is_driven_again),
    ("a_nested_body_returns_where_it_left", nested_returns),
    ("a_compound_that_becomes_static_stays_in_place", becomes_static),
    ("a_static_body_that_gains_colliders_stays_where_it_is_put", static_gains),
    ("collisions_on_their_way_are_told_when_hooks_appear", hooks_appear),
    ("a_platform_that_stops_as_hooks_appear_stays", stops_for_hooks),
    ("a_collider_takes_no_body_along_to_another", turret),
];

const READBACKS: [Readback; 3] = [Readback::Lockstep, Readback::Latent, Readback::Resident];

fn with_contacts(readback: Readback) -> Sim {
    let mut sim = app(Backend::Gpu, readback);
    sim.app.insert_resource(Response::Contacts);
    sim
}

/// Where a body is after the last step.
fn motion(sim: &mut Sim, body: Entity) -> Motion {
    let snapshot = Snapshot::take(sim.world());
    let (_, motion) = snapshot.bodies().find(|&(entity, _)| entity == body).unwrap();
    *motion
}

/// Where a collider is on the device.
fn on_device(sim: &Sim, collider: Entity) -> Vec3 {
    let world = sim.app.world();
    let (buffers, mut entities) = bevy_faceoff::plugin::poses(world).unwrap();
    let number = entities.position(|entity| entity == collider).unwrap();
    let stride = size_of::<Moved>() / 4;
    let gpu = bevy_faceoff::plugin::gpu(world).unwrap();
    let words = read_words(gpu, buffers.current, stride * buffers.bodies as usize).unwrap();
    Vec3::from_array([0, 1, 2].map(|k| f32::from_bits(words[stride * number + k])))
}

/// A kinematic cube of 1 m with this velocity.
fn platform(sim: &mut Sim, velocity: Vec3) -> Entity {
    let cube = sim.mesh(&shapes::cube(1.0));
    let platform = sim.spawn(resting(&cube, Vec3::ZERO));
    sim.set(platform, (RigidBody::Kinematic, LinearVelocity(velocity)));
    platform
}

/// Stops a platform and puts cubes before and behind it, close to where it is.
fn stop_between(sim: &mut Sim, platform: Entity, there: Vec3) -> [Entity; 2] {
    sim.world().get_mut::<LinearVelocity>(platform).unwrap().0 = Vec3::ZERO;
    let cube = sim.mesh(&shapes::cube(1.0));
    [-1.02, 1.02].map(|x| sim.spawn(resting(&cube, there + Vec3::X * x)))
}

fn stops(_: &Gpu) {
    for readback in READBACKS {
        let mut sim = with_contacts(readback);
        sim.app.insert_resource(Gravity::default());
        let platform = platform(&mut sim, Vec3::X * 5.0);
        sim.step(8);
        let there = motion(&mut sim, platform).position;
        assert_near(there, Vec3::X * 40.0 * DT, 1.0e-5);
        sim.world().get_mut::<LinearVelocity>(platform).unwrap().0 = Vec3::ZERO;
        let cube = sim.mesh(&shapes::cube(1.0));
        let rider = sim.spawn(resting(&cube, there + Vec3::Y));
        for step in 1..10 {
            sim.step(1);
            assert_near(motion(&mut sim, platform).position, there, 1.0e-5);
            // Friction would take it along.
            let speed = motion(&mut sim, rider).linear_velocity.x;
            assert!(speed.abs() < 1.0e-3, "{readback:?}, step {step}: {speed} m/s");
        }
    }
}

/// Hooks move the next step to the CPU.
fn add_hooks(sim: &mut Sim) {
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn((
        cube,
        ActiveCollisionHooks::FILTER_PAIRS,
        Transform::from_xyz(0.0, 90.0, 0.0),
    ));
}

fn stops_for_hooks(_: &Gpu) {
    for wait in 0..5 {
        let mut sim = with_contacts(Readback::Latent);
        let platform = platform(&mut sim, Vec3::X * 5.0);
        sim.step(8);
        let there = motion(&mut sim, platform).position;
        let beside = stop_between(&mut sim, platform, there);
        sim.step(wait);
        add_hooks(&mut sim);
        for step in 0..5 {
            sim.step(1);
            assert!(sim.report().gpu.is_none(), "it runs on the CPU");
            assert_near(sim.position(platform), there, 1.0e-5);
            for cube in beside {
                let speed = sim.velocity(cube).length();
                assert!(speed == 0.0, "{wait}, step {step}: {speed} m/s");
            }
        }
    }
}

/// A platform of which components no longer say where it is, because it had a velocity or was dynamic.
fn is_driven_again(_: &Gpu) {
    for (readback, kind) in READBACKS
        .into_iter()
        .flat_map(|readback| [RigidBody::Kinematic, RigidBody::Dynamic].map(|kind| (readback, kind)))
    {
        let mut sim = with_contacts(readback);
        let platform = platform(&mut sim, Vec3::X);
        sim.set(platform, kind);
        sim.step(8);
        sim.set(
            platform,
            (
                RigidBody::Kinematic,
                Transform::default(),
                LinearVelocity::default(),
                AngularVelocity::default(),
            ),
        );
        let cube = sim.mesh(&shapes::cube(1.0));
        let pushed = sim.spawn(resting(&cube, Vec3::X * 1.05));
        sim.step(1);
        for _ in 0..8 {
            sim.world().get_mut::<Transform>(platform).unwrap().translation.x += DT;
            sim.step(1);
        }
        let speed = motion(&mut sim, pushed).linear_velocity.x;
        assert!((speed - 1.0).abs() < 0.02, "{readback:?}, {kind:?}: {speed} m/s");
        assert_near(motion(&mut sim, platform).position, Vec3::X * 8.0 * DT, 1.0e-6);
    }
}

fn nested_returns(_: &Gpu) {
    for readback in READBACKS {
        let mut sim = app(Backend::Gpu, readback);
        let torus = sim.mesh(&shapes::torus_240());
        let turned = Transform::from_xyz(3.0, 0.0, 1.0).with_rotation(Quat::from_rotation_y(1.0));
        let parent = sim.spawn(turned);
        let body = sim.spawn((ball_like(&torus, Vec3::ZERO, Vec3::X), ChildOf(parent)));
        sim.step(8);
        sim.set(body, RigidBodyDisabled);
        sim.step(4);
        let shown = turned.transform_point(sim.position(body));
        let wanted = turned.translation + Vec3::X * 8.0 * DT;
        assert!(
            shown.distance(wanted) < 1.0e-5,
            "{readback:?}: {shown} and not {wanted}"
        );
        sim.world().entity_mut(body).remove::<RigidBodyDisabled>();
        sim.step(4);
        let found = motion(&mut sim, body).position;
        let wanted = turned.translation + Vec3::X * 12.0 * DT;
        assert!(
            found.distance(wanted) < 1.0e-5,
            "{readback:?}: {found} and not {wanted}"
        );
    }
}

/// What is done to a body of several colliders.
type Change = fn(&mut Sim, Entity);

fn becomes_static(_: &Gpu) {
    let changes: [(&str, Change); 2] = [
        ("static", |sim, body| sim.set(body, RigidBody::Static)),
        ("no body", |sim, body| {
            sim.world().entity_mut(body).remove::<RigidBody>();
        }),
    ];
    for readback in [Readback::Latent, Readback::Resident] {
        for own_collider in [false, true] {
            for (name, change) in &changes {
                let mut sim = app(Backend::Gpu, readback);
                let torus = sim.mesh(&shapes::torus_240());
                let at = Transform::from_rotation(Quat::from_rotation_y(0.5));
                let body = sim.spawn((RigidBody::Dynamic, at, LinearVelocity(Vec3::X)));
                let place = Transform::from_xyz(0.0, 4.0, 0.0);
                let child = sim.spawn((torus.clone(), place, ChildOf(body)));
                let other = if own_collider {
                    body
                } else {
                    sim.spawn((torus.clone(), ChildOf(body)))
                };
                if own_collider {
                    sim.set(body, torus.clone());
                }
                sim.step(8);
                change(&mut sim, body);
                for step in 0..5 {
                    sim.step(1);
                    let there = Vec3::X * 8.0 * DT;
                    for (collider, wanted) in [(child, there + place.translation), (other, there)] {
                        let found = on_device(&sim, collider);
                        assert!(
                            found.distance(wanted) < 1.0e-4,
                            "{readback:?}, {name}, own collider: {own_collider}, step {step}: {found} and not {wanted}"
                        );
                    }
                    assert_near(sim.position(body), there, 1.0e-4);
                }
            }
        }
    }
}

/// A static body that gets a collider below it, and one more while it is moved; then a body below it.
fn static_gains(_: &Gpu) {
    for readback in [Readback::Latent, Readback::Resident] {
        let mut sim = app(Backend::Gpu, readback);
        let cube = sim.mesh(&shapes::cube(1.0));
        let at = Transform::from_xyz(3.0, 0.0, 1.0).with_rotation(Quat::from_rotation_y(0.5));
        let wall = sim.spawn((RigidBody::Static, cube.clone(), at));
        let flier = sim.spawn(ball_like(&cube, Vec3::Y * 9.0, Vec3::X));
        sim.step(8);
        let below = Transform::from_xyz(0.0, 4.0, 0.0);
        let first = sim.spawn((cube.clone(), below, ChildOf(wall)));
        let check = |sim: &Sim, places: &[(Entity, Vec3)]| {
            for &(collider, wanted) in places {
                let found = on_device(sim, collider);
                assert!(
                    found.distance(wanted) < 1.0e-4,
                    "{readback:?}, {collider}: {found} and not {wanted}"
                );
            }
        };
        for _ in 0..5 {
            sim.step(1);
            check(
                &sim,
                &[(wall, at.translation), (first, at.transform_point(below.translation))],
            );
        }
        let there = at.with_translation(Vec3::new(-2.0, 1.0, 0.0));
        sim.world().get_mut::<Transform>(wall).unwrap().translation = there.translation;
        let beside = Transform::from_xyz(0.0, 0.0, 5.0);
        let second = sim.spawn((cube.clone(), beside, ChildOf(wall)));
        for _ in 0..5 {
            sim.step(1);
            check(
                &sim,
                &[
                    (wall, there.translation),
                    (first, there.transform_point(below.translation)),
                    (second, there.transform_point(beside.translation)),
                ],
            );
        }
        let behind = Transform::from_xyz(0.0, 0.0, -5.0);
        let body = sim.spawn((ball_like(&cube, behind.translation, Vec3::Y), ChildOf(wall)));
        for step in 1..6 {
            sim.step(1);
            let moved = there.transform_point(behind.translation) + Vec3::Y * step as f32 * DT;
            check(&sim, &[(wall, there.translation), (body, moved)]);
        }
        let flown = Vec3::new(23.0 * DT, 9.0, 0.0);
        assert_near(motion(&mut sim, flier).position, flown, 1.0e-4);
        assert_near(sim.position(wall), there.translation, 0.0);
    }
}

/// A body passes a thin sensor within the last step that is on its way.
fn hooks_appear(_: &Gpu) {
    for readback in [Readback::Lockstep, Readback::Latent] {
        let mut sim = with_contacts(readback).exact();
        let cube = sim.mesh(&shapes::cube(0.5));
        let body = sim.spawn(ball_like(&cube, Vec3::ZERO, Vec3::X * 64.0));
        let zone = sim.spawn((cube.clone(), Transform::from_xyz(6.5, 0.0, 0.0), Sensor));
        sim.step(8);
        let before = sim.report().step;
        add_hooks(&mut sim);
        sim.step(3);
        assert!(sim.report().gpu.is_none(), "it ran on the CPU");
        let wanted = if readback == Readback::Latent { 5 } else { 3 };
        assert_eq!(sim.report().step - before, wanted, "{readback:?}");
        let [started, ended] = [sim.started.len(), sim.ended.len()];
        assert_eq!([started, ended], [1, 1], "{readback:?}");
        assert!([sim.started[0].collider1, sim.started[0].collider2].contains(&zone));
        assert_near(sim.position(body), Vec3::X * 11.0, 1.0e-4);
    }
}

/// Two vehicles of three colliders each: one takes over a collider of the other.
fn turret(_: &Gpu) {
    for (readback, giver) in READBACKS
        .into_iter()
        .flat_map(|readback| [(readback, 0), (readback, 1)])
    {
        let mut sim = with_contacts(readback);
        let cube = sim.mesh(&shapes::cube(1.0));
        let mut vehicle = |x: f32| {
            let root = sim.spawn((
                RigidBody::Dynamic,
                Transform::from_xyz(x, 0.0, 0.0),
                CenterOfMass(Vec3::ZERO),
                LinearVelocity(Vec3::Z),
            ));
            let parts = [-1.0, 0.0, 1.0].map(|x| {
                let at = Transform::from_xyz(x, 0.0, 0.0);
                sim.spawn((cube.clone(), at, ChildOf(root)))
            });
            (root, parts)
        };
        let vehicles = [vehicle(0.0), vehicle(20.0)];
        sim.step(8);
        // Which of the two comes first depends on the order of entities.
        sim.set(vehicles[giver].1[0], ChildOf(vehicles[1 - giver].0));
        for step in 9..16 {
            sim.step(1);
            for ((body, _), x) in vehicles.into_iter().zip([0.0, 20.0]) {
                let found = motion(&mut sim, body).position;
                let wanted = Vec3::new(x, 0.0, step as f32 * DT);
                assert!(
                    found.distance(wanted) < 1.0e-3,
                    "{readback:?}, step {step}: {found} and not {wanted}"
                );
            }
        }
    }
}
