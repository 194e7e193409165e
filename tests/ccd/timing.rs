//! Time per call: `cargo test --release --test stages ccd::timing -- --ignored --nocapture`.

use super::flights::{Flights, Random, flight, stay};
use super::shapes::{cuboid, sheet};
use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::{DQuat, DVec3, Vec3};
use std::f64::consts::TAU;
use std::time::Instant;

/// Fires `bullet` at `target` from random positions, over a path of `sizes` metres with up to `turns` revolutions, and
/// prints microseconds per call.
fn time(what: &str, target: TriMesh, bullet: TriMesh, sizes: f64, turns: f64, beside: f64) {
    let mut flights = Flights::new(&[target, bullet]);
    let mut random = Random::new(1);
    let (mut times, mut hits) = (Vec::new(), 0);
    for shot in 0..2200 {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, random.rotation()));
        let way = random.direction() * sizes;
        let aim = random.direction() * 0.8 + way.any_orthonormal_vector() * beside;
        let turn = random.direction() * turns * TAU;
        flights.add(1, Vec3::ONE, flight(aim - way * 0.5, random.rotation(), way, turn));
        let start = Instant::now();
        hits += usize::from(flights.time(0.005).is_some());
        if shot >= 200 {
            times.push(start.elapsed().as_secs_f64() * 1.0e6);
        }
    }
    times.sort_by(f64::total_cmp);
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    println!(
        "{what:58} {hits:5} hits; mean {mean:8.1} us, median {:8.1}, 99 % {:8.1}, most {:8.1}",
        times[times.len() / 2],
        times[times.len() * 99 / 100],
        times[times.len() - 1]
    );
}

#[test]
#[ignore = "prints times"]
fn microseconds_per_call() {
    let ball = || shapes::ball(0.5, 2);
    let plate = || sheet(8.0, 32);
    time("ball 320, 2048 triangles, 50 sizes", plate(), ball(), 50.0, 0.0, 0.0);
    time("the same, one turn", plate(), ball(), 50.0, 1.0, 0.0);
    time("the same, ten turns", plate(), ball(), 50.0, 10.0, 0.0);
    time("the same, ten turns, 5 sizes", plate(), ball(), 5.0, 10.0, 0.0);
    time("the same, 100 turns, 5 sizes", plate(), ball(), 5.0, 100.0, 0.0);
    time("the same, 500 sizes, one turn", plate(), ball(), 500.0, 1.0, 0.0);
    time("spheres miss", plate(), ball(), 50.0, 1.0, 10.0);
    time("two triangles", sheet(8.0, 1), ball(), 50.0, 1.0, 0.0);
    time("10082 triangles", sheet(8.0, 71), ball(), 50.0, 1.0, 0.0);
    time(
        "ball 5120, 10082 triangles",
        sheet(8.0, 71),
        shapes::ball(0.5, 4),
        50.0,
        1.0,
        0.0,
    );
    time(
        "box of 12 triangles, thin box",
        cuboid(Vec3::new(8.0, 8.0, 0.01)),
        shapes::cube(1.0),
        50.0,
        1.0,
        0.0,
    );
    time(
        "knot on knot, 1120 triangles each",
        shapes::knot_1120(),
        shapes::knot_1120(),
        50.0,
        1.0,
        0.0,
    );
    let facing = |flights: &mut Flights, turn: f64| {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        let travel = DVec3::NEG_Z * 50.0;
        flights.add(
            1,
            Vec3::ONE,
            flight(DVec3::Z * 20.0, DQuat::IDENTITY, travel, DVec3::Z * turn),
        );
        let start = Instant::now();
        let found = flights.time(0.005);
        println!(
            "sheets of 2048 and 10082 triangles, face to face: {found:?}, {:?}",
            start.elapsed()
        );
    };
    let mut flights = Flights::new(&[sheet(8.0, 71), sheet(8.0, 32)]);
    for turn in [0.0, 0.0, 1.0, 30.0] {
        facing(&mut flights, turn);
    }
}
