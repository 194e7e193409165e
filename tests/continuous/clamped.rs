//! Many bodies at once.

use crate::oracle::distance;
use crate::shapes::sheet;
use crate::world::{Random, World, flight, stay};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::stages::continuous::{ClampScratch, clamp};
use glam::{DQuat, DVec3, Vec3};

const SLACK: f32 = 0.005;

fn fractions(world: &World, continuous: &[bool], pairs: &[[u32; 2]], scratch: &mut ClampScratch) -> Vec<f32> {
    let mut fractions = vec![9.0];
    let (bodies, meshes) = (&world.state.bodies, &world.state.meshes);
    clamp(
        bodies,
        meshes,
        &world.sweeps,
        continuous,
        pairs,
        |_| SLACK,
        scratch,
        &mut fractions,
    );
    fractions
}

/// Three sheets, one behind the other, and two balls on ways through all of them.
fn gallery() -> World {
    let mut world = World::new(&[sheet(4.0, 4), shapes::ball(0.25, 2)]);
    world.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
    world.add(0, Vec3::ONE, stay(DVec3::Z * 5.0, DQuat::IDENTITY));
    let travel = DVec3::NEG_Z * 20.0;
    world.add(1, Vec3::ONE, flight(DVec3::Z * 10.0, DQuat::IDENTITY, travel, DVec3::X));
    world.add(
        1,
        Vec3::ONE,
        flight(DVec3::new(1.0, 0.0, 10.0), DQuat::IDENTITY, travel, DVec3::X),
    );
    world.add(0, Vec3::ONE, stay(DVec3::Z * -5.0, DQuat::IDENTITY));
    world
}

/// The sheet that counts is neither in the first pairs nor in the last.
const GALLERY: [[u32; 2]; 7] = [[0, 2], [0, 3], [1, 2], [1, 3], [2, 3], [2, 4], [3, 4]];

#[test]
fn the_first_of_several_counts_and_only_for_those_that_ask() {
    let world = gallery();
    let scratch = &mut ClampScratch::default();
    let found = fractions(&world, &[false, false, true, false], &GALLERY, scratch);
    assert_eq!([found[0], found[1], found[3], found[4]], [1.0; 4]);
    assert!((0.23..0.24).contains(&found[2]), "{found:?}");
    let both = fractions(&world, &[false, false, true, true], &GALLERY, scratch);
    assert_eq!(both[2], found[2]);
    assert!((0.23..0.24).contains(&both[3]), "{found:?}");
    // Without the nearer sheet the other one stops them.
    let found = fractions(&world, &[false, false, true, false], &GALLERY[..2], scratch);
    assert!((0.48..0.49).contains(&found[2]), "{found:?}");
    // Who does not move cannot be stopped, and too few flags are none.
    assert_eq!(fractions(&world, &[true, true], &GALLERY, scratch), [1.0; 5]);
    assert_eq!(fractions(&world, &[], &GALLERY, scratch), [1.0; 5]);
}

#[test]
fn two_that_meet_stop_at_the_same_time_and_apart() {
    let mut world = World::new(&[shapes::torus_240()]);
    let mut random = Random::new(8);
    let mut met = 0;
    for _ in 0..200 {
        world.clear();
        for side in [-1.0, 1.0] {
            let from = DVec3::X * side * 20.0 + random.direction() * 0.3;
            let travel = DVec3::NEG_X * side * 40.0;
            let turn = random.direction() * 10.0;
            world.add(0, Vec3::ONE, flight(from, random.rotation(), travel, turn));
        }
        let found = fractions(&world, &[true; 2], &[[0, 1]], &mut ClampScratch::default());
        assert_eq!(found[0], found[1]);
        if found[0] < 1.0 {
            met += 1;
            let gap = distance(&world.movers(), f64::from(found[0]), 1.0) / f64::from(SLACK);
            assert!((0.99..1.26).contains(&gap), "{gap} slacks");
        }
    }
    assert!(met > 100, "{met}");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut world = World::new(&[shapes::torus_240(), shapes::cube(0.6), shapes::ball_320()]);
    let mut random = Random::new(9);
    for i in 0..60 {
        let (from, travel) = (random.direction() * 5.0, random.direction() * 12.0);
        let turn = random.direction() * 5.0;
        world.add(i % 3, Vec3::ONE, flight(from, random.rotation(), travel, turn));
    }
    let pairs: Vec<[u32; 2]> = (0..60).flat_map(|a| (a + 1..60).map(move |b| [a, b])).collect();
    let flags: Vec<bool> = (0..60).map(|i| i % 4 != 0).collect();
    let mut scratch = ClampScratch::default();
    let runs = [1, 1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| fractions(&world, &flags, &pairs, &mut scratch));
        found.into_iter().map(f32::to_bits).collect::<Vec<_>>()
    });
    let stopped = runs[0].iter().filter(|bits| f32::from_bits(**bits) < 1.0).count();
    assert!(stopped > 15, "{stopped}");
    for run in &runs[1..] {
        assert_eq!(*run, runs[0]);
    }
}
