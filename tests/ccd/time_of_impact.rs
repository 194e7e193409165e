//! Times of impact against times that follow from a formula.

use super::flights::{Flights, Random, flight, stay};
use super::shapes::{cuboid, moved, sheet};
use bevy_faceoff::geometry::shapes;
use glam::{DQuat, DVec3, Quat, Vec3};

const TARGET_DISTANCE: f32 = 0.01;

/// Checks that at `time` the lowest point, at `height`, is between 1 and 5/4 target distances above the plane.
fn require(time: Option<f32>, height: impl Fn(f64) -> f64, what: &str) -> f64 {
    let time = f64::from(time.unwrap_or_else(|| panic!("{what} is not stopped")));
    let gap = height(time) / f64::from(TARGET_DISTANCE);
    assert!(
        (0.9999..1.2501).contains(&gap),
        "{what}: {gap} target distances above the plane at {time}"
    );
    time
}

#[test]
fn a_body_without_rotation_stops_where_its_lowest_corner_arrives() {
    let mut flights = Flights::new(&[sheet(20.0, 10), shapes::ball(0.5, 2), shapes::knot_1120()]);
    let mut random = Random::new(1);
    for shot in 0..300 {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        let from = DVec3::new(random.range(-2.0, 2.0), random.range(-2.0, 2.0), random.range(1.0, 4.0));
        let travel = DVec3::new(random.range(-6.0, 6.0), random.range(-6.0, 6.0), -9.0);
        let scale = Vec3::new(1.0, if shot % 3 == 0 { -0.5 } else { 1.0 }, 0.8);
        flights.add(
            1 + shot % 2,
            scale,
            flight(from, random.rotation(), travel, DVec3::ZERO),
        );
        let corners = flights.moving_mesh(1).triangles;
        let reach = corners.iter().flatten().map(|p| p.z).fold(f64::INFINITY, f64::min);
        require(
            flights.time(TARGET_DISTANCE),
            |t| from.z + travel.z * t + reach,
            &format!("shot {shot}"),
        );
    }
}

#[test]
fn a_rod_that_rotates_in_place_reaches_the_plane() {
    let half = DVec3::new(0.05, 0.05, 1.0);
    let mut flights = Flights::new(&[sheet(20.0, 10), cuboid((half * 2.0).as_vec3())]);
    let mut random = Random::new(2);
    for shot in 0..200 {
        // It starts horizontal and makes up to ten revolutions about y. Corner (x, z) is then x sin - z cos below the
        // centre.
        let height = random.range(0.1, 0.99);
        let turn = random.range(2.0, 60.0);
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        let lying = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let at = DVec3::new(0.5, 0.2, height);
        flights.add(1, Vec3::ONE, flight(at, lying, DVec3::ZERO, DVec3::Y * turn));
        let radius = half.x.hypot(half.z);
        let ahead = (half.x / half.z).atan();
        let lowest = |t: f64| height - radius * (turn * t + ahead).sin();
        let time = require(flights.time(TARGET_DISTANCE), lowest, &format!("rod {shot}"));
        assert!(
            turn * time + ahead < 1.6,
            "rod {shot} is stopped in its first quarter turn"
        );
    }
}

#[test]
fn a_ball_that_spins_fast_stops_as_one_that_does_not() {
    let mut flights = Flights::new(&[sheet(20.0, 10), shapes::ball(0.5, 3)]);
    let mut random = Random::new(3);
    for turns in [1.0, 10.0, 30.0, 100.0] {
        for shot in 0..10 {
            flights.clear();
            flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
            let (from, travel) = (DVec3::new(0.1, 0.2, 3.0), DVec3::new(1.0, 0.0, -5.0));
            let turn = random.direction() * turns * std::f64::consts::TAU;
            flights.add(1, Vec3::ONE, flight(from, random.rotation(), travel, turn));
            // Its corners are on a sphere of radius 0.5, its faces within one of 0.493.
            let time = f64::from(flights.time(TARGET_DISTANCE).expect("a hit"));
            let height = from.z + travel.z * time;
            let range = 0.493 + f64::from(TARGET_DISTANCE)..0.5 + 1.26 * f64::from(TARGET_DISTANCE);
            assert!(range.contains(&height), "shot {shot} at {turns} turns: {height}");
        }
    }
}

/// There is no impact before the tips can reach the plane, and there must be one half a revolution later.
#[test]
fn thousands_of_turns_are_not_missed() {
    let half = DVec3::new(0.05, 0.05, 1.0);
    let mut flights = Flights::new(&[sheet(20.0, 10), cuboid((half * 2.0).as_vec3())]);
    for turn in [1.0e3, 1.0e4, 1.0e5] {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        let from = DVec3::new(0.5, 0.2, 3.0);
        flights.add(
            1,
            Vec3::ONE,
            flight(from, DQuat::IDENTITY, DVec3::NEG_Z * 5.0, DVec3::Y * turn),
        );
        let time = f64::from(flights.time(TARGET_DISTANCE).expect("a hit"));
        let tips = (3.0 - half.x.hypot(half.z) - f64::from(TARGET_DISTANCE)) / 5.0;
        assert!(time < tips + std::f64::consts::PI / turn, "late at {turn}: {time}");
        assert!(
            time > tips - 0.1 * f64::from(TARGET_DISTANCE),
            "early at {turn}: {time}"
        );
    }
}

/// The leading corners are on the axis of rotation.
#[test]
fn a_needle_that_spins_about_its_axis_flies_as_if_it_did_not() {
    let mut flights = Flights::new(&[sheet(20.0, 10), cuboid(Vec3::new(0.001, 0.001, 1.0))]);
    flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
    let travel = DVec3::NEG_Z * 500.0;
    let spin = DVec3::Z * 10_000.0;
    flights.add(1, Vec3::ONE, flight(DVec3::Z * 250.0, DQuat::IDENTITY, travel, spin));
    require(flights.time(TARGET_DISTANCE), |t| 250.0 - 500.0 * t - 0.5, "the needle");
}

#[test]
fn both_may_move() {
    let mut flights = Flights::new(&[
        shapes::cube(1.0),
        moved(&shapes::cube(1.0), Quat::IDENTITY, Vec3::Y * 4.0),
    ]);
    let far = DVec3::new(2.0e5, 1.0e5, -3.0e5);
    flights.add(
        0,
        Vec3::ONE,
        flight(far, DQuat::IDENTITY, DVec3::X * 30.0, DVec3::X * 0.1),
    );
    let from = far + DVec3::new(20.0, 0.1, 0.1);
    flights.add(
        1,
        Vec3::splat(2.0),
        flight(from, DQuat::IDENTITY, DVec3::X * -70.0, DVec3::X * 4.0),
    );
    require(flights.time(TARGET_DISTANCE), |t| 20.0 - 100.0 * t - 1.5, "the cube");
    // Bodies side by side with the same velocity never collide, however fast they are.
    flights.clear();
    let travel = DVec3::new(400.0, 300.0, 200.0);
    flights.add(0, Vec3::ONE, flight(far, DQuat::IDENTITY, travel, DVec3::ZERO));
    flights.add(
        1,
        Vec3::ONE,
        flight(far + DVec3::X * 1.02, DQuat::IDENTITY, travel, DVec3::ZERO),
    );
    assert_eq!(flights.time(TARGET_DISTANCE), None);
}
