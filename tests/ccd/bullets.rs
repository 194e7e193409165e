//! Fast bodies do not tunnel through thin ones.

use super::flights::{Flights, Random, flight, stay};
use super::shapes::{cuboid, moved, sheet};
use bevy_faceoff::ccd::{Impact, ImpactScratch, find_impacts};
use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::{DQuat, DVec3, Quat, Vec3};

const TARGET_DISTANCE: f32 = 0.005;
const WIDTH: f64 = 8.0;
/// Upper bound for the bounding radius of the bullets.
const RADIUS: f64 = 0.55;

/// The bullets, each of size 1.
fn bullets() -> [TriMesh; 3] {
    [
        moved(&shapes::ball(0.5, 1), Quat::IDENTITY, Vec3::new(3.0, 0.0, 0.0)),
        cuboid(Vec3::new(0.02, 0.02, 1.0)),
        shapes::torus_240(),
    ]
}

/// Fires bullets at `target`, which is mesh 0 and thin along its z axis, from all sides, over a path of `sizes` metres
/// with the target in the middle. Returns the number of bullets and of hits.
fn fire(target: TriMesh, sizes: f64, far: DVec3) -> [usize; 2] {
    let [ball, needle, torus] = bullets();
    let mut flights = Flights::new(&[target, ball, needle, torus]);
    let (mut scratch, mut impacts) = (ImpactScratch::default(), Vec::new());
    let mut random = Random::new(sizes as u64);
    let mut hits = 0;
    let count = 1000;
    for shot in 0..count {
        flights.clear();
        let plate = random.rotation();
        flights.add(0, Vec3::ONE, stay(far, plate));
        // In the plate's axes. Every second bullet is aimed beside the plate.
        let aims_at = shot % 2 == 0;
        let aside = if aims_at {
            random.range(0.0, 0.22 * WIDTH)
        } else {
            0.75 * WIDTH + RADIUS + random.range(0.0, 1.0)
        };
        let around = random.range(0.0, 6.3);
        let aim = DVec3::new(around.cos(), around.sin(), 0.0) * aside;
        let from = loop {
            let way = random.direction();
            if way.z.abs() > if aims_at { 0.35 } else { 0.7 } {
                break way;
            }
        };
        let start = aim + from * (0.5 * sizes).max(RADIUS / from.z.abs() + 0.1);
        let turn = random.direction() * random.range(0.0, 1.0) * [0.0, 1.0, 60.0][random.below(3)];
        let sweep = flight(far + plate * start, random.rotation(), plate * (-from * sizes), turn);
        flights.add(1 + random.below(3), Vec3::ONE, sweep);
        let input = &flights.input;
        find_impacts(
            &input.bodies,
            &input.meshes,
            &[],
            |_| false,
            &flights.sweeps,
            &[false, true],
            &[[0, 1]],
            |_| TARGET_DISTANCE,
            |_| None,
            &mut scratch,
            &mut impacts,
        );
        if !aims_at {
            assert!(
                impacts.is_empty(),
                "shot {shot} was stopped although it passes beside the plate"
            );
            continue;
        }
        let [Impact { body: 1, fraction, .. }] = impacts[..] else {
            panic!("shot {shot} is not stopped: {impacts:?}");
        };
        // All of the bullet is on the side from which it came.
        let stopped = flights.moving_mesh(1).at(f64::from(fraction), far);
        let height = |p: &DVec3| (plate.inverse() * *p).z * from.z.signum();
        let lowest = stopped.iter().flatten().map(height).fold(f64::INFINITY, f64::min);
        assert!(lowest > 0.0, "shot {shot} is through: {lowest}");
        // It is not far from the plate.
        assert!(
            lowest < 0.0051 + 1.25 * f64::from(TARGET_DISTANCE),
            "shot {shot} is stopped at {lowest}"
        );
        hits += 1;
    }
    [count, hits]
}

fn fire_from_all_distances(target: impl Fn() -> TriMesh) {
    for sizes in [5.0, 50.0, 500.0] {
        assert_eq!(fire(target(), sizes, DVec3::ZERO), [1000, 500]);
    }
    assert_eq!(fire(target(), 50.0, DVec3::new(1.0e6, -3.0e6, 1.0e5)), [1000, 500]);
}

#[test]
fn a_thin_box_stops_bullets() {
    fire_from_all_distances(|| cuboid(Vec3::new(WIDTH as f32, WIDTH as f32, 0.01)));
}

#[test]
fn two_triangles_stop_bullets() {
    fire_from_all_distances(|| sheet(WIDTH as f32, 1));
}

#[test]
fn two_thousand_triangles_stop_bullets() {
    assert_eq!(fire(sheet(WIDTH as f32, 32), 50.0, DVec3::ZERO), [1000, 500]);
}

#[test]
fn ten_thousand_triangles_stop_bullets() {
    assert_eq!(fire(sheet(WIDTH as f32, 71), 500.0, DVec3::ZERO), [1000, 500]);
}

/// A cube that moves along the plate, a little above it or through it, has its impact where a formula says.
#[test]
fn grazing_paths_are_decided_by_the_target_distance() {
    let mut flights = Flights::new(&[sheet(WIDTH as f32, 8), shapes::cube(1.0)]);
    for (height, expected) in [
        (1.3 * TARGET_DISTANCE, false),
        (0.9 * TARGET_DISTANCE, true),
        (0.5 * TARGET_DISTANCE, true),
        (-0.1, true),
    ] {
        flights.clear();
        flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
        let from = DVec3::new(-50.0, 0.3, 0.5 + f64::from(height));
        let travel = DVec3::new(100.0, 0.0, 0.0);
        flights.add(1, Vec3::ONE, flight(from, DQuat::IDENTITY, travel, DVec3::ZERO));
        let time = flights.time(TARGET_DISTANCE);
        assert_eq!(time.is_some(), expected, "at {height}: {time:?}");
        let margin_at_edge = (f64::from(TARGET_DISTANCE).powi(2) - f64::from(height).powi(2))
            .max(0.0)
            .sqrt();
        if let Some(time) = time.filter(|_| height > 0.0) {
            // The lower front edge of the cube reaches the target distance from the plate's edge.
            let reached = -49.5 + 100.0 * f64::from(time);
            let edge = -0.5 * WIDTH;
            assert!(reached < edge - margin_at_edge + 1.0e-5, "at {height}: {reached}");
            assert!(
                reached > edge - 1.3 * f64::from(TARGET_DISTANCE),
                "at {height}: {reached}"
            );
        }
    }
}
