//! Scenes on the CPU and on the device.

use super::motion::Motion;
use crate::world::{World, any_turn};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::{Body, Plane};
use bevy_faceoff::testing::scenes::any_vector;
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

/// The scene on the CPU and on the device.
pub fn both(scene: impl Fn() -> World) -> [World; 2] {
    let mut cpu = scene();
    cpu.device = None;
    [cpu, scene()]
}

/// How far apart bodies are on both sides, relative to how large they are, and how much their velocities differ, m/s.
fn apart([cpu, gpu]: &[World; 2]) -> (f64, f32) {
    let count = cpu.state.input.bodies.len();
    let mut most = (0.0f64, 0.0f32);
    for i in 0..count {
        let [a, b] = [cpu, gpu].map(|world| &world.state.input.bodies);
        let size = f64::from(a.radius[i]);
        let turned = 2.0 * (a.rotation[i] * b.rotation[i].dot(a.rotation[i]).signum() - b.rotation[i]).length();
        let moved = cpu.center(i).distance(gpu.center(i)) / size;
        let velocity = a.linear_velocity[i].distance(b.linear_velocity[i]);
        let spin = a.angular_velocity[i].distance(b.angular_velocity[i]) * a.radius[i];
        most = (most.0.max(moved + f64::from(turned)), most.1.max(velocity + spin));
    }
    most
}

fn second(worlds: &mut [World; 2]) -> (f64, f32) {
    let mut most = (0.0f64, 0.0f32);
    for _ in 0..64 {
        worlds.iter_mut().for_each(World::step);
        let now = apart(worlds);
        most = (most.0.max(now.0), most.1.max(now.1));
    }
    most
}

/// Bodies that turn and fall past each other.
pub fn free() {
    let mut worlds = both(|| {
        let mut world = World::new();
        let meshes = [&shapes::knot_1120(), &shapes::cube(1.0), &shapes::ring()].map(|mesh| world.mesh(mesh));
        let mut random = fastrand::Rng::with_seed(31);
        for i in 0..12 {
            let at = Vec3::new(3.0 * i as f32, 2.0, 0.0);
            let mut body = Body {
                linear_velocity: any_vector(&mut || random.f32()) * 2.0,
                angular_velocity: any_vector(&mut || random.f32()) * 6.0,
                ..Body::at_rest(meshes[i % 3], at, any_turn(&mut random), Vec3::new(0.5, 1.0, 1.3))
            };
            body.params.linear_damping = 0.1 * (i % 4) as f32;
            body.params.angular_damping = 0.2 * (i % 3) as f32;
            world.put(&body);
        }
        world
    });
    let (place, velocity) = second(&mut worlds);
    println!("free: {place:.1e} of the radius apart, {velocity:.1e} m/s");
    assert!(place < 1.0e-3 && velocity < 1.0e-3);
}

/// Chaos parts the two; energy, momentum and heights stay alike.
pub fn pile() {
    let mut worlds = both(|| {
        let mut world = World::new();
        let meshes = [
            &shapes::cube(1.0),
            &shapes::torus_240(),
            &shapes::ring(),
            &shapes::ball_320(),
        ];
        let meshes = meshes.map(|mesh| world.mesh(mesh));
        world.floor(meshes[0]);
        let mut random = fastrand::Rng::with_seed(21);
        for i in 0..8 {
            let at = Vec3::new(0.4 * (i % 2) as f32, 0.8 + 0.8 * (i / 2) as f32, 0.4 * (i % 3) as f32);
            world.add(
                RigidBody::Dynamic,
                meshes[i % 4],
                Vec3::splat(0.7),
                at,
                any_turn(&mut random),
            );
        }
        world
    });
    for _ in 0..64 * 4 {
        worlds.iter_mut().for_each(World::step);
    }
    let [cpu, gpu] = worlds.each_ref().map(|world| {
        let count = world.state.input.bodies.len();
        let heights: Vec<f64> = (1..count).map(|i| world.center(i).y).collect();
        let motion = Motion::of(world);
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let speeds: Vec<_> = (1..count).map(|i| world.velocity(i).length()).collect();
        // Rings and balls may roll away.
        let standing = speeds.iter().enumerate().filter(|(i, _)| i % 4 < 2);
        let fastest = standing.map(|(_, &speed)| speed).fold(0.0, f32::max);
        println!("speeds {speeds:.4?} m/s");
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        println!(
            "mean height {mean:.4} m, lowest {lowest:.4} m, kinetic energy {:.2e} J, deepest {:.2e} m, asleep {}",
            motion.kinetic,
            world.deepest(),
            world.state.results.asleep.iter().filter(|&&asleep| asleep).count()
        );
        (mean, lowest, motion.kinetic, world.deepest(), fastest)
    });
    assert!((cpu.0 - gpu.0).abs() < 0.1 * cpu.0, "the pile is as high");
    for side in [cpu, gpu] {
        assert!(side.1 > 0.04, "nothing sinks into the floor");
        assert!(side.2 < 0.25, "only what rolls moves: {} J", side.2);
        assert!(side.3 < 0.001, "hardly any overlap: {} m", side.3);
        assert!(side.4 < 0.005, "cubes and tori come to rest: {} m/s", side.4);
    }
}

/// Step by step from the same poses: who touches whom, where, and how strongly.
pub fn reports() {
    let mut worlds = both(|| {
        let mut world = World::new();
        let cube = world.mesh(&shapes::cube(1.0));
        let knot = world.mesh(&shapes::knot_1120());
        world.add(
            RigidBody::Static,
            cube,
            Vec3::new(1.0, 4.0, 4.0),
            Vec3::X * 1.1,
            Quat::IDENTITY,
        );
        world.state.input.planes.push(Plane::default());
        let mut random = fastrand::Rng::with_seed(5);
        for i in 0..5 {
            let at = Vec3::new(0.1 * i as f32 - 0.2, 0.6 + 0.8 * i as f32, 0.0);
            world.add(RigidBody::Dynamic, knot, Vec3::ONE, at, any_turn(&mut random));
        }
        world
    });
    let (mut pairs, mut planes, mut points) = (0, 0, 0);
    let (mut missed, mut impulses) = (0, [0.0f32; 2]);
    for _ in 0..80 {
        worlds.iter_mut().for_each(World::step);
        let [cpu, gpu] = worlds.each_ref().map(|world| &world.state);
        // The device does not know which bodies can meet.
        assert!(cpu.results.collision_substeps <= gpu.results.collision_substeps);
        let bodies = |state: &bevy_faceoff::step::StepState| -> Vec<[u32; 2]> {
            state.results.contacts.pairs.iter().map(|pair| pair.bodies).collect()
        };
        let (of_cpu, of_gpu) = (bodies(cpu), bodies(gpu));
        missed += of_cpu.iter().filter(|pair| !of_gpu.contains(pair)).count();
        missed += of_gpu.iter().filter(|pair| !of_cpu.contains(pair)).count();
        pairs += of_cpu.len();
        let on_planes = [cpu, gpu].map(|state| state.results.contacts.planes.len());
        missed += on_planes[0].abs_diff(on_planes[1]);
        planes += on_planes[0];
        points += gpu.results.manifolds.points.len();
        for (sum, state) in impulses.iter_mut().zip([cpu, gpu]) {
            *sum += state
                .results
                .contacts
                .pairs
                .iter()
                .map(|pair| pair.impulse)
                .sum::<f32>();
        }
        // The device goes on from where the CPU is, so that chaos does not part the two.
        let poses: Vec<_> = (0..worlds[0].state.input.bodies.len())
            .map(|i| worlds[0].state.input.bodies.motion(i))
            .collect();
        for (i, motion) in poses.iter().enumerate() {
            worlds[1].state.input.bodies.set_motion(i, motion);
        }
        worlds[1].place_frames();
    }
    println!(
        "{pairs} pairs and {planes} on planes, {missed} on one side only; {points} points; impulses sum to {impulses:?} N s"
    );
    assert!(pairs > 40 && planes > 20 && points > 500);
    assert!(missed <= (pairs + planes) / 50, "{missed}");
    // A shock runs through all knots at once on the CPU, and from contact to contact on the device.
    assert!((impulses[0] - impulses[1]).abs() < 0.01 * impulses[0]);
}
