//! Impacts and spin by formula.

use crate::world::World;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::{Body, BodyParams};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
use glam::{Quat, Vec3};

fn ball(world: &mut World, radius: f32) -> u32 {
    world.state.input.meshes.add(CollisionMesh::ball(radius).unwrap())
}

fn with_friction(coefficient: f32) -> BodyParams {
    BodyParams {
        friction: Friction {
            coefficient,
            ..Friction::default()
        },
        ..BodyParams::default()
    }
}

/// The speed after an impact at 3 m/s on a block or on another ball, over the speed before.
fn bounce(restitution: f32, on_ball: bool) -> f32 {
    let mut world = World::weightless();
    let mesh = ball(&mut world, 0.5);
    let floor = if on_ball {
        mesh
    } else {
        world.state.input.meshes.add(CollisionMesh::new(&shapes::cube(1.0)))
    };
    let body = |kind: RigidBody, mesh: u32, y: f32, v: f32| Body {
        kind,
        restitution,
        linear_velocity: Vec3::Y * v,
        params: with_friction(0.0),
        ..Body::at_rest(mesh, Vec3::Y * y, Quat::IDENTITY, Vec3::ONE)
    };
    world.put(&body(RigidBody::Static, floor, 0.0, 0.0));
    let moving = world.put(&body(RigidBody::Dynamic, mesh, 2.0, -3.0));
    world.seconds(1);
    world.velocity(moving).y / 3.0
}

#[test]
fn balls_bounce_by_their_restitution() {
    for on_ball in [false, true] {
        for restitution in [0.0, 0.5, 1.0] {
            let kept = bounce(restitution, on_ball);
            println!("restitution {restitution}, on a ball: {on_ball}: {kept}");
            assert!((kept - restitution).abs() < 1.0e-3, "{kept} for {restitution}");
        }
    }
}

#[test]
fn an_off_centre_impact_of_two_balls_follows_the_line_of_centres() {
    // Equal masses, restitution 1, no friction: the moving one keeps what is across the line of centres.
    for offset in [0.1f32, 0.4, 0.7, 0.95] {
        let mut world = World::weightless();
        let mesh = ball(&mut world, 0.5);
        let body = |x: f32, z: f32, v: f32| Body {
            restitution: 1.0,
            linear_velocity: Vec3::X * v,
            params: with_friction(0.0),
            ..Body::at_rest(mesh, Vec3::new(x, 0.0, z), Quat::IDENTITY, Vec3::ONE)
        };
        let moving = world.put(&body(-2.0, offset, 4.0));
        let struck = world.put(&body(0.0, 0.0, 0.0));
        world.seconds(1);
        let line = Vec3::new((1.0 - offset * offset).sqrt(), 0.0, -offset);
        let pushed = line * (4.0 * line.x);
        let off = [
            world.velocity(struck) - pushed,
            world.velocity(moving) - (Vec3::X * 4.0 - pushed),
        ];
        println!("offset {offset}: off by {:?} m/s", off.map(|v| v.length()));
        // The normal is that of the substep in which they meet: it turns by half a degree in one.
        assert!(off.iter().all(|v| v.length() < 0.01 * 4.0), "{off:?}");
    }
}

#[test]
fn a_sliding_ball_ends_at_five_sevenths_of_its_speed() {
    let mut world = World::new();
    let cube = world.state.input.meshes.add(CollisionMesh::new(&shapes::cube(1.0)));
    let mesh = ball(&mut world, 0.2);
    world.put(&Body {
        kind: RigidBody::Static,
        params: with_friction(0.3),
        ..Body::at_rest(cube, Vec3::NEG_Y * 0.5, Quat::IDENTITY, Vec3::new(80.0, 1.0, 8.0))
    });
    let body = world.put(&Body {
        linear_velocity: Vec3::X * 4.0,
        params: with_friction(0.3),
        ..Body::at_rest(mesh, Vec3::new(-20.0, 0.2001, 0.0), Quat::IDENTITY, Vec3::ONE)
    });
    world.seconds(3);
    let v = world.velocity(body).x;
    println!("{v} for {}", 4.0 * 5.0 / 7.0);
    assert!((v - 20.0 / 7.0).abs() < 2.0e-3 * 4.0);
    let spin = world.state.input.bodies.angular_velocity[body].z;
    assert!((spin * -0.2 - v).abs() < 1.0e-2, "it rolls: {spin}");
}

#[test]
fn a_fast_ball_does_not_enter_a_large_one_that_stands_still() {
    for offset in [0.0f32, 3.0, 4.0, 4.9] {
        let mut world = World::weightless();
        let [large, small] = [5.0, 0.1].map(|radius| ball(&mut world, radius));
        world.put(&Body {
            kind: RigidBody::Static,
            ..Body::at_rest(large, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
        });
        let body = world.put(&Body {
            linear_velocity: Vec3::X * 100.0,
            ..Body::at_rest(small, Vec3::new(-12.3, offset, 0.0), Quat::IDENTITY, Vec3::ONE)
        });
        let mut nearest = f64::INFINITY;
        for _ in 0..32 {
            world.step();
            nearest = nearest.min(world.center(body).length());
        }
        println!("offset {offset} m: as near as {nearest} m");
        assert!(nearest > 5.1 - 0.01, "offset {offset}: {nearest}");
    }
}
