//! Bodies at rest: single, in stacks, in piles. Sleep is off, so that only contacts hold them.

use crate::world::{GAP, World};
use bevy_faceoff::testing::scenes::rest as scenes;
use glam::DVec3;

/// The largest distances by which bodies have moved and sunk, metres.
pub struct Moved {
    far: f64,
    sunk: f64,
}

/// Measures all bodies except the first, which is the floor, for so many seconds.
fn watch(world: &mut World, seconds: usize) -> Moved {
    let start: Vec<DVec3> = (1..world.state.input.bodies.len()).map(|i| world.center(i)).collect();
    let mut most = Moved { far: 0.0, sunk: 0.0 };
    for _ in 0..64 * seconds {
        world.step();
        for (i, start) in start.iter().enumerate() {
            let moved = world.center(i + 1) - *start;
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
    let mut world = World::of(&scenes::cube(edge, GAP));
    let moved = watch(&mut world, seconds);
    let edge = f64::from(edge);
    check(&format!("cube of {edge} m"), &moved, 1.0e-3 * edge, 0.01 * edge);
}

#[test]
fn ten_cubes_stand_on_each_other() {
    stack(10, 30);
}

/// A stack of cubes.
pub fn stack(count: usize, seconds: usize) {
    let mut world = World::of(&scenes::stack(count, GAP));
    let moved = watch(&mut world, seconds);
    check(&format!("stack of {count}"), &moved, 0.02, 0.02);
}

/// Rows of cubes in a plane, each shorter than the row below.
pub fn pyramid(rows: usize, seconds: usize) {
    let mut world = World::of(&scenes::pyramid(rows, GAP));
    let moved = watch(&mut world, seconds);
    check(
        &format!("pyramid of {}", world.state.input.bodies.len() - 1),
        &moved,
        0.02,
        0.02,
    );
}

/// A pile of so many points that the solver has few passes for each comes to rest too, and is not searched again.
#[test]
fn a_pyramid_of_465_cubes_comes_to_rest() {
    let mut world = World::of(&scenes::pyramid(30, GAP));
    world.seconds(5);
    let (mut fastest, mut searches, mut pairs) = (0.0f32, 0, 0);
    for _ in 0..32 {
        world.step();
        let velocities = &world.state.input.bodies.linear_velocity;
        fastest = velocities.iter().map(|v| v.length()).fold(fastest, f32::max);
        searches += world.state.results.searches;
        pairs += world.state.results.near_pairs.len();
    }
    println!("at most {fastest:.5} m/s, {searches} searches for {pairs} pairs");
    assert!(fastest < 0.01, "{fastest} m/s");
    assert!(pairs > 32 * 800 && 10 * searches < pairs, "{searches} of {pairs}");
}

#[test]
fn a_pyramid_of_fifteen_cubes_stands() {
    pyramid(5, 30);
}

/// `cargo test --release --test stages -- --ignored --nocapture fifty_five`
/// (moved 3.6 mm, all of it down; 13 s).
#[test]
#[ignore = "takes a quarter of a minute"]
fn a_pyramid_of_fifty_five_cubes_stands() {
    pyramid(10, 30);
}

/// Five rings that lie on each other, each shifted by `shift` relative to the one below, alternately to both sides.
pub fn rings(shift: f32, seconds_to_settle: u32, seconds: usize) -> Moved {
    // The gap at rest of a ring of diameter 1.
    let mut world = World::of(&scenes::rings(shift, 0.0005));
    world.seconds(seconds_to_settle);
    watch(&mut world, seconds)
}

#[test]
fn five_rings_lie_on_each_other() {
    check("rings on one axis", &rings(0.0, 0, 30), 0.02, 0.02);
    check("rings across each other", &rings(0.25, 2, 30), 0.02, 0.02);
}
