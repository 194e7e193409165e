//! Bodies faster than their size per step, shot at a thin plate.

use crate::world::World;
use bevy_faceoff::components::RigidBody;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::stages::state::{Body, Handling};
use glam::{Quat, Vec3};

const DT: f32 = 1.0 / 64.0;

fn unit(random: &mut fastrand::Rng) -> Vec3 {
    loop {
        let v = Vec3::from_array([0; 3].map(|_| 2.0 * random.f32() - 1.0));
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// Shoots `tries` bullets of diameter 1 at a plate in the plane z = 0, each `sizes` of its own per step fast, and counts
/// those that are on the other side a few steps later. They spin by up to so many radians per step.
fn passed(bullet: &TriMesh, sizes: f32, spin: f32, tries: usize, continuous: bool) -> usize {
    let mut random = fastrand::Rng::with_seed(sizes as u64);
    let mut world = World::new();
    world.state.config.gravity = Vec3::ZERO;
    let (mesh, cube) = (world.mesh(bullet), world.mesh(&shapes::cube(1.0)));
    let mut bullets = Vec::new();
    for try_ in 0..tries {
        // Each pair has a place of its own.
        let home = Vec3::new((try_ % 32) as f32, (try_ / 32) as f32, 0.0) * 4.0e3;
        let thin = Vec3::new(3.0e3, 3.0e3, 0.01);
        world.add(RigidBody::Static, cube, thin, home, Quat::IDENTITY);
        // No flatter than 17 degrees, from anywhere within the way of one step.
        let mut way = unit(&mut random);
        way.z = -way.z.abs().max(0.3);
        let way = way.normalize();
        let speed = sizes / DT;
        let start = home - way * (1.0 / way.z.abs() + sizes * random.f32());
        let body = Body {
            linear_velocity: way * speed,
            angular_velocity: unit(&mut random) * spin * random.f32() / DT,
            handling: Handling {
                continuous,
                ..Handling::default()
            },
            ..Body::at_rest(mesh, start, Quat::from_scaled_axis(unit(&mut random) * 3.0), Vec3::ONE)
        };
        world.state.bodies.push(&body, &world.state.meshes).unwrap();
        bullets.push(world.state.bodies.len() - 1);
    }
    for _ in 0..4 {
        world.step();
    }
    let behind = bullets.iter().filter(|&&i| world.center(i).z < 0.0);
    behind.count()
}

#[test]
fn none_passes_a_thin_plate() {
    for (name, bullet, spin, tries) in [
        ("ball", shapes::ball_320(), 10.0, 1000),
        ("torus", shapes::torus_240(), 0.0, 300),
        ("torus that spins", shapes::torus_240(), 10.0, 300),
        ("cube that spins", shapes::cube(0.577), 10.0, 300),
    ] {
        for sizes in [5.0, 50.0, 500.0] {
            let passed = passed(&bullet, sizes, spin, tries, true);
            println!("{name}, {sizes} sizes per step: {passed} of {tries} pass");
            assert_eq!(passed, 0, "{name}, {sizes} sizes per step");
        }
    }
}

#[test]
fn without_it_nearly_all_pass() {
    let passed = passed(&shapes::ball_320(), 50.0, 10.0, 100, false);
    assert!(passed > 50, "{passed} of 100");
}
