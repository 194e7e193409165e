//! Balls, capsules and wheels that roll: nothing slows them down, and nothing speeds them up.

use crate::world::World;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams, Plane};
use bevy_faceoff::types::material::Friction;
use bevy_faceoff::types::body::RigidBody;
use glam::{Quat, Vec3};

/// Ground on which a ball rolls along x.
#[derive(Clone, Copy, Debug)]
enum Ground {
    Block,
    Plane,
    Groove,
    Terrain,
}

fn rough() -> BodyParams {
    BodyParams {
        friction: Friction {
            coefficient: 0.8,
            ..Friction::default()
        },
        ..BodyParams::default()
    }
}

fn add_ground(world: &mut World, ground: Ground, length: f32) {
    let mut fixed = |mesh: u32, at: Vec3, turn: Quat, scale: Vec3| {
        world.put(&Body {
            kind: RigidBody::Static,
            params: rough(),
            ..Body::at_rest(mesh, at, turn, scale)
        });
    };
    match ground {
        Ground::Block => {
            let cube = world.state.input.meshes.add(CollisionMesh::new(&shapes::cube(1.0)));
            world.put(&Body {
                kind: RigidBody::Static,
                params: rough(),
                ..Body::at_rest(cube, Vec3::NEG_Y * 0.5, Quat::IDENTITY, Vec3::new(2.0 * length, 1.0, 8.0))
            });
        }
        Ground::Plane => {
            world.state.input.planes.push(Plane {
                normal: Vec3::Y,
                distance: 0.0,
                friction: rough().friction,
                ..Plane::default()
            });
        }
        Ground::Groove => {
            let _ = &mut fixed;
            let cube = world.state.input.meshes.add(CollisionMesh::new(&shapes::cube(1.0)));
            for side in [-1.0f32, 1.0] {
                let turn = Quat::from_rotation_x(-side * 0.5);
                let at = turn * (Vec3::NEG_Y * 0.5 + Vec3::Z * (side * 2.0));
                world.put(&Body {
                    kind: RigidBody::Static,
                    params: rough(),
                    ..Body::at_rest(cube, at, turn, Vec3::new(2.0 * length, 1.0, 4.0))
                });
            }
        }
        Ground::Terrain => {
            let mesh = terrain(length, 0.1);
            let slot = world.state.input.meshes.add(CollisionMesh::new(&mesh));
            world.put(&Body {
                kind: RigidBody::Static,
                params: rough(),
                ..Body::at_rest(slot, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
            });
        }
    }
}

/// A flat open mesh of small triangles.
fn terrain(length: f32, cell: f32) -> TriMesh {
    let (nx, nz) = ((1.2 * length / cell) as u32, (2.0 / cell) as u32);
    let mut vertices = Vec::new();
    for i in 0..=nx {
        for k in 0..=nz {
            vertices.push(Vec3::new(i as f32 * cell - 0.1 * length, 0.0, k as f32 * cell - 1.03));
        }
    }
    let at = |i: u32, k: u32| i * (nz + 1) + k;
    let mut faces = Vec::new();
    for i in 0..nx {
        for k in 0..nz {
            faces.push([at(i, k), at(i, k + 1), at(i + 1, k)]);
            faces.push([at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)]);
        }
    }
    TriMesh::new(vertices, faces).unwrap()
}

/// Rolls a ball 10 m and returns its least and largest speed, in units of the first.
fn roll(ground: Ground, radius: f32, speed: f32) -> [f64; 2] {
    let mut world = World::new();
    add_ground(&mut world, ground, 12.0 * radius.max(1.0));
    let ball = world.state.input.meshes.add(CollisionMesh::ball(radius).unwrap());
    // In the groove it touches on both sides, at a smaller radius.
    let (height, spin) = match ground {
        Ground::Groove => (radius / 0.5f32.cos(), speed / (radius * 0.5f32.cos())),
        _ => (radius, speed / radius),
    };
    let body = world.put(&Body {
        linear_velocity: Vec3::X * speed,
        angular_velocity: Vec3::NEG_Z * spin,
        params: rough(),
        ..Body::at_rest(ball, Vec3::Y * (height * 1.0005), Quat::IDENTITY, Vec3::ONE)
    });
    let mut range = [f64::INFINITY, 0.0f64];
    let steps = (64.0 * 10.0 * radius.max(1.0) / speed) as u32;
    for _ in 0..steps {
        world.step();
        let v = f64::from(world.velocity(body).length() / speed);
        range = [range[0].min(v), range[1].max(v)];
    }
    range
}

#[test]
fn a_ball_keeps_its_speed_on_any_ground() {
    for ground in [Ground::Block, Ground::Plane, Ground::Groove, Ground::Terrain] {
        for speed in [0.5, 1.0, 5.0, 20.0] {
            let [least, most] = roll(ground, 0.1, speed);
            println!("{ground:?} at {speed} m/s: {least:.5} to {most:.5} of its speed");
        }
    }
    for radius in [0.01, 10.0] {
        let [least, most] = roll(Ground::Block, radius, 1.0);
        println!("radius {radius}: {least:.5} to {most:.5}");
    }
}
