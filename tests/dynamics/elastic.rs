//! Elastic balls: copies of one mesh, all with the same rotation, as a spawner makes them.

use crate::world::World;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{Quat, Vec3};

/// A ball without friction, of restitution 1.
fn elastic(mesh: u32, position: Vec3, velocity: Vec3) -> Body {
    Body {
        linear_velocity: velocity,
        restitution: 1.0,
        params: BodyParams {
            friction: Friction::new(0.0),
            ..BodyParams::default()
        },
        ..Body::at_rest(mesh, position, Quat::IDENTITY, Vec3::ONE)
    }
}

/// Kinetic and potential energy of the first `count` bodies, per mass, joules per kilogram.
fn energy(world: &World, count: usize) -> f64 {
    (0..count)
        .map(|i| 0.5 * f64::from(world.velocity(i).length_squared()) + 9.81 * world.center(i).y)
        .sum()
}

#[test]
fn equal_balls_without_rotation_bounce_elastically_at_any_speed() {
    let mesh = CollisionMesh::new(&shapes::ball(0.5, 3));
    for speed in [2.0, 5.0, 10.0, 20.0, 40.0] {
        for k in 0..10 {
            let mut world = World::weightless();
            let ball = world.state.input.meshes.add(mesh.clone());
            let aside = Vec3::new(0.02, 0.04, 0.0) * k as f32;
            world.put(&elastic(ball, Vec3::ZERO, Vec3::ZERO));
            world.put(&elastic(ball, Vec3::Y * 2.0 + aside, Vec3::NEG_Y * speed));
            world.seconds(1);
            let kept = [0, 1].map(|i| world.velocity(i).length_squared()).iter().sum::<f32>() / (speed * speed);
            // Theory: a central impact conserves all of the energy, and transfers it to the other ball.
            assert!((kept - 1.0).abs() < 0.01, "{kept} of the energy at {speed} m/s, {k}");
            assert!(world.velocity(0).length() > 0.5 * speed, "there was no impact");
        }
    }
}

#[test]
fn two_balls_dropped_on_each_other_keep_their_energy() {
    let mut world = World::new();
    let ball = world.mesh(&shapes::ball(0.5, 3));
    let cube = world.mesh(&shapes::cube(1.0));
    for height in [2.0, 3.2] {
        world.put(&elastic(ball, Vec3::Y * height, Vec3::ZERO));
    }
    world.put(&Body {
        kind: RigidBody::Static,
        scale: Vec3::new(20.0, 1.0, 20.0),
        ..elastic(cube, Vec3::NEG_Y * 0.5, Vec3::ZERO)
    });
    let start = energy(&world, 2);
    for step in 0..64 * 3 {
        world.step();
        let now = energy(&world, 2) / start;
        assert!((0.95..1.01).contains(&now), "{now} of the energy at step {step}");
    }
}
