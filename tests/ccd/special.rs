//! Holes, bodies inside others, bodies that start close, and invalid input.

use super::flights::{Flights, Random, flight, stay};
use super::shapes::sheet;
use bevy_faceoff::ccd::{Pose, Sweep, time_of_impact};
use bevy_faceoff::geometry::shapes;
use glam::{DQuat, DVec3, Vec3};

const TARGET_DISTANCE: f32 = 0.005;

/// The ring has a diameter of 1 and a hole of 0.76, around z.
#[test]
fn a_body_that_flies_through_a_hole_is_not_stopped() {
    let mut flights = Flights::new(&[shapes::ring(), shapes::ball(0.2, 2)]);
    let mut random = Random::new(4);
    for shot in 0..300 {
        flights.clear();
        let ring = random.rotation();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, ring));
        let around = random.range(0.0, 6.3);
        let aside = DVec3::new(around.cos(), around.sin(), 0.0);
        let through = shot % 2 == 0;
        // The radius of the tube is 0.12 / 2, and that of its centre line 0.44.
        let aim = aside
            * if through {
                random.range(0.0, 0.16)
            } else {
                random.range(0.2, 0.6)
            };
        let way = DVec3::new(0.02, 0.01, -20.0);
        let turn = random.direction() * 20.0;
        let sweep = flight(ring * (aim - way * 0.5), random.rotation(), ring * way, turn);
        flights.add(1, Vec3::ONE, sweep);
        assert_eq!(
            flights.time(TARGET_DISTANCE).is_none(),
            through,
            "shot {shot} at {}",
            aim.length()
        );
    }
}

#[test]
fn a_body_inside_another_stays_inside() {
    let mut flights = Flights::new(&[shapes::cube(4.0), shapes::ball(0.2, 1)]);
    let mut random = Random::new(5);
    for _ in 0..100 {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        let way = random.direction() * 300.0;
        flights.add(1, Vec3::ONE, flight(DVec3::ZERO, random.rotation(), way, DVec3::ONE));
        let reached = way * f64::from(flights.time(TARGET_DISTANCE).expect("a wall"));
        let largest = reached.abs().max_element();
        assert!((1.78..1.82).contains(&largest), "{largest}");
    }
}

#[test]
fn bodies_that_start_close_have_no_impact() {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::cube(1.0)]);
    let mut at = |height: f64, target_distance: f32| {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        let from = DVec3::new(0.1, 0.2, 0.5 + height);
        flights.add(
            1,
            Vec3::ONE,
            flight(from, DQuat::IDENTITY, DVec3::NEG_Z * 50.0, DVec3::ZERO),
        );
        flights.time(target_distance)
    };
    assert_eq!(at(0.004, TARGET_DISTANCE), None, "near");
    assert_eq!(at(-0.1, TARGET_DISTANCE), None, "across");
    assert_eq!(at(0.0, 0.0), None, "touching");
    let time = at(0.0065, TARGET_DISTANCE).expect("not near yet") * 50.0;
    assert!((0.0001..=0.0015).contains(&time), "{time}");
    let time = at(1.0, 0.0).expect("a hit") * 50.0;
    assert!((0.9999..=1.0).contains(&time), "{time}");
    assert_eq!(
        at(1.0, -1.0).map(|t| t * 50.0),
        Some(time),
        "a negative target distance counts as 0"
    );
}

#[test]
fn paths_that_end_early_or_lead_away_have_no_impact() {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::cube(1.0)]);
    let mut by = |way: DVec3| {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        flights.add(1, Vec3::ONE, flight(DVec3::Z, DQuat::IDENTITY, way, DVec3::ZERO));
        flights.time(TARGET_DISTANCE)
    };
    assert_eq!(by(DVec3::NEG_Z * 0.4), None);
    assert_eq!(by(DVec3::Z * 100.0), None);
    assert_eq!(by(DVec3::X * 100.0), None);
    assert_eq!(by(DVec3::ZERO), None);
    assert!(by(DVec3::NEG_Z * 0.5).is_some());
}

#[test]
fn a_sweep_between_poses_ends_at_the_later_one() {
    let mut random = Random::new(6);
    for _ in 0..100 {
        let [before, after] = [0; 2].map(|_| Pose {
            center: random.direction() * 5.0,
            rotation: random.rotation(),
        });
        let sweep = Sweep::between(before, after);
        assert!(sweep.turn.length() < 3.15);
        let end = sweep.at(1.0);
        assert!((end.center - after.center).length() < 1.0e-12);
        assert!(end.rotation.dot(after.rotation).abs() > 1.0 - 1.0e-12);
        assert_eq!(sweep.at(0.0).center, before.center);
    }
}

#[test]
fn bad_input_has_no_impact() {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::cube(1.0)]);
    flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
    let good = flight(DVec3::Z * 2.0, DQuat::IDENTITY, DVec3::NEG_Z * 50.0, DVec3::ZERO);
    flights.add(1, Vec3::ONE, good);
    assert!(flights.time(TARGET_DISTANCE).is_some());
    assert_eq!(flights.time(f32::NAN), None);
    let input = &flights.input;
    for pair in [[0, 0], [0, 2], [7, 1]] {
        let sweeps = [&flights.sweeps[0], &flights.sweeps[1]];
        let time = time_of_impact(
            &input.bodies,
            &input.meshes,
            pair,
            sweeps,
            TARGET_DISTANCE,
            &mut flights.scratch,
        );
        assert_eq!(time, None);
    }
    let bad = [
        Sweep {
            travel: DVec3::NAN,
            ..good
        },
        Sweep {
            turn: DVec3::INFINITY,
            ..good
        },
        flight(DVec3::NAN, DQuat::IDENTITY, DVec3::Z, DVec3::Z),
        flight(DVec3::Z, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), DVec3::Z, DVec3::Z),
    ];
    for sweep in bad {
        flights.sweeps[1] = sweep;
        assert_eq!(flights.time(TARGET_DISTANCE), None, "{sweep:?}");
    }
}
