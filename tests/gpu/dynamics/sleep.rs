//! Who sleeps, and what goes on from step to step.

use crate::world::{GAP, World};
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::Body;
use bevy_faceoff::step::gpu::memory::DeviceMemory;
use bevy_faceoff::step::gpu::results::{Detail, Output};
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

/// Three cubes on each other, on a floor; they may sleep. Body 0 is the floor.
fn stack() -> World {
    let mut world = World::new();
    world.state.input.config.solver.sleeping = true;
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    for i in 0..3 {
        let at = Vec3::Y * (0.5 + GAP + (1.0 + GAP) * i as f32);
        world.add(RigidBody::Dynamic, cube, Vec3::ONE, at, Quat::IDENTITY);
    }
    world
}

fn asleep(world: &World) -> usize {
    world.state.results.asleep.iter().filter(|&&asleep| asleep).count()
}

/// Lets all fall asleep; tells after how many steps.
fn fall_asleep(world: &mut World) -> usize {
    for step in 0..200 {
        world.step();
        if asleep(world) == 3 {
            return step;
        }
    }
    panic!("{} of 3 sleep", asleep(world));
}

pub fn falls_asleep_and_wakes() {
    let mut world = stack();
    let steps = fall_asleep(&mut world);
    println!("asleep after {steps} steps");
    assert!(steps > 30, "it takes half a second");
    let before: Vec<_> = (1..4).map(|i| world.state.input.bodies.motion(i)).collect();
    for _ in 0..20 {
        world.step();
        assert_eq!(asleep(&world), 3);
    }
    let after: Vec<_> = (1..4).map(|i| world.state.input.bodies.motion(i)).collect();
    assert_eq!(before, after, "what sleeps does not move by a bit");
    let points = world.state.results.manifolds.points.len();
    assert!(points >= 12, "{points} points");
    {
        let device = world.device.as_mut().unwrap();
        device.submit(&world.state.input, &[], Detail::All).unwrap();
        let output = device.take().unwrap().unwrap();
        assert_eq!(output.near_triangles, 0, "nobody looks at what sleeps");
        assert_eq!(output.manifolds.points.len(), points, "which keeps its points");
    }

    world.state.input.bodies.params[3].forces.impulse = Vec3::X * 0.5;
    world.step();
    world.state.input.bodies.params[3].forces.impulse = Vec3::ZERO;
    assert_eq!(asleep(&world), 0, "a push wakes the island");
    assert!(world.velocity(3).x > 0.01);

    fall_asleep(&mut world);
    world.state.input.bodies.params[2].woken = true;
    world.step();
    world.state.input.bodies.params[2].woken = false;
    assert_eq!(asleep(&world), 0, "who is woken wakes the others");

    fall_asleep(&mut world);
    world.state.input.config.gravity = Vec3::NEG_Y * 5.0;
    world.step();
    assert_eq!(asleep(&world), 0, "another gravity wakes all");
}

/// Steps at rest are not submitted, and have the results of those that are.
pub fn nothing_runs_while_all_sleep() {
    let mut world = stack();
    world.step();
    println!("awake: {} dispatches", world.state.results.gpu.unwrap().dispatches);
    fall_asleep(&mut world);
    // Speeds may have asked for several collision substeps, and the step before was not at rest from its beginning.
    (0..3).for_each(|_| world.step());
    let idle = |world: &World| {
        let work = world.state.results.gpu.unwrap();
        (
            work.dispatches,
            work.submissions,
            work.read_back_bytes,
            work.uploaded_bytes,
        ) == (0, 0, 0, 0)
    };
    for _ in 0..5 {
        world.step();
        assert!(idle(&world), "{:?}", world.state.results.gpu);
        assert_eq!(asleep(&world), 3);
    }
    let (device, input) = (world.device.as_mut().unwrap(), &world.state.input);
    let mut submit = |detail| {
        device.submit(input, &[], detail).unwrap();
        device.take().unwrap().unwrap()
    };
    // Counts are other results than were read last, so this step runs, and so does the one after it.
    let (at_rest, counted, run) = (submit(Detail::All), submit(Detail::Counts), submit(Detail::All));
    assert_eq!(at_rest.work.dispatches, 0);
    assert!(counted.work.dispatches > 20 && run.work.dispatches > 20);
    let all = |output: &Output| {
        format!(
            "{:?} {:?} {:?} {:?} {:?}",
            output.motions, output.sphere_pairs, output.contacts, output.manifolds, output.asleep
        )
    };
    assert!(at_rest.contacts.pairs.len() == 3 && at_rest.manifolds.points.len() >= 12);
    assert_eq!(all(&at_rest), all(&run));

    // Whatever the host changes is seen.
    world.step();
    assert!(idle(&world));
    world.state.input.bodies.params[1].woken = true;
    world.step();
    world.state.input.bodies.params[1].woken = false;
    assert!(!idle(&world) && asleep(&world) == 0);
    fall_asleep(&mut world);
    (0..3).for_each(|_| world.step());
    assert!(idle(&world));
    world.state.input.config.solver.sleeping = false;
    world.step();
    assert!(!idle(&world) && asleep(&world) == 0, "bodies may sleep no more");
}

/// The memory of the device goes to the CPU and back. What sleeps sleeps on, on either side.
pub fn moves_to_the_cpu_and_back() {
    let mut world = stack();
    fall_asleep(&mut world);
    let before: Vec<_> = (1..4).map(|i| world.state.input.bodies.motion(i)).collect();
    let mut device = world.device.take().unwrap();
    let memory = device.memory().unwrap();
    (world.state.memory, world.state.results.manifolds) = memory.to_cpu();
    for _ in 0..20 {
        world.step();
        assert_eq!(asleep(&world), 3, "on the CPU");
    }
    let back = DeviceMemory::from_cpu(&world.state.memory, &world.state.results.manifolds);
    assert_eq!(
        back.to_cpu(),
        (world.state.memory.clone(), world.state.results.manifolds.clone())
    );
    device.remember(&back).unwrap();
    world.device = Some(device);
    for _ in 0..20 {
        world.step();
        assert_eq!(asleep(&world), 3, "on the device again");
    }
    let after: Vec<_> = (1..4).map(|i| world.state.input.bodies.motion(i)).collect();
    assert_eq!(before, after, "what sleeps does not move by a bit");
}

pub fn wakes_when_ground_goes() {
    let mut world = stack();
    fall_asleep(&mut world);
    // The floor stays where it touches, and is another one all the same.
    world.state.input.bodies.position[0].x += 0.5;
    world.place_frames();
    world.step();
    assert_eq!(asleep(&world), 0, "a ground that is elsewhere wakes those on it");
    fall_asleep(&mut world);
    world.state.input.bodies.position[0].y -= 5.0;
    world.place_frames();
    for _ in 0..10 {
        world.step();
    }
    assert_eq!(asleep(&world), 0);
    assert!(world.velocity(1).y < -1.0, "they fall");
}

/// Bodies in the middle go, others come: those that stay go on as they were.
pub fn numbers_change() {
    let mut world = stack();
    world.state.input.keys = vec![10, 20, 30, 40];
    fall_asleep(&mut world);
    // A body far away gets number 1, and all others a higher one.
    let cube = world.state.input.bodies.mesh[0];
    let old = std::mem::take(&mut world.state.input.bodies);
    let kinds = [
        RigidBody::Static,
        RigidBody::Dynamic,
        RigidBody::Dynamic,
        RigidBody::Dynamic,
        RigidBody::Dynamic,
    ];
    for (number, kind) in kinds.into_iter().enumerate() {
        let was = [Some(0), None, Some(1), Some(2), Some(3)][number];
        let (at, turn, scale) = was.map_or((Vec3::X * 9.0 + Vec3::Y * 9.0, Quat::IDENTITY, Vec3::ONE), |i| {
            (old.position[i], old.rotation[i], old.scale[i])
        });
        world.add(kind, cube, scale, at, turn);
    }
    world.state.input.keys = vec![10, 15, 20, 30, 40];
    world.step();
    assert_eq!(world.state.results.asleep, [false, false, true, true, true]);
    assert!(world.velocity(1).y < 0.0, "the new one falls");
    assert_eq!(world.state.input.bodies.position[4], old.position[3]);
}

/// A mesh whose centre of mass is not its origin, in another size from one step to the next.
pub fn sizes_change() {
    let mut world = World::weightless();
    let cube = shapes::cube(1.0);
    let beside = cube.vertices().iter().map(|vertex| *vertex + Vec3::X).collect();
    let mesh = world.mesh(&TriMesh::new(beside, cube.triangles().to_vec()).unwrap());
    let body = Body {
        linear_velocity: Vec3::Y,
        ..Body::at_rest(mesh, Vec3::ZERO, Quat::from_rotation_z(0.3), Vec3::ONE)
    };
    world.put(&body);
    world.step();
    let then = world.state.input.bodies.motion(0);
    world.state.input.bodies.clear();
    world.put(&Body {
        position: then.position,
        rotation: then.rotation,
        linear_velocity: then.linear_velocity,
        scale: Vec3::splat(2.0),
        ..body
    });
    world.step();
    let wanted = then.position + Vec3::Y / 64.0;
    let position = world.state.input.bodies.position[0];
    assert!(position.distance(wanted) < 1.0e-6, "{position}, not {wanted}");
}
