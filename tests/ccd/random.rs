//! Times of impact of many kinds of meshes on random paths, against distances at many poses along them.

use super::flights::{Flights, Random, flight};
use super::oracle::{distance, first_near};
use super::shapes::{cuboid, moved, sheet};
use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::{DQuat, DVec3, Quat, Vec3};
use std::f64::consts::TAU;

fn meshes() -> Vec<TriMesh> {
    let aside = |mesh: &TriMesh| moved(mesh, Quat::from_rotation_x(0.4), Vec3::new(2.0, -1.0, 0.5));
    vec![
        sheet(1.4, 1),
        sheet(1.0, 5),
        cuboid(Vec3::new(1.2, 0.9, 0.01)),
        cuboid(Vec3::new(0.004, 0.004, 1.5)),
        shapes::ball(0.5, 1),
        aside(&shapes::torus(8, 6, 0.35, 0.15)),
        aside(&shapes::torus(10, 4, 0.44, 0.06)),
        aside(&shapes::cube(0.8)),
    ]
}

#[derive(Default, Debug)]
struct Outcomes {
    stopped: usize,
    free: usize,
    near: usize,
}

/// Checks random pairs and counts their outcomes. `turns` is the largest number of revolutions, and `samples` the
/// number of poses at which distances are computed.
fn compare(seed: u64, count: usize, turns: f64, far: f64, samples: usize) -> Outcomes {
    let meshes = meshes();
    let mut flights = Flights::new(&meshes);
    let mut random = Random::new(seed);
    let mut found = Outcomes::default();
    for case in 0..count {
        flights.clear();
        let middle = random.direction() * far;
        let target_distance = random.range(0.002, 0.02);
        for end in 0..2 {
            let mesh = random.below(meshes.len());
            let mut scale = [0; 3].map(|_| random.range(0.4, 1.5) * [1.0, 1.0, -1.0][random.below(3)]);
            if case % 3 == 0 {
                scale = [scale[0]; 3];
            }
            // They approach each other, and some miss.
            let side = [-1.0, 1.0][end];
            let from = middle + DVec3::X * side * random.range(0.4, 2.0) + random.direction() * 0.5;
            let travel = DVec3::NEG_X * side * random.range(0.0, 4.0) + random.direction() * 0.7;
            let turn = random.direction() * random.range(0.0, turns) * TAU;
            let scale = Vec3::from_array(scale.map(|s| s as f32));
            flights.add(mesh, scale, flight(from, random.rotation(), travel, turn));
        }
        let time = flights.time(target_distance as f32);
        let target_distance = f64::from(target_distance as f32);
        let moving_meshes = flights.moving_meshes();
        let about = format!("case {case} of {seed}, {time:?}, target_distance {target_distance}");
        // Rounding errors: of the time in single precision, and of positions far from the origin.
        let rounding = 1.0e-6 + 1.0e-14 * far;
        match time.map(f64::from) {
            Some(time) => {
                // Never late.
                let early = first_near(&moving_meshes, target_distance - rounding, samples, time);
                assert_eq!(early, None, "{about}: late");
                // Never early.
                let gap = distance(&moving_meshes, time, 1.0);
                assert!(gap < 1.25 * target_distance + rounding, "{about}: {gap} apart");
                found.stopped += 1;
            }
            None if distance(&moving_meshes, 0.0, 1.0) < 1.25 * target_distance + rounding => found.near += 1,
            None => {
                let missed = first_near(&moving_meshes, target_distance - rounding, samples, 1.0);
                assert_eq!(missed, None, "{about}: missed");
                found.free += 1;
            }
        }
    }
    found
}

#[test]
fn without_turns() {
    let found = compare(1, 160, 0.0, 0.0, 120);
    assert!(found.stopped > 50 && found.free > 20, "{found:?}");
}

#[test]
fn with_turns() {
    let found = compare(2, 160, 0.5, 0.0, 120);
    assert!(found.stopped > 50 && found.free > 20, "{found:?}");
}

#[test]
fn with_many_turns() {
    let found = compare(3, 60, 15.0, 0.0, 350);
    assert!(found.stopped > 20 && found.free > 4, "{found:?}");
}

#[test]
fn far_from_the_origin() {
    let found = compare(4, 120, 1.0, 3.0e6, 120);
    assert!(found.stopped > 35 && found.free > 10, "{found:?}");
}

/// A small body and a large one.
#[test]
fn of_different_sizes() {
    let mut flights = Flights::new(&[sheet(1.0, 5), shapes::ball(0.5, 1)]);
    let mut random = Random::new(7);
    for size in [1.0e-3, 1.0e-5] {
        for _ in 0..50 {
            flights.clear();
            let aim = DVec3::new(random.range(-0.4, 0.4), random.range(-0.4, 0.4), 0.0);
            let way = random.direction();
            let way = if way.z > 0.0 { -way } else { way } - DVec3::Z * 0.2;
            flights.add(
                0,
                Vec3::ONE,
                flight(DVec3::ZERO, DQuat::IDENTITY, DVec3::ZERO, DVec3::ZERO),
            );
            let from = aim - way * 0.5;
            let turn = random.direction() * 3.0;
            flights.add(1, Vec3::splat(size as f32), flight(from, random.rotation(), way, turn));
            let target_distance = 0.1 * size;
            let time = f64::from(flights.time(target_distance as f32).expect("a hit"));
            let gap = distance(&flights.moving_meshes(), time, 1.0) / target_distance;
            assert!((0.99..1.26).contains(&gap), "{gap} target distances at size {size}");
        }
    }
}
