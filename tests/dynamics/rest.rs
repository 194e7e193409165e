//! What stands and lies still: by itself, in stacks, in piles. Sleep is off, so that it is contacts that hold.

use crate::world::{GAP, World};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::types::body::RigidBody;
use glam::{DVec3, Quat, Vec3};
use std::f32::consts::FRAC_PI_2;

/// How far bodies have moved, and sunk, at most.
pub struct Moved {
    far: f64,
    sunk: f64,
}

/// Watches `bodies` for so many seconds.
fn watch(world: &mut World, bodies: &[usize], seconds: usize) -> Moved {
    let start: Vec<DVec3> = bodies.iter().map(|&i| world.center(i)).collect();
    let mut most = Moved { far: 0.0, sunk: 0.0 };
    for _ in 0..64 * seconds {
        world.step();
        for (&i, start) in bodies.iter().zip(&start) {
            let moved = world.center(i) - *start;
            most.far = most.far.max(moved.length());
            most.sunk = most.sunk.max(-moved.y);
        }
    }
    most
}

pub fn check(name: &str, moved: &Moved, far: f64, sunk: f64) {
    println!("{name}: moved {:.6} m at most, sank {:.6} m", moved.far, moved.sunk);
    assert!(moved.far < far, "{name} moved {}", moved.far);
    assert!(moved.sunk < sunk, "{name} sank {}", moved.sunk);
}

#[test]
fn a_cube_rests_on_a_mesh_for_a_minute() {
    for edge in [0.1f32, 1.0, 5.0] {
        cube(edge, 60);
    }
}

/// A cube on a floor.
pub fn cube(edge: f32, seconds: usize) {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let at = Vec3::new(0.3, 0.5 + GAP, 0.2) * edge;
    let turn = Quat::from_rotation_y(0.4);
    let body = world.add(RigidBody::Dynamic, cube, Vec3::splat(edge), at, turn);
    let moved = watch(&mut world, &[body], seconds);
    let edge = f64::from(edge);
    check(&format!("cube of {edge} m"), &moved, 1.0e-3 * edge, 0.01 * edge);
}

#[test]
fn ten_cubes_stand_on_each_other() {
    stack(10, 30);
}

/// Cubes on each other.
pub fn stack(count: usize, seconds: usize) {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let stack: Vec<usize> = (0..count)
        .map(|i| {
            let at = Vec3::Y * (0.5 + GAP + (1.0 + GAP) * i as f32);
            world.add(
                RigidBody::Dynamic,
                cube,
                Vec3::ONE,
                at,
                Quat::from_rotation_y(0.1 * i as f32),
            )
        })
        .collect();
    let moved = watch(&mut world, &stack, seconds);
    check(&format!("stack of {count}"), &moved, 0.02, 0.02);
}

/// Rows of cubes in a plane, each one shorter than that below.
pub fn pyramid(rows: usize, seconds: usize) {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    world.floor(cube);
    let mut cubes = vec![];
    for row in 0..rows {
        for k in 0..rows - row {
            // Neighbours are out of each other's sight.
            let x = 1.05 * (k as f32 + 0.5 * row as f32);
            let y = 0.5 + GAP + (1.0 + GAP) * row as f32;
            cubes.push(world.add(
                RigidBody::Dynamic,
                cube,
                Vec3::ONE,
                Vec3::new(x, y, 0.0),
                Quat::IDENTITY,
            ));
        }
    }
    let moved = watch(&mut world, &cubes, seconds);
    check(&format!("pyramid of {}", cubes.len()), &moved, 0.02, 0.02);
}

#[test]
fn a_pyramid_of_fifteen_cubes_stands() {
    pyramid(5, 30);
}

/// `cargo test --release --test dynamics -- --ignored --nocapture fifty_five`
/// (moved 3.6 mm, all of it down; 13 s).
#[test]
#[ignore = "takes a quarter of a minute"]
fn a_pyramid_of_fifty_five_cubes_stands() {
    pyramid(10, 30);
}

/// Five rings that lie on each other, each shifted by `shift` against that below, to and fro.
pub fn rings(shift: f32, seconds_to_settle: u32, seconds: usize) -> Moved {
    let mut world = World::new();
    let cube = world.mesh(&shapes::cube(1.0));
    let ring = world.mesh(&shapes::ring());
    world.floor(cube);
    // Half as thick as the torus before scaling, and what a ring of diameter 1 keeps between itself and others.
    let (tube, gap) = (0.06, 0.005);
    let pile: Vec<usize> = (0..5)
        .map(|i| {
            let at = Vec3::new(shift * (i % 2) as f32, tube + gap + (2.0 * tube + gap) * i as f32, 0.0);
            let turn = Quat::from_rotation_y(0.4 * i as f32) * Quat::from_rotation_x(FRAC_PI_2);
            world.add(RigidBody::Dynamic, ring, Vec3::ONE, at, turn)
        })
        .collect();
    world.seconds(seconds_to_settle);
    watch(&mut world, &pile, seconds)
}

#[test]
fn five_rings_lie_on_each_other() {
    check("rings on one axis", &rings(0.0, 0, 30), 0.02, 0.02);
    check("rings across each other", &rings(0.25, 2, 30), 0.02, 0.02);
}
