//! Bodies with continuous collision in steps on the device.

use super::bullets::{WAY, passed, plate, shoot, small_ball};
use super::hammers::put;
use super::parity::both;
use crate::world::World;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::gpu::buffers::Capacity;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::state::{Body, Motion};
use bevy_faceoff::step::gpu::GpuStep;
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

/// As many bullets at thin plates as a software driver takes in seconds.
pub fn pass_no_plate() {
    for (name, bullet, spin) in [
        ("ball", shapes::ball_320(), 10.0),
        ("torus that spins", shapes::torus_240(), 10.0),
    ] {
        for sizes in [5.0, 500.0] {
            let passed = passed(&bullet, sizes, spin, 100, true);
            assert_eq!(passed, 0, "{name}, {sizes} sizes per step");
        }
    }
    let passed = passed(&shapes::ball_320(), 50.0, 10.0, 50, false);
    assert!(passed > 25, "{passed} of 50 without continuous collision");
}

pub fn pass_no_plate_that_moves() {
    for (kind, velocity, spin) in [
        (RigidBody::Kinematic, Vec3::X * 1.5, Vec3::ZERO),
        (RigidBody::Kinematic, Vec3::X * -0.5, Vec3::ZERO),
        (RigidBody::Kinematic, Vec3::ZERO, Vec3::Z * 0.05),
        (RigidBody::Dynamic, Vec3::X * 0.5, Vec3::ZERO),
    ] {
        for speed in [20.0, 133.0, 400.0] {
            let plate = plate(kind, velocity, spin);
            let (through, _) = shoot(plate, &small_ball(), WAY * speed, Vec3::ZERO);
            assert!(
                !through,
                "at {speed} m/s, {kind:?} with {velocity} m/s and {spin} rad/s"
            );
        }
    }
}

/// Names of the bodies of [`alley`].
const AT_WALL: usize = 0;
const HEAD_ON: [usize; 2] = [1, 2];
const AT_CRATE: usize = 3;
const AT_LIFT: usize = 4;
const BULLETS: usize = 5;
/// What they meet: a wall, a crate and a lift.
const WALL: usize = 5;
const CRATE: usize = 6;
const LIFT: usize = 7;
/// A sensor before the wall, one behind it, and one between the two that meet head-on.
const GATES: [usize; 3] = [8, 9, 10];

/// Bullets of 10 cm that meet something in their fourth step, and sensors on their ways.
fn alley() -> World {
    let mut world = World::weightless();
    let (ball, cube) = (world.mesh(&shapes::ball(0.05, 2)), world.mesh(&shapes::cube(1.0)));
    let mut bullet = |at: Vec3, velocity: Vec3| {
        let mut body = Body {
            linear_velocity: velocity,
            ..Body::at_rest(ball, at, Quat::from_rotation_y(0.3), Vec3::ONE)
        };
        body.params.continuous = true;
        world.put(&body);
    };
    bullet(Vec3::new(-12.0, 0.01, 0.02), Vec3::X * 200.0);
    bullet(Vec3::new(-8.0, 10.01, 0.0), Vec3::X * 150.0);
    bullet(Vec3::new(8.0, 9.99, 0.01), Vec3::X * -150.0);
    bullet(Vec3::new(-12.0, 20.1, 0.1), Vec3::X * 200.0);
    bullet(Vec3::new(0.0, 42.0, 0.0), Vec3::Y * -200.0);
    let thin = Vec3::new(0.01, 3.0, 3.0);
    world.add(RigidBody::Static, cube, thin, Vec3::ZERO, Quat::IDENTITY);
    world.add(
        RigidBody::Dynamic,
        cube,
        Vec3::splat(0.5),
        Vec3::Y * 20.0,
        Quat::IDENTITY,
    );
    world.put(&Body {
        kind: RigidBody::Kinematic,
        // Slow enough for one collision substep, which all bodies share on a GPU.
        linear_velocity: Vec3::Y * 0.1,
        ..Body::at_rest(cube, Vec3::Y * 30.0, Quat::IDENTITY, Vec3::new(3.0, 0.01, 3.0))
    });
    for at in [Vec3::X * -1.0, Vec3::X, Vec3::Y * 10.0] {
        world.put(&Body {
            kind: RigidBody::Static,
            sensor: true,
            ..Body::at_rest(cube, at, Quat::IDENTITY, Vec3::new(0.2, 2.0, 2.0))
        });
    }
    world
}

/// Colliders, and whether one passed the other, with where they touched.
type Touch = ([u32; 2], bool, Vec3);

fn touches(world: &World) -> Vec<Touch> {
    let pairs = &world.state.results.contacts.pairs;
    pairs
        .iter()
        .map(|pair| (pair.bodies, pair.passing, pair.contact.point))
        .collect()
}

/// Until they have met something both sides agree; then nothing has passed on either.
pub fn stop_as_on_the_cpu() {
    let mut worlds = both(alley);
    let mut passing = 0;
    for step in 0..4 {
        worlds.iter_mut().for_each(World::step);
        let [cpu, gpu] = &worlds;
        for i in 0..=LIFT {
            let off = cpu.center(i).distance(gpu.center(i));
            let velocity = cpu.velocity(i).distance(gpu.velocity(i));
            assert!(
                off < 1.0e-4 && velocity < 1.0e-3,
                "step {step}, body {i}: {off} m, {velocity} m/s"
            );
        }
        let [of_cpu, of_gpu] = [cpu, gpu].map(touches);
        assert_eq!(of_cpu.len(), of_gpu.len(), "{of_cpu:?} {of_gpu:?}");
        for (a, b) in of_cpu.iter().zip(&of_gpu) {
            assert_eq!((a.0, a.1), (b.0, b.1), "step {step}");
            assert!(a.2.distance(b.2) < 1.0e-3, "step {step}: {a:?} {b:?}");
        }
        passing += of_gpu.iter().filter(|touch| touch.1).count();
    }
    let gate = |world: &World, number: usize| touches(world).iter().any(|touch| touch.0[1] as usize == GATES[number]);
    assert!(passing >= 2, "{passing} sensors passed");
    for step in 4..10 {
        worlds.iter_mut().for_each(World::step);
        for world in &worlds {
            // After an impact another one is likely.
            assert!(step > 4 || world.state.results.collision_substeps > 1);
            assert!(!gate(world, 1), "the sensor behind the wall notices nothing");
        }
    }
    for (side, world) in worlds.iter().enumerate() {
        let [wall, crate_, lift] = [WALL, CRATE, LIFT].map(|i| world.center(i));
        assert!(world.center(AT_WALL).x < wall.x, "side {side}");
        // What is left goes along the surfaces of both, which did not meet with their middles.
        let approach = world.velocity(HEAD_ON[0]).x - world.velocity(HEAD_ON[1]).x;
        assert!(approach < 100.0, "side {side}: {approach} m/s of 300");
        assert!(world.center(AT_CRATE).x < crate_.x, "side {side}");
        assert!(world.center(AT_LIFT).y > lift.y, "side {side}");
        assert!(world.velocity(CRATE).x > 0.1, "side {side}: the crate was hit");
        for i in 0..BULLETS {
            assert!(world.velocity(i).length() < 120.0, "side {side}: {i} was stopped");
        }
    }
    let [cpu, gpu] = worlds.each_ref().map(|world| world.velocity(CRATE));
    assert!(cpu.distance(gpu) < 0.05 * cpu.length(), "{cpu} {gpu}");
}

/// A body of two balls, and a thin wall that only one of them meets.
pub fn stop_with_all_their_colliders() {
    for spin in [0.0, 40.0] {
        let mut worlds = both(|| {
            let mut world = World::weightless();
            let (ball, cube) = (world.mesh(&shapes::ball(0.1, 2)), world.mesh(&shapes::cube(1.0)));
            // So that numbers of colliders and bodies differ.
            world.add(RigidBody::Static, cube, Vec3::ONE, Vec3::Y * 50.0, Quat::IDENTITY);
            let ends = [Vec3::Y, Vec3::NEG_Y].map(|end| (ball, (0.5 * end, Quat::IDENTITY), Vec3::ONE));
            let mut body = Body {
                linear_velocity: Vec3::X * 300.0,
                angular_velocity: Vec3::Z * spin,
                ..Body::at_rest(ball, Vec3::NEG_X * 4.0, Quat::IDENTITY, Vec3::ONE)
            };
            body.params.continuous = true;
            put(&mut world, &body, None, &ends);
            let thin = Vec3::new(0.01, 0.8, 0.8);
            world.add(RigidBody::Static, cube, thin, Vec3::Y * 0.5, Quat::IDENTITY);
            world
        });
        worlds.iter_mut().for_each(World::step);
        let [cpu, gpu] = worlds.each_ref().map(|world| [1, 2].map(|i| world.center(i)));
        assert!(gpu[0].x < 0.0, "spin {spin}: {gpu:?}");
        for (a, b) in cpu.iter().zip(gpu) {
            assert!(a.distance(b) < 1.0e-3, "spin {spin}: {cpu:?} {gpu:?}");
        }
    }
}

/// Lists that grow in the midst of a flight change no bit, nor which sensors are passed.
pub fn overflow(gpu: &Gpu) {
    let [one, other] = [1, 512].map(|length| {
        let mut world = alley();
        let capacity = Capacity {
            pairs: length,
            hits: length,
            plane_contacts: length,
            ..Capacity::default()
        };
        world.device = Some(GpuStep::with_capacity(gpu.clone(), capacity).unwrap());
        let mut history: Vec<(Vec<Motion>, Vec<Touch>)> = Vec::new();
        for _ in 0..8 {
            world.step();
            let bodies = &world.state.input.bodies;
            history.push(((0..bodies.len()).map(|i| bodies.motion(i)).collect(), touches(&world)));
        }
        history
    });
    assert_eq!(one, other);
    assert!(one.iter().any(|(_, touches)| touches.iter().any(|touch| touch.1)));
}

/// Bodies far from everything cost a wait, but nothing is read of them. Without fast bodies there is neither.
pub fn read_little(gpu: &Gpu) {
    let mut world = World::weightless();
    let ball = world.mesh(&shapes::ball(0.05, 2));
    for i in 0..200 {
        world.add(
            RigidBody::Dynamic,
            ball,
            Vec3::ONE,
            Vec3::X * (9.0 * i as f32),
            Quat::IDENTITY,
        );
    }
    let mut work = [false, true].map(|continuous| {
        world.device = Some(GpuStep::new(gpu.clone()).unwrap());
        world.state.input.bodies.params[0].continuous = continuous;
        world.step();
        world.step();
        world.state.results.gpu.unwrap()
    });
    let [without, with] = &mut work;
    assert_eq!(without.submissions, 1);
    assert_eq!(with.submissions, 2, "one more, and its wait");
    let bytes = with.read_back_bytes - without.read_back_bytes;
    assert!(bytes <= 128, "{bytes} more bytes");
    assert_eq!(with.dispatches, without.dispatches);
}
