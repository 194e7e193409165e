//! Balls, capsules and wheels that roll: nothing slows them down, and nothing speeds them up.

use crate::world::World;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::state::{Body, BodyParams, Plane};
use bevy_faceoff::types::body::RigidBody;
use bevy_faceoff::types::material::Friction;
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
    match ground {
        Ground::Block => {
            let cube = world.state.input.meshes.add(CollisionMesh::new(&shapes::cube(1.0)));
            world.put(&Body {
                kind: RigidBody::Static,
                params: rough(),
                ..Body::at_rest(
                    cube,
                    Vec3::NEG_Y * 0.5,
                    Quat::IDENTITY,
                    Vec3::new(2.0 * length, 1.0, 8.0),
                )
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

/// How far a speed may be from the first, relative to it.
fn check(name: &str, [least, most]: [f64; 2], bound: f64) {
    println!("{name}: {least:.6} to {most:.6} of its speed");
    assert!(least > 1.0 - bound && most < 1.0 + bound, "{name}: {least} to {most}");
}

#[test]
fn a_ball_keeps_its_speed_on_any_ground() {
    for ground in [Ground::Block, Ground::Plane, Ground::Groove, Ground::Terrain] {
        for speed in [0.5, 1.0, 5.0, 20.0] {
            check(&format!("{ground:?} at {speed} m/s"), roll(ground, 0.1, speed), 1.0e-3);
        }
    }
    for radius in [0.01, 10.0] {
        check(&format!("radius {radius} m"), roll(Ground::Block, radius, 1.0), 1.0e-3);
    }
}

/// Rolls a shape whose axis of symmetry is y, laid along z, at 3 m/s for 12 s. Returns its least and largest speed in
/// units of the first, and how much its height changes.
fn roll_on_side(mesh: CollisionMesh, radius: f32, ground: Ground) -> ([f64; 2], f64) {
    let mut world = World::new();
    add_ground(&mut world, ground, 60.0);
    let mesh = world.state.input.meshes.add(mesh);
    let speed = 3.0;
    let body = world.put(&Body {
        linear_velocity: Vec3::X * speed,
        angular_velocity: Vec3::NEG_Z * (speed / radius),
        params: rough(),
        ..Body::at_rest(
            mesh,
            Vec3::new(-40.0, radius * 1.0005, 0.0),
            Quat::from_rotation_x(std::f32::consts::FRAC_PI_2),
            Vec3::ONE,
        )
    });
    let (mut range, mut heights) = ([f64::INFINITY, 0.0f64], [f64::INFINITY, 0.0f64]);
    for _ in 0..12 * 64 {
        world.step();
        let v = f64::from(world.velocity(body).length() / speed);
        range = [range[0].min(v), range[1].max(v)];
        let y = world.center(body).y;
        heights = [heights[0].min(y), heights[1].max(y)];
    }
    (range, heights[1] - heights[0])
}

#[test]
fn capsules_and_wheels_keep_their_speed() {
    for ground in [Ground::Block, Ground::Plane] {
        let capsule = CollisionMesh::capsule(0.3, 0.8).unwrap();
        let (range, height) = roll_on_side(capsule, 0.3, ground);
        check(
            &format!("capsule, {ground:?}, height changes by {height}"),
            range,
            5.0e-3,
        );
        assert!(height < 1.0e-3, "{height}");
        let wheel = CollisionMesh::cylinder(0.3, 0.2, 0.0).unwrap();
        let (range, height) = roll_on_side(wheel, 0.3, ground);
        println!("wheel, {ground:?}, height changes by {height}: {range:?}");
        let tyre = CollisionMesh::cylinder(0.3, 0.2, 0.05).unwrap();
        let (range, height) = roll_on_side(tyre, 0.3, ground);
        println!("wheel with round rims, {ground:?}, height changes by {height}: {range:?}");
    }
}

#[test]
fn a_resting_ball_stays_and_a_rolling_one_with_damping_falls_asleep() {
    let mut world = World::new();
    world.state.input.config.solver.sleeping = true;
    add_ground(&mut world, Ground::Block, 12.0);
    let ball = world.state.input.meshes.add(CollisionMesh::ball(0.1).unwrap());
    let params = BodyParams {
        linear_damping: 0.5,
        angular_damping: 0.5,
        ..rough()
    };
    let body = world.put(&Body {
        linear_velocity: Vec3::X,
        angular_velocity: Vec3::NEG_Z * 10.0,
        params,
        ..Body::at_rest(ball, Vec3::Y * 0.10005, Quat::IDENTITY, Vec3::ONE)
    });
    world.seconds(30);
    assert_eq!(world.velocity(body), Vec3::ZERO);
    assert!(world.state.results.asleep[body], "it sleeps");
    let points = &world.state.results.manifolds.points;
    assert_eq!(points.len(), 1, "one point holds it");
}
