//! Many bodies. The solvers do not agree on the details, but on what counts.

use super::shapes::Shape;
use super::twin::both;
use super::world::{World, check, check_below};
use bevy_faceoff::gpu::device::Gpu;
use glam::{DVec3, Vec3};

/// Balls of mixed sizes that fly at each other.
pub fn cloud(count: usize, restitution: f32) -> World {
    let mut world = World::new();
    let mut random = fastrand::Rng::with_seed(11);
    let mut number = move || random.f64() - 0.5;
    for i in 0..count {
        let at = DVec3::new((i % 4) as f64, (i / 4 % 4) as f64, (i / 16) as f64) - 1.5;
        let radius = 0.35 + 0.2 * number();
        let mass = (radius * radius * radius * 8.0) as f32;
        let ball = world.dynamic(
            Shape::Sphere(radius),
            mass,
            1.1 * at + DVec3::new(number(), number(), number()) * 0.1,
        );
        let inward = -0.6 * at + DVec3::new(number(), number(), number()) * 4.0;
        world.motion(ball).linear_velocity = inward.as_vec3();
        world.motion(ball).angular_velocity = Vec3::new(number() as f32, number() as f32, number() as f32) * 8.0;
        world.bodies.bodies[ball].restitution = restitution;
        world.bodies.bodies[ball].friction = 0.3;
    }
    world
}

pub fn a_cloud_of_balls(gpu: &Gpu) {
    for restitution in [0.0, 1.0] {
        let (cpu, twin) = both(gpu, || cloud(64, restitution), 2.0);
        let before = cloud(64, restitution).measure();
        let (one, other) = (cpu.measure(), twin.world.measure());
        check(
            &format!("restitution {restitution}: energy, of the first"),
            other.kinetic / before.kinetic,
            one.kinetic / before.kinetic,
            1.0e-3,
        );
        check_below(
            "linear momentum, drift over the sum of sizes",
            (other.linear - before.linear).length() / before.size,
            1.0e-4,
        );
        check_below(
            "angular momentum, drift over the sum of sizes times 1 m",
            (other.angular - before.angular).length() / before.size,
            1.0e-4,
        );
    }
}

pub fn a_heap_in_one_place_comes_apart(gpu: &Gpu) {
    let make = || {
        let mut world = World::heavy();
        world.floor(0.0);
        let mut random = fastrand::Rng::with_seed(2);
        for _ in 0..20 {
            let at = DVec3::new(random.f64(), 1.0 + random.f64(), random.f64());
            world.dynamic(Shape::Sphere(0.5), 1.0, at);
        }
        world
    };
    let (mut cpu, mut twin) = both(gpu, make, 4.0);
    check_below("deepest on the CPU, metres", cpu.deepest() as f64, 0.01);
    check_below("deepest on the device, metres", twin.world.deepest() as f64, 0.01);
}

/// More pairs than one workgroup sorts or scans, and more bodies than one digit holds.
pub fn a_block_of_balls(gpu: &Gpu) {
    let make = || {
        let mut world = World::heavy();
        world.collision_substeps = Some(1);
        world.floor(0.0);
        let mut random = fastrand::Rng::with_seed(9);
        for i in 0..1331 {
            let at = DVec3::new((i % 11) as f64, (i / 11 % 11) as f64, (i / 121) as f64);
            let off = DVec3::new(random.f64(), random.f64(), random.f64()) * 0.02;
            let ball = world.dynamic(Shape::Sphere(0.5), 1.0, at * 0.995 + off + DVec3::Y * 0.5);
            world.bodies.bodies[ball].restitution = 0.5;
        }
        world
    };
    let (cpu, mut twin) = both(gpu, make, 4.0 / 64.0);
    let pairs = twin.world.manifolds.pairs.len();
    assert!(pairs > 2048, "{pairs}");
    assert!(twin.world.bodies.motions.iter().all(|motion| motion.center.is_finite()));
    check_below("deepest, metres", twin.world.deepest() as f64, 0.02);
    println!(
        "{pairs} pairs: {:.1} ms per step on the CPU, {:.1} ms on {}",
        cpu.time_solving.as_secs_f64() * 1.0e3 / 4.0,
        twin.time_solving.as_secs_f64() * 1.0e3 / 4.0,
        gpu.info.name,
    );
}
