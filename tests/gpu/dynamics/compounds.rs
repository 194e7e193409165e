//! Bodies of several colliders on both sides.

use super::hammers::{hammer, hammer_at, lowest, put};
use super::parity::both;
use crate::world::{World, any_turn};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::{Body, ManifoldPoint, Motion, Plane};
use bevy_faceoff::step::StepState;
use bevy_faceoff::step::gpu::memory::DeviceMemory;
use bevy_faceoff::step::gpu::results::Detail;
use bevy_faceoff::step::gpu::upload::Carried;
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::settings::Response;
use glam::{Quat, Vec3};

/// Poses and velocities of all colliders, then of compounds.
pub fn rows(world: &World) -> Vec<Motion> {
    let bodies = &world.state.input.bodies;
    let colliders = (0..bodies.len()).map(|i| bodies.motion(i));
    colliders
        .chain(bodies.compounds.iter().map(|compound| compound.motion))
        .collect()
}

/// The device goes on from where the CPU is.
fn synchronise([cpu, gpu]: &mut [World; 2]) {
    gpu.state.input.bodies.set_motions(&rows(cpu));
    gpu.place_frames();
}

/// Hammers above a floor, rings between them, and a kinematic body of two colliders that turns below.
fn heap(count: usize, rings: usize) -> World {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    let ring = world.mesh(&shapes::ring());
    world.floor(cube);
    let mut random = fastrand::Rng::with_seed(3);
    let at = |i: usize| {
        let ring = (i % 5) as f32;
        Vec3::new(
            0.5 * ring - 1.0,
            0.9 + 0.35 * (i / 2) as f32,
            0.4 * (i % 3) as f32 - 0.4,
        )
    };
    for i in 0..count {
        hammer_at(&mut world, at(i), any_turn(&mut random));
        if i < rings {
            let beside = at(i) + Vec3::new(0.8, 0.4, 0.9);
            world.add(
                RigidBody::Dynamic,
                ring,
                Vec3::splat(0.4),
                beside,
                any_turn(&mut random),
            );
        }
    }
    let mut spinner = Body::at_rest(cube, Vec3::new(0.0, 0.1, 0.0), Quat::IDENTITY, Vec3::ONE);
    spinner.kind = RigidBody::Kinematic;
    spinner.angular_velocity = Vec3::Y;
    let arms = [Vec3::X, Vec3::NEG_X].map(|side| (cube, (0.6 * side, Quat::IDENTITY), Vec3::new(0.8, 0.1, 0.2)));
    put(&mut world, &spinner, Some(Vec3::ZERO), &arms);
    world
}

/// How far apart colliders are, metres, and how much their velocities differ, m/s.
fn apart([cpu, gpu]: &[World; 2]) -> (f32, f32) {
    let mut most = (0.0f32, 0.0f32);
    for (a, b) in rows(cpu).into_iter().zip(rows(gpu)) {
        let turned = (a.rotation * b.rotation.dot(a.rotation).signum() - b.rotation).length();
        let velocity = a.linear_velocity.distance(b.linear_velocity) + a.angular_velocity.distance(b.angular_velocity);
        most = (
            most.0.max(a.position.distance(b.position) + turned),
            most.1.max(velocity),
        );
    }
    most
}

fn touching(state: &StepState) -> Vec<[u32; 2]> {
    state.results.contacts.pairs.iter().map(|pair| pair.bodies).collect()
}

/// Whether a pair is about as far apart as bodies at rest are: a rounding error decides whether it touches.
fn barely_touch(state: &StepState, pair: &[u32; 2]) -> bool {
    let radius = pair.map(|i| state.input.bodies.radius.get(i as usize).copied().unwrap_or(f32::MAX));
    let at_rest = state.input.config.solver.rest_offset * 2.0 * radius[0].min(radius[1]);
    let found = state
        .results
        .manifolds
        .pairs
        .iter()
        .find(|manifold| manifold.bodies == *pair);
    found.is_some_and(|manifold| {
        let points = state.results.manifolds.points_of(manifold).iter();
        let nearest = points.map(|point| point.separation).fold(f32::MAX, f32::min);
        (nearest - at_rest).abs() < 0.1 * at_rest
    })
}

/// Step by step from the same poses: who touches whom, and how strongly.
pub fn touch_as_on_the_cpu() {
    let mut worlds = both(|| {
        let mut world = heap(8, 3);
        world.state.input.planes.push(Plane {
            distance: -0.2,
            ..Plane::default()
        });
        world
    });
    let (mut pairs, mut missed, mut off) = (0, 0, (0.0f32, 0.0f32));
    let mut impulses = [0.0f32; 2];
    for _ in 0..40 {
        worlds.iter_mut().for_each(World::step);
        let now = apart(&worlds);
        off = (off.0.max(now.0), off.1.max(now.1));
        let [cpu, gpu] = worlds.each_ref().map(|world| &world.state);
        let (of_cpu, of_gpu) = (touching(cpu), touching(gpu));
        let on_one_side = |one: &[[u32; 2]], other: &[[u32; 2]]| {
            let alone = one.iter().filter(|pair| !other.contains(pair));
            alone.filter(|pair| !barely_touch(cpu, pair)).count()
        };
        missed += on_one_side(&of_cpu, &of_gpu) + on_one_side(&of_gpu, &of_cpu);
        pairs += of_cpu.len();
        for (sum, state) in impulses.iter_mut().zip([cpu, gpu]) {
            *sum += state
                .results
                .contacts
                .pairs
                .iter()
                .map(|pair| pair.impulse)
                .sum::<f32>();
        }
        synchronise(&mut worlds);
    }
    println!("{pairs} touching, {missed} on one side only; impulses {impulses:?} N s; {off:?} apart");
    assert!(pairs > 150 && missed <= pairs / 100, "{missed} of {pairs}");
    assert!((impulses[0] - impulses[1]).abs() < 0.02 * impulses[0]);
}

/// Chaos parts the two; heights and energies stay alike, and both come to rest.
pub fn pile() {
    let mut worlds = both(|| {
        let mut world = World::new();
        world.state.input.config.solver.sleeping = true;
        let cube = world.mesh(&shapes::cube(1.0));
        world.floor(cube);
        let mut random = fastrand::Rng::with_seed(8);
        for i in 0..5 {
            let at = Vec3::new(0.3 * (i % 2) as f32, 0.9 + 0.6 * i as f32, 0.2 * (i % 3) as f32);
            hammer_at(&mut world, at, any_turn(&mut random));
        }
        world
    });
    for _ in 0..64 * 5 {
        worlds.iter_mut().for_each(World::step);
    }
    let [cpu, gpu] = worlds.each_ref().map(|world| {
        let bodies = &world.state.input.bodies;
        let heights = bodies.compounds.iter().map(|compound| compound.center.y);
        let mean = heights.sum::<f64>() / bodies.compounds.len() as f64;
        let fastest = bodies
            .compounds
            .iter()
            .map(|compound| compound.motion.linear_velocity.length());
        let fastest = fastest.fold(0.0, f32::max);
        let asleep = world.state.results.asleep.iter().filter(|&&asleep| asleep).count();
        println!(
            "mean height {mean:.4} m, lowest {:.5} m, fastest {fastest:.3} m/s, deepest {:.1e} m, {asleep} asleep",
            lowest(world),
            world.deepest()
        );
        (mean, lowest(world), fastest, world.deepest())
    });
    assert!((cpu.0 - gpu.0).abs() < 0.1 * cpu.0, "the pile is as high");
    for side in [cpu, gpu] {
        assert!(side.1 > -0.005, "nothing sinks into the floor");
        assert!(side.2 < 0.005, "it comes to rest: {} m/s", side.2);
        assert!(side.3 < 0.001, "hardly any overlap: {} m", side.3);
    }
}

/// With one impulse per contact, step by step from the same poses.
pub fn impulses() {
    let mut worlds = both(|| {
        let mut world = heap(8, 0);
        world.state.input.config.response = Response::Impulse;
        world.state.input.planes.push(Plane {
            distance: 0.5,
            ..Plane::default()
        });
        world
    });
    let (mut most, mut changed) = ((0.0f32, 0.0f32), 0.0f32);
    for _ in 0..60 {
        let before = rows(&worlds[0]);
        worlds.iter_mut().for_each(World::step);
        let now = apart(&worlds);
        most = (most.0.max(now.0), most.1.max(now.1));
        let after = rows(&worlds[0]);
        let push = before
            .iter()
            .zip(&after)
            .map(|(a, b)| a.angular_velocity.distance(b.angular_velocity));
        changed += push.fold(0.0, f32::max);
        synchronise(&mut worlds);
    }
    println!("{most:?} apart; spins changed by {changed}");
    assert!(changed > 10.0);
    assert!(most.0 < 1.0e-5 && most.1 < 1.0e-3, "{most:?}");
}

/// Without response: which spheres overlap, and the points, measured from the centres of mass of the bodies.
pub fn points() {
    let mut worlds = both(|| {
        let mut world = heap(8, 0);
        world.state.input.config.response = Response::None;
        world
    });
    let (mut deep, mut same, mut spheres, mut missed) = (0, 0, 0, 0);
    let (mut places, mut farthest) = (0, 0.0f32);
    for _ in 0..30 {
        worlds.iter_mut().for_each(World::step);
        let [cpu, gpu] = worlds.each_ref().map(|world| &world.state.results);
        let differ = |a: &[[u32; 2]], b: &[[u32; 2]]| a.iter().filter(|pair| !b.contains(pair)).count();
        let (a, b) = (&cpu.sphere_pairs, &gpu.sphere_pairs);
        missed += differ(a, b) + differ(b, a);
        spheres += a.len();
        let numbers = &worlds[0].state.input.bodies.body;
        let own = |pair: &[u32; 2]| numbers[pair[0] as usize] == numbers[pair[1] as usize];
        assert!(!b.iter().any(own), "parts of one body form a pair");
        for pair in &cpu.manifolds.pairs {
            let Some(other) = gpu.manifolds.pairs.iter().find(|other| other.bodies == pair.bodies) else {
                continue;
            };
            // Symmetric shapes have several choices of points.
            let points = gpu.manifolds.points_of(other);
            for point in cpu
                .manifolds
                .points_of(pair)
                .iter()
                .filter(|point| point.separation < 0.0)
            {
                let apart = |side: usize, other: &ManifoldPoint| point.anchors[side].distance(other.anchors[side]);
                deep += 1;
                same += usize::from(points.iter().any(|other| apart(0, other).max(apart(1, other)) < 1.0e-3));
            }
        }
        let centers = |world: &World| -> Vec<_> {
            let contacts = &world.state.results.contacts;
            contacts.points.iter().map(|point| point.point).collect::<Vec<_>>()
        };
        let (of_cpu, of_gpu) = (centers(&worlds[0]), centers(&worlds[1]));
        let nearest = |p: &Vec3| of_cpu.iter().map(|q| q.distance(*p)).fold(f32::MAX, f32::min);
        places += of_gpu.len();
        farthest = of_gpu.iter().map(nearest).fold(farthest, f32::max);
        synchronise(&mut worlds);
    }
    println!("{same} of {deep} points are the same; {missed} of {spheres} spheres on one side only");
    println!("{places} points, at most {farthest:.1e} m from one of the CPU");
    assert!(places > 100 && farthest < 1.0e-4, "a point in the wrong place");
    assert!(deep > 100 && 10 * same > 9 * deep, "{same} of {deep}");
    assert!(spheres > 500 && missed <= spheres / 1000);
}

/// The host sends nothing of the state: the device goes on from what it knows, to the same bits.
pub fn carried_over() {
    let mut worlds = [heap(5, 2), heap(5, 2)];
    let rows_of = |world: &World| world.state.input.bodies.len() + world.state.input.bodies.compounds.len();
    let all: Vec<_> = (0..rows_of(&worlds[0]) as u32)
        .map(|row| Some(Carried::all(row)))
        .collect();
    let [known, blind] = &mut worlds;
    let device = blind.device.as_mut().unwrap();
    let steps = 40;
    for step in 0..steps {
        known.step();
        let carried = if step == 0 { &[][..] } else { &all };
        device.submit(&blind.state.input, carried, Detail::Counts).unwrap();
        device.take().unwrap().unwrap();
    }
    let motions = device.motions().unwrap();
    for (row, (found, wanted)) in motions.iter().zip(rows(known)).enumerate() {
        // Parts are placed by the host in one case.
        let near = found.position.distance(wanted.position) < 1.0e-4;
        assert!(near, "row {row}: {found:?}, not {wanted:?}");
    }
    let compounds = known.state.input.bodies.len()..;
    assert_eq!(motions[compounds.clone()], rows(known)[compounds], "poses of bodies");
}

/// Lets the hammer of collider 1 and 2 fall asleep on a floor.
fn sleeping_hammer() -> World {
    let mut world = World::new();
    world.state.input.config.solver.sleeping = true;
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    hammer_at(&mut world, Vec3::Y * 0.5, Quat::from_rotation_z(1.3));
    world.state.input.keys = vec![10, 20, 30];
    for _ in 0..400 {
        world.step();
        if world.state.results.asleep[1] {
            return world;
        }
    }
    panic!("it does not fall asleep");
}

/// On the device, on the CPU and back, and while numbers change.
pub fn sleeps_on() {
    let mut world = sleeping_hammer();
    let at = world.state.input.bodies.compounds[0].motion;
    for _ in 0..5 {
        world.step();
    }
    assert_eq!(world.state.results.asleep, [false, true, true]);
    assert_eq!(world.state.input.bodies.compounds[0].motion, at);
    let mut device = world.device.take().unwrap();
    (world.state.memory, world.state.results.manifolds) = device.memory().unwrap().to_cpu();
    for _ in 0..20 {
        world.step();
        assert_eq!(world.state.results.asleep, [false, true, true], "on the CPU");
    }
    let back = DeviceMemory::from_cpu(&world.state.memory, &world.state.results.manifolds);
    assert_eq!(
        back.to_cpu(),
        (world.state.memory.clone(), world.state.results.manifolds.clone())
    );
    device.remember(&back).unwrap();
    world.device = Some(device);
    for _ in 0..5 {
        world.step();
        assert_eq!(world.state.results.asleep, [false, true, true], "on the device again");
    }
    assert_eq!(world.state.input.bodies.compounds[0].motion, at);

    // A hammer far away gets lower numbers.
    let [ground, cube] = [0, 1].map(|i| world.state.input.bodies.mesh[i]);
    world.state.input.bodies.clear();
    world.floor(ground);
    hammer_at(&mut world, Vec3::new(10.0, 10.0, 0.0), Quat::IDENTITY);
    let body = Body {
        position: at.position,
        rotation: at.rotation,
        ..Body::at_rest(cube, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
    };
    put(&mut world, &body, None, &hammer(cube));
    world.state.input.keys = vec![10, 15, 16, 20, 30];
    for _ in 0..5 {
        world.step();
        assert_eq!(world.state.results.asleep, [false, false, false, true, true]);
    }
    assert_eq!(world.state.input.bodies.compounds[1].motion, at);
    assert!(world.state.input.bodies.compounds[0].motion.linear_velocity.y < 0.0);
    world.state.input.bodies.params[3].woken = true;
    world.step();
    assert!(!world.state.results.asleep[3] && !world.state.results.asleep[4]);
}

/// The handle goes on as a body of its own.
pub fn loses_its_head() {
    let mut world = sleeping_hammer();
    let handle = world.state.input.bodies.motion(1);
    let cube = world.state.input.bodies.mesh[0];
    let scale = world.state.input.bodies.scale[1];
    world.state.input.bodies.clear();
    world.floor(cube);
    world.put(&Body {
        position: handle.position,
        rotation: handle.rotation,
        ..Body::at_rest(cube, Vec3::ZERO, Quat::IDENTITY, scale)
    });
    world.state.input.keys = vec![10, 20];
    world.step();
    assert_eq!(world.state.results.asleep, [false, false]);
    assert!(world.state.input.bodies.position[1].distance(handle.position) < 0.01);
}

/// Worlds without compounds have no dispatches for them.
pub fn dispatches() {
    let mut world = heap(1, 0);
    let mut count = || {
        world.step();
        let count = world.state.results.gpu.unwrap().dispatches;
        let ground = world.state.input.bodies.mesh[0];
        world.state.input.bodies.clear();
        world.floor(ground);
        count
    };
    let [with, without] = [count(), count()];
    println!("{without} dispatches in a step without compounds, {with} with them");
    assert_eq!(with, without + 3);
}
