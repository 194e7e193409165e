//! Which bodies the device freezes, and what wakes them.

use super::shapes::Shape;
use super::twin::Twin;
use super::world::World;
use bevy_faceoff::gpu::device::Gpu;
use bevy_faceoff::manifolds::{Manifold, ManifoldPoint};
use bevy_faceoff::solver::CollisionSubstep;
use bevy_faceoff::types::body::{ExternalForces, RigidBody};
use glam::{DVec3, Vec3};

const CUBE: Shape = Shape::Box(DVec3::splat(0.5));
const GAP: f64 = 0.000866;
const ALL: [usize; 6] = [1, 2, 3, 4, 5, 6];

/// A stack of five on a floor (body 0), and another body far away.
fn stack() -> World {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    world.floor(0.0);
    for i in 0..5 {
        world.dynamic(CUBE, 1.0, DVec3::Y * (0.5 + GAP + i as f64 * (1.0 + GAP)));
    }
    world.dynamic(CUBE, 1.0, DVec3::new(10.0, 0.5 + GAP, 0.0));
    world
}

fn asleep(world: &World) -> Vec<usize> {
    (0..world.shapes.len())
        .filter(|&i| world.bodies.sleep[i].asleep)
        .collect()
}

/// The stack on the device, asleep since it was on the CPU.
fn sleeping_stack(gpu: &Gpu) -> Twin {
    let mut world = stack();
    world.step(96);
    let mut twin = Twin::new(gpu, world);
    twin.step(2);
    assert_eq!(asleep(&twin.world), ALL);
    twin
}

pub fn a_stack_falls_asleep_as_on_the_cpu(gpu: &Gpu) {
    let mut cpu = stack();
    let mut twin = Twin::new(gpu, stack());
    // The first step after which each body slept.
    let mut since = [[0usize; 7]; 2];
    for step in 1..=96 {
        cpu.step(1);
        twin.step(1);
        for (since, world) in since.iter_mut().zip([&cpu, &twin.world]) {
            for i in asleep(world) {
                if since[i] == 0 {
                    since[i] = step;
                }
            }
        }
    }
    println!("asleep since {since:?}");
    for (one, other) in since[0].iter().zip(since[1]) {
        assert!(one.abs_diff(other) <= 2, "{since:?}");
    }
    assert_eq!(asleep(&twin.world), ALL);
    let motions = twin.world.bodies.motions.clone();
    twin.step(64);
    assert_eq!(asleep(&twin.world), ALL);
    assert_eq!(twin.world.bodies.motions, motions);
    assert!(ALL.iter().all(|&i| twin.world.velocity(i) == Vec3::ZERO));
}

pub fn a_hit_wakes_the_whole_stack_and_nothing_else(gpu: &Gpu) {
    let mut twin = sleeping_stack(gpu);
    let world = &mut twin.world;
    let ball = world.dynamic(Shape::Sphere(0.3), 1.0, DVec3::new(-2.0, 4.5, 0.0));
    world.motion(ball).linear_velocity = Vec3::X * 5.0;
    world.bodies.bodies[ball].gravity_scale = 0.0;
    twin.put();
    twin.step(8);
    assert_eq!(asleep(&twin.world), ALL, "not yet there");
    twin.step(30);
    assert_eq!(asleep(&twin.world), [6]);
    assert!(twin.world.center(5).x > 0.05, "it was pushed");
}

pub fn what_else_wakes(gpu: &Gpu) {
    let wakes: [fn(&mut World); 4] = [
        |world| world.bodies.forces[3].impulse = Vec3::X * 0.1,
        |world| world.bodies.forces[3].torque = Vec3::X * 0.1,
        |world| world.motion(3).linear_velocity = Vec3::X * 0.1,
        // The lowest box goes.
        |world| world.motion(1).center.x = 50.0,
    ];
    for wake in wakes {
        let mut twin = sleeping_stack(gpu);
        wake(&mut twin.world);
        twin.put();
        twin.step(2);
        assert_eq!(asleep(&twin.world), [6]);
        twin.world.bodies.forces[3] = ExternalForces::default();
        twin.put();
        twin.step(4);
        assert_eq!(asleep(&twin.world), [6], "it takes longer to fall asleep");
    }
    let mut twin = sleeping_stack(gpu);
    twin.world.settings.sleep_time = 0.0;
    twin.world.collision_substeps = Some(1);
    twin.world.motion(3).linear_velocity = Vec3::X * 1.0e-3;
    twin.put();
    twin.step(1);
    assert_eq!(
        asleep(&twin.world),
        [6],
        "what woke stays awake until the next collision substep"
    );
    twin.step(1);
    assert_eq!(asleep(&twin.world), ALL);
    let mut twin = sleeping_stack(gpu);
    twin.world.settings.sleeping = false;
    twin.step(1);
    assert_eq!(asleep(&twin.world), [0; 0], "switched off");
}

/// Bodies at rest that touch at random, some of which are kept awake.
fn web() -> World {
    let mut world = World::new();
    world.settings.sleeping = true;
    world.settings.sleep_time = 0.0;
    world.collision_substeps = Some(1);
    let mut random = fastrand::Rng::with_seed(6);
    for i in 0..3000 {
        world.dynamic(CUBE, 1.0, DVec3::X * f64::from(i));
        world.bodies.sleep[i as usize].rest_time = 1.0;
        if random.u32(0..100) == 0 {
            world.bodies.forces[i as usize].torque = Vec3::X * 1.0e-6;
        }
    }
    let mut pairs: Vec<[u32; 2]> = (0..2800)
        .map(|_| [random.u32(0..3000), random.u32(0..3000)])
        .filter(|[a, b]| a < b)
        .collect();
    // A chain, from the last to the first.
    pairs.extend((100..400).map(|i| [i, i + 1]));
    pairs.sort_unstable();
    pairs.dedup();
    for (i, &bodies) in (0..).zip(&pairs) {
        world.manifolds.pairs.push(Manifold {
            bodies,
            first_point: i,
            point_count: 1,
        });
        // Near enough to touch, and too far away to push.
        world.manifolds.points.push(ManifoldPoint {
            anchors: [Vec3::Y, Vec3::Y],
            normal: Vec3::Y,
            separation: 0.003,
            curvature_radii: [0.0; 2],
            bulge: 0.0,
            normal_rotation: 0.0,
            faces: [0; 2],
        });
    }
    world
}

pub fn islands_are_those_of_the_cpu(gpu: &Gpu) {
    let mut cpu = web();
    let mut twin = Twin::new(gpu, web());
    let collision_substep = CollisionSubstep {
        dt: cpu.dt,
        substeps: 1,
        gravity: Vec3::ZERO,
    };
    for round in 0..4 {
        cpu.solve(&collision_substep);
        twin.solve(&collision_substep);
        let sleepers = asleep(&twin.world);
        println!("round {round}: {} of 3000 asleep", sleepers.len());
        assert_eq!(sleepers, asleep(&cpu));
        assert!((200..2900).contains(&sleepers.len()));
        // One in the chain, and others as it comes.
        for i in (250..3000).step_by(700) {
            for world in [&mut cpu, &mut twin.world] {
                world.bodies.forces[i].torque = Vec3::X * 1.0e-6 * (round % 2) as f32;
            }
        }
        twin.put();
    }
}

pub fn a_kinematic_body_wakes_what_lies_on_it(gpu: &Gpu) {
    let mut world = World::heavy();
    world.settings.sleeping = true;
    let platform = Shape::Box(DVec3::new(3.0, 0.25, 3.0));
    let platform = world.immovable(platform, RigidBody::Kinematic, DVec3::Y * -0.25);
    let cube = world.dynamic(CUBE, 1.0, DVec3::Y * (0.5 + GAP));
    let mut twin = Twin::new(gpu, world);
    twin.step(96);
    assert_eq!(asleep(&twin.world), [cube]);
    twin.world.motion(platform).linear_velocity = Vec3::X * 0.02;
    twin.put();
    twin.step(96);
    assert_eq!(asleep(&twin.world), [0; 0], "slow as it is, what it carries moves");
    assert!((twin.world.velocity(cube).x - 0.02).abs() < 1.0e-3);
}
