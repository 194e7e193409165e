//! Chains of rings: they hang, are shaken, and stay linked.

use crate::world::World;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::types::body::RigidBody;
use glam::{DVec3, Quat, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Radii of the ring's centre line and of its tube.
const LINE: f64 = 0.44;
const TUBE: f64 = 0.06;

/// `count` rings, each through the next; the first is static.
fn chain(count: usize) -> World {
    let mut world = World::new();
    let ring = world.mesh(&shapes::ring());
    for i in 0..count {
        let kind = if i == 0 { RigidBody::Static } else { RigidBody::Dynamic };
        let turn = Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { FRAC_PI_2 });
        world.add(kind, ring, Vec3::ONE, Vec3::NEG_Y * (0.74 * i as f32), turn);
    }
    world
}

/// The linking number of two rings' centre lines: how often the second goes through the disc of the first, less how often
/// it comes back.
fn linking(world: &World, a: usize, b: usize) -> i32 {
    let [a, b] = [a, b].map(|i| &world.state.input.bodies.frame[i]);
    let (normal, from) = (a.rotation.z_axis, a.center);
    // Heights of the second line's points over the disc's plane: mean + x cos(t) + y sin(t).
    let mean = normal.dot(b.center - from);
    let [x, y] = [b.rotation.x_axis, b.rotation.y_axis].map(|axis| LINE * normal.dot(axis));
    let swing = x.hypot(y);
    if mean.abs() >= swing {
        return 0;
    }
    let (middle, half) = (y.atan2(x), (-mean / swing).acos());
    let passes = |t: f64| {
        let point = b.center + b.rotation * (LINE * DVec3::new(t.cos(), t.sin(), 0.0));
        i32::from(point.distance(from) < LINE)
    };
    // Above the plane between the two, below it elsewhere.
    passes(middle - half) - passes(middle + half)
}

fn check_links(world: &World, when: &str) {
    for i in 1..world.state.input.bodies.len() {
        let number = linking(world, i - 1, i);
        assert_eq!(number.abs(), 1, "{when}: rings {} and {i}", i - 1);
    }
}

#[test]
fn the_linking_number_tells_links_from_neighbours() {
    let mut world = chain(3);
    assert_eq!(linking(&world, 0, 1).abs(), 1);
    assert_eq!(linking(&world, 1, 2).abs(), 1);
    assert_eq!(linking(&world, 0, 2), 0);
    world.state.input.bodies.frame[1].center.y -= 2.0 * (LINE + 0.01) - 0.74;
    assert_eq!(linking(&world, 0, 1), 0, "just out of it");
}

/// Hangs for so many seconds, is shaken, and hangs again.
pub fn hangs_and_is_shaken(count: usize, [seconds, shaken, afterwards]: [usize; 3]) {
    let mut world = chain(count);
    let watched = |world: &mut World, when: &str| {
        world.step();
        check_links(world, when);
        world.deepest()
    };
    let mut deepest = [0.0f32; 3];
    for _ in 0..64 * seconds {
        deepest[0] = deepest[0].max(watched(&mut world, "hanging"));
    }
    // Two tubes lie on each other inside both rings.
    let wanted = (count - 1) as f64 * (2.0 * LINE - 2.0 * TUBE);
    let length = world.center(0).distance(world.center(count - 1));
    let fastest = world.fastest();

    world.state.input.bodies.kind[0] = RigidBody::Kinematic;
    let start = world.center(0);
    for k in 0..64 * shaken {
        // 0.3 m to both sides, once a second.
        let at = |k: usize| 0.3 * (TAU * k as f32 / 64.0).sin();
        world.state.input.bodies.linear_velocity[0] = Vec3::X * 64.0 * (at(k + 1) - at(k));
        deepest[1] = deepest[1].max(watched(&mut world, "shaken"));
    }
    assert!(world.center(0).distance(start) < 1.0e-3, "back where it was");
    world.state.input.bodies.linear_velocity[0] = Vec3::ZERO;
    for _ in 0..64 * afterwards {
        deepest[2] = deepest[2].max(watched(&mut world, "afterwards"));
    }
    println!(
        "{count} rings: {length:.4} m long after {seconds} s, {:+.3} % off, fastest {fastest:.4} m/s; deepest {:.2} % of the \
         diameter, shaken {:.2} %, afterwards {:.2} %",
        100.0 * (length / wanted - 1.0),
        100.0 * deepest[0],
        100.0 * deepest[1],
        100.0 * deepest[2]
    );
    assert!((length / wanted - 1.0).abs() < 0.03, "{length}, not {wanted}");
    assert!(deepest.iter().all(|d| *d < 0.05), "{deepest:?}");
}

#[test]
fn a_chain_of_ten_hangs_is_shaken_and_holds() {
    hangs_and_is_shaken(10, [10, 5, 10]);
}

/// `cargo test --release --test dynamics -- --ignored --nocapture chain_of_fifty`
/// (0.43 % short; deepest 0.7 % of the diameter; 37 s).
#[test]
#[ignore = "takes a minute"]
fn a_chain_of_fifty_hangs_is_shaken_and_holds() {
    hangs_and_is_shaken(50, [60, 5, 10]);
}
