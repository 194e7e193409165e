//! How many collision substeps a step has: as many as the bodies need that can meet in it.

use super::compounds::rows;
use super::hammers::{hammer, hammer_at, put};
use super::parity::both;
use crate::world::World;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::{Body, Plane};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::gpu_work::GpuWork;
use glam::{Quat, Vec3};

fn substeps(world: &World) -> u32 {
    world.state.results.collision_substeps
}

/// The mean number of the bodies that move.
fn mean(world: &World) -> f32 {
    world.state.results.mean_collision_substeps
}

fn work(world: &World) -> GpuWork {
    world.state.results.gpu.expect("the step ran on the device")
}

/// A formation of balls flies past a level, through a sensor and over a floor far below. With `obstacle` there is a plate in
/// its way.
fn formation(speed: f32, obstacle: bool) -> World {
    let mut world = World::weightless();
    let [ball, cube, level] = [shapes::ball(0.1, 2), shapes::cube(1.0), shapes::ring()].map(|mesh| world.mesh(&mesh));
    for i in 0..9 {
        let at = Vec3::new(1.2 * (i % 3) as f32, 1.2 * (i / 3) as f32, 0.0);
        world.put(&Body {
            linear_velocity: Vec3::X * speed,
            ..Body::at_rest(ball, at, Quat::IDENTITY, Vec3::ONE)
        });
    }
    let mut fixed = |mesh, at, scale| world.add(RigidBody::Static, mesh, scale, at, Quat::IDENTITY);
    // They fly through the bounding sphere of the ring.
    fixed(level, Vec3::ZERO, Vec3::splat(60.0));
    let gate = fixed(cube, Vec3::X * 4.0, Vec3::new(0.1, 6.0, 6.0));
    if obstacle {
        fixed(cube, Vec3::X * 8.0, Vec3::new(0.05, 6.0, 6.0));
    }
    world.state.input.bodies.sensor[gate] = true;
    world.state.input.planes.push(Plane {
        distance: -20.0,
        ..Plane::default()
    });
    world
}

/// A step takes no more dispatches for how fast bodies are that meet nothing.
pub fn meets_nothing() {
    let [mut slow, mut fast] = [0.0, 60.0].map(|speed| formation(speed, false));
    slow.step();
    let dispatches = work(&slow).dispatches;
    // The first step knows of none before it.
    fast.step();
    for step in 0..10 {
        fast.step();
        assert_eq!(substeps(&fast), 1, "step {step}");
        let work = work(&fast);
        assert_eq!(work.submissions, 1, "step {step}");
        // With the ring and the gate, and not with each other.
        assert!(work.lists.sphere_pairs.length <= 18, "{:?}", work.lists);
        assert!(
            work.dispatches <= dispatches + 25,
            "{} and {dispatches}",
            work.dispatches
        );
    }
    for i in 0..9 {
        assert!((fast.velocity(i) - Vec3::X * 60.0).length() < 1.0e-3, "body {i}");
    }
}

/// What meets something has as many as on the CPU, and is stopped.
pub fn meets_a_plate() {
    let mut worlds = both(|| formation(60.0, true));
    let (mut most, mut repeated) = (1, 0);
    for step in 0..12 {
        worlds.iter_mut().for_each(World::step);
        let [of_cpu, of_gpu] = worlds.each_ref().map(substeps);
        if most == 1 {
            assert_eq!(of_cpu, of_gpu, "until the impact, step {step}");
        }
        most = most.max(of_gpu);
        repeated += u32::from(work(&worlds[1]).submissions > 1);
    }
    println!("up to {most} collision substeps, {repeated} steps repeated");
    assert_eq!(most, 8);
    assert!(repeated > 0, "the first impact was not foreseen");
    for world in &worlds {
        for i in 0..9 {
            assert!(world.center(i).x < 8.0, "body {i} is in front of the plate");
        }
    }
}

/// Hammers and balls that turn, fly at a floor and at each other: step by step from the same poses.
pub fn as_on_the_cpu() {
    let mut worlds = both(|| {
        let mut world = World::new();
        let ball = world.mesh(&shapes::ball(0.2, 2));
        let cube = world.mesh(&shapes::cube(1.0));
        world.floor(cube);
        for i in 0..4 {
            let at = Vec3::new(3.0 * i as f32, 3.0 + i as f32, 0.0);
            let body = Body {
                angular_velocity: Vec3::new(3.0, 1.0, 20.0),
                ..Body::at_rest(cube, at, Quat::from_rotation_x(i as f32), Vec3::ONE)
            };
            put(&mut world, &body, None, &hammer(cube));
        }
        for i in 0..6 {
            world.put(&Body {
                linear_velocity: Vec3::new(-12.0, 0.0, 0.0),
                ..Body::at_rest(
                    ball,
                    Vec3::new(4.0 + 4.0 * i as f32, 2.0, 0.3),
                    Quat::IDENTITY,
                    Vec3::ONE,
                )
            });
        }
        world
    });
    let mut seen = Vec::new();
    for step in 0..70 {
        worlds.iter_mut().for_each(World::step);
        let [of_cpu, of_gpu] = worlds.each_ref().map(substeps);
        assert_eq!(of_cpu, of_gpu, "step {step}, after {seen:?}");
        seen.push(of_gpu);
        let [cpu, gpu] = &mut worlds;
        gpu.state.input.bodies.set_motions(&rows(cpu));
        gpu.place_frames();
    }
    assert!(seen.iter().any(|&count| count > 3) && seen.contains(&1), "{seen:?}");
}

/// Some pairs of balls that fly at each other, each pair with another speed, far from the others. Beside each of them a third
/// ball rests.
fn pairs_of_balls(apart: f32) -> World {
    let mut world = World::weightless();
    let ball = world.mesh(&shapes::ball(0.1, 2));
    let mut put = |at: Vec3, velocity: Vec3| {
        world.put(&Body {
            linear_velocity: velocity,
            ..Body::at_rest(ball, at, Quat::IDENTITY, Vec3::ONE)
        })
    };
    for i in 0..6 {
        let (at, velocity) = (Vec3::Y * apart * i as f32, Vec3::X * (1.0 + 4.0 * i as f32));
        put(at - Vec3::X, velocity);
        put(at + Vec3::X, -velocity);
        put(at + Vec3::Z * 0.4, Vec3::ZERO);
    }
    world
}

/// The numbers of collision substeps of 40 steps of [`pairs_of_balls`]: the largest and the mean, which are the CPU's from the
/// same poses.
fn numbers_as_on_the_cpu(apart: f32) -> Vec<(u32, f32)> {
    let mut worlds = both(|| pairs_of_balls(apart));
    let numbers = (0..40).map(|step| {
        worlds.iter_mut().for_each(World::step);
        let [of_cpu, of_gpu] = worlds.each_ref().map(|world| (substeps(world), mean(world)));
        assert_eq!(of_cpu, of_gpu, "step {step}");
        let [cpu, gpu] = &mut worlds;
        gpu.state.input.bodies.set_motions(&rows(cpu));
        gpu.place_frames();
        of_gpu
    });
    numbers.collect()
}

/// Each pair takes as many collision substeps as its own speed asks for.
pub fn groups_as_on_the_cpu() {
    let numbers = numbers_as_on_the_cpu(10.0);
    assert!(
        numbers.iter().any(|&(most, mean)| most > 4 && mean < 2.0),
        "{numbers:?}"
    );
}

/// Pairs are so near each other that impulses could bring them together: they wait for each other.
pub fn groups_near_each_other() {
    let numbers = numbers_as_on_the_cpu(0.8);
    assert!(numbers.iter().any(|&(_, mean)| mean > 3.0), "{numbers:?}");
}

/// What falls onto a floor, a half-space and each other, sleeps, and is hit.
fn busy() -> World {
    let mut world = World::new();
    world.state.input.config.solver.sleeping = true;
    let [ball, cube, torus] =
        [shapes::ball(0.15, 2), shapes::cube(1.0), shapes::torus_240()].map(|mesh| world.mesh(&mesh));
    world.floor(cube);
    world.state.input.planes.push(Plane {
        distance: -0.2,
        ..Plane::default()
    });
    for i in 0..4 {
        let at = Vec3::new(2.5 * i as f32, 0.55, 0.0);
        world.add(
            RigidBody::Dynamic,
            cube,
            Vec3::splat(0.5),
            at - Vec3::Y * 0.3,
            Quat::IDENTITY,
        );
        world.add(
            RigidBody::Dynamic,
            torus,
            Vec3::splat(0.4),
            at + Vec3::Z,
            Quat::from_rotation_x(0.4 * i as f32),
        );
        // Beside the floor, on the half-space alone.
        let beside = at + Vec3::new(30.0, -0.4, 0.0);
        world.add(
            RigidBody::Dynamic,
            torus,
            Vec3::splat(0.4),
            beside,
            Quat::from_rotation_z(0.3 * i as f32),
        );
        world.put(&Body {
            linear_velocity: Vec3::new(0.0, -10.0 * i as f32, -20.0),
            ..Body::at_rest(
                ball,
                at + Vec3::new(0.1, 2.0, 6.0 + 4.0 * i as f32),
                Quat::IDENTITY,
                Vec3::ONE,
            )
        });
    }
    let at = Vec3::new(-3.0, 1.5, 0.0);
    let body = Body::at_rest(cube, at, Quat::from_rotation_x(0.7), Vec3::ONE);
    put(&mut world, &body, None, &hammer(cube));
    world
}

/// A hammer and a thin plate come to rest on a floor. With `flies` a fast ball is far above them, so that a GPU counts
/// collision substeps in every step.
fn lies_down(flies: bool) -> World {
    let mut world = World::new();
    world.state.input.config.solver.sleeping = true;
    let [cube, ball] = [shapes::cube(1.0), shapes::ball(0.1, 2)].map(|mesh| world.mesh(&mesh));
    world.floor(cube);
    hammer_at(&mut world, Vec3::Y * 0.5, Quat::from_rotation_z(1.3));
    world.add(
        RigidBody::Dynamic,
        cube,
        Vec3::new(0.3, 0.001, 0.3),
        Vec3::new(3.0, 0.02, 0.0),
        Quat::from_rotation_z(0.05),
    );
    if flies {
        world.put(&Body {
            linear_velocity: Vec3::X * 60.0,
            ..Body::at_rest(ball, Vec3::Y * 1000.0, Quat::IDENTITY, Vec3::ONE)
        });
    }
    world
}

/// Motions, sleep and reports of both worlds have the same bits.
fn assert_same(worlds: &[World; 2], step: usize) {
    let [few, many] = worlds.each_ref().map(|world| {
        let results = &world.state.results;
        let pairs = (&results.sphere_pairs, results.approximate_pairs);
        let reported = format!("{:?} {:?} {pairs:?}", results.contacts, results.manifolds);
        (rows(world), substeps(world), results.asleep.clone(), reported)
    });
    assert!(few == many, "step {step}");
}

/// Two equal worlds; one has commands for three collision substeps more than the last steps suggest.
fn without_and_with_spare_substeps(world: impl Fn() -> World) -> [World; 2] {
    let mut worlds = [world(), world()];
    let device = worlds[1].device.take().expect("it runs on the device");
    worlds[1].device = Some(device.with_spare_substeps(3));
    worlds
}

/// Bodies fall asleep in the same step at the same poses, and rest in the same way.
pub fn asleep_with_spare_substeps() {
    for flies in [false, true] {
        let mut worlds = without_and_with_spare_substeps(|| lies_down(flies));
        let mut asleep_since = None;
        for step in 0..500 {
            worlds.iter_mut().for_each(World::step);
            assert_same(&worlds, step);
            // The two of the hammer, and the plate.
            if worlds[0].state.results.asleep[1..4] == [true; 3] {
                asleep_since.get_or_insert(step);
            }
            if asleep_since.is_some_and(|since| since + 10 < step) {
                break;
            }
        }
        println!("asleep since step {asleep_since:?}");
        assert!(asleep_since.is_some());
    }
}

/// Collision substeps that are recorded and not needed change nothing, to the bit.
pub fn same_with_spare_substeps() {
    let mut worlds = without_and_with_spare_substeps(busy);
    let (mut counts, mut dispatches) = (Vec::new(), [0; 2]);
    for step in 0..90 {
        worlds.iter_mut().for_each(World::step);
        assert_same(&worlds, step);
        for (sum, world) in dispatches.iter_mut().zip(&worlds) {
            *sum += work(world).dispatches;
        }
        counts.push(substeps(&worlds[0]));
    }
    counts.dedup();
    println!("{counts:?} collision substeps, {dispatches:?} dispatches");
    assert!(counts.len() > 6, "{counts:?}");
    assert!(dispatches[0] < dispatches[1]);
}
