//! Impacts of many bodies at once, and how the bodies move after them.

use super::flights::{Flights, Random, flight, stay};
use super::oracle::distance;
use super::shapes::sheet;
use bevy_faceoff::ccd::{Impact, ImpactScratch, Pose, find_impacts};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::state::Plane;
use bevy_faceoff::types::body::{LockedAxes, RigidBody};
use glam::{DQuat, DVec3, Vec3};

const TARGET_DISTANCE: f32 = 0.005;

fn impacts(flights: &Flights, continuous: &[bool], pairs: &[[u32; 2]], scratch: &mut ImpactScratch) -> Vec<Impact> {
    impacts_that_pass(|_| false, flights, continuous, pairs, scratch)
}

/// Impacts of bodies, where some pass through some planes.
fn impacts_that_pass(
    pass: impl Fn([u32; 2]) -> bool,
    flights: &Flights,
    continuous: &[bool],
    pairs: &[[u32; 2]],
    scratch: &mut ImpactScratch,
) -> Vec<Impact> {
    let mut impacts = Vec::new();
    let (bodies, meshes) = (&flights.input.bodies, &flights.input.meshes);
    find_impacts(
        bodies,
        meshes,
        &flights.input.planes,
        pass,
        &flights.sweeps,
        continuous,
        pairs,
        |_| TARGET_DISTANCE,
        |_| None,
        scratch,
        &mut impacts,
    );
    impacts
}

fn fractions(flights: &Flights, continuous: &[bool], pairs: &[[u32; 2]], scratch: &mut ImpactScratch) -> Vec<f32> {
    let mut fractions = vec![1.0; flights.sweeps.len()];
    for impact in impacts(flights, continuous, pairs, scratch) {
        fractions[impact.body as usize] = impact.fraction;
    }
    fractions
}

/// Three sheets, one behind the other, and two balls whose paths cross all of them.
fn gallery() -> Flights {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::ball(0.25, 2)]);
    flights.add(0, Vec3::ONE, stay(DVec3::ZERO, DQuat::IDENTITY));
    flights.add(0, Vec3::ONE, stay(DVec3::Z * 5.0, DQuat::IDENTITY));
    let travel = DVec3::NEG_Z * 20.0;
    flights.add(1, Vec3::ONE, flight(DVec3::Z * 10.0, DQuat::IDENTITY, travel, DVec3::X));
    flights.add(
        1,
        Vec3::ONE,
        flight(DVec3::new(1.0, 0.0, 10.0), DQuat::IDENTITY, travel, DVec3::X),
    );
    flights.add(0, Vec3::ONE, stay(DVec3::Z * -5.0, DQuat::IDENTITY));
    flights
}

/// The sheet that the balls hit first is neither in the first pairs nor in the last.
const GALLERY: [[u32; 2]; 7] = [[0, 2], [0, 3], [1, 2], [1, 3], [2, 3], [2, 4], [3, 4]];

#[test]
fn the_earliest_impact_counts_and_only_for_continuous_bodies() {
    let flights = gallery();
    let scratch = &mut ImpactScratch::default();
    let found = fractions(&flights, &[false, false, true, false], &GALLERY, scratch);
    assert_eq!([found[0], found[1], found[3], found[4]], [1.0; 4]);
    assert!((0.23..0.24).contains(&found[2]), "{found:?}");
    let both = fractions(&flights, &[false, false, true, true], &GALLERY, scratch);
    assert_eq!(both[2], found[2]);
    assert!((0.23..0.24).contains(&both[3]), "{found:?}");
    // Without the nearer sheet the other one impacts them.
    let found = fractions(&flights, &[false, false, true, false], &GALLERY[..2], scratch);
    assert!((0.48..0.49).contains(&found[2]), "{found:?}");
    // Bodies at rest have an impact if a moving one hits them.
    let found = fractions(&flights, &[true, true], &GALLERY, scratch);
    assert!(
        (0.23..0.24).contains(&found[1]) && (0.48..0.49).contains(&found[0]),
        "{found:?}"
    );
    assert_eq!(found[2..], [1.0; 3]);
    // Missing flags count as not continuous.
    assert_eq!(fractions(&flights, &[], &GALLERY, scratch), [1.0; 5]);
}

#[test]
fn two_bodies_that_collide_stop_at_the_same_time_and_at_the_target_distance() {
    let mut flights = Flights::new(&[shapes::torus_240()]);
    let mut random = Random::new(8);
    let mut met = 0;
    for _ in 0..200 {
        flights.clear();
        for side in [-1.0, 1.0] {
            let from = DVec3::X * side * 20.0 + random.direction() * 0.3;
            let travel = DVec3::NEG_X * side * 40.0;
            let turn = random.direction() * 10.0;
            flights.add(0, Vec3::ONE, flight(from, random.rotation(), travel, turn));
        }
        let found = fractions(&flights, &[true; 2], &[[0, 1]], &mut ImpactScratch::default());
        assert_eq!(found[0], found[1]);
        if found[0] < 1.0 {
            met += 1;
            let gap = distance(&flights.moving_meshes(), f64::from(found[0]), 1.0) / f64::from(TARGET_DISTANCE);
            assert!((0.99..1.26).contains(&gap), "{gap} target distances");
        }
    }
    assert!(met > 100, "{met}");
}

/// The pose `other` relative to `one`.
fn seen_from(one: &Pose, other: &Pose) -> Pose {
    let back = one.rotation.inverse();
    Pose {
        center: back * (other.center - one.center),
        rotation: back * other.rotation,
    }
}

#[test]
fn a_body_that_hits_a_door_is_carried_by_it() {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::ball(0.25, 2)]);
    for turn in [DVec3::ZERO, DVec3::X * 0.4, DVec3::Z * 2.0] {
        flights.clear();
        let door = flight(DVec3::ZERO, DQuat::IDENTITY, DVec3::new(0.1, 0.2, 0.7), turn);
        let ball = flight(DVec3::new(0.3, 0.5, 5.0), DQuat::IDENTITY, DVec3::Z * -20.0, DVec3::Y);
        flights.add(0, Vec3::ONE, door);
        flights.add(1, Vec3::ONE, ball);
        let found = impacts(&flights, &[false, true], &[[0, 1]], &mut ImpactScratch::default());
        let [Impact { body: 1, fraction, end }] = found[..] else {
            panic!("{found:?}");
        };
        assert!((0.2..0.3).contains(&fraction));
        // Equal up to the rounding of the fraction to single precision.
        let (then, now) = (
            seen_from(&door.at(fraction.into()), &ball.at(fraction.into())),
            seen_from(&door.at(1.0), &end),
        );
        assert!(then.center.distance(now.center) < 1.0e-5, "{then:?}, {now:?}");
        // A body with locked axes is not carried.
        flights.input.bodies.params[1].locked_axes = LockedAxes::TRANSLATION | LockedAxes::ROTATION;
        let held = impacts(&flights, &[false, true], &[[0, 1]], &mut ImpactScratch::default());
        assert!(held[0].end.center.distance(ball.at(fraction.into()).center) < 1.0e-5);
    }
}

#[test]
fn two_bodies_that_collide_conserve_momentum_in_any_frame_of_reference() {
    let mut flights = Flights::new(&[shapes::ball(0.5, 2)]);
    let wind = DVec3::new(30.0, -7.0, 11.0);
    let mut ends = Vec::new();
    for wind in [DVec3::ZERO, wind] {
        flights.clear();
        for (i, (from, travel)) in [(0.0, 2.0), (3.0, -4.0)].into_iter().enumerate() {
            let sweep = flight(DVec3::X * from, DQuat::IDENTITY, DVec3::X * travel + wind, DVec3::ZERO);
            flights.add(0, Vec3::ONE, sweep);
            // The second one has twice the mass.
            flights.input.bodies.inverse_mass[i] = [1.0, 0.5][i];
        }
        let found = impacts(&flights, &[true; 2], &[[0, 1]], &mut ImpactScratch::default());
        let middle = (found[0].end.center + 2.0 * found[1].end.center) / 3.0;
        // (3 * 2 - 4 * 2 + 2) / 3: a collision does not change the motion of the common centre of mass.
        assert!(
            middle.distance(DVec3::X * (2.0 + (2.0 - 8.0) / 3.0) + wind) < 1.0e-9,
            "{middle}"
        );
        let gap = found[1].end.center.x - found[0].end.center.x - 1.0;
        assert!((0.0..0.02).contains(&gap), "{gap}");
        ends.push([found[0].end, found[1].end]);
    }
    for (one, other) in ends[0].iter().zip(&ends[1]) {
        assert!((one.center + wind).distance(other.center) < 1.0e-5);
    }
}

/// A door pushes a ball that pushes another one: all three move as one.
#[test]
fn a_carried_body_carries_others() {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::ball(0.25, 2)]);
    let door = flight(DVec3::ZERO, DQuat::IDENTITY, DVec3::Z * 2.0, DVec3::ZERO);
    flights.add(0, Vec3::ONE, door);
    for height in [1.0, 2.0] {
        flights.add(1, Vec3::ONE, stay(DVec3::Z * height, DQuat::IDENTITY));
    }
    let pairs = [[0, 1], [0, 2], [1, 2]];
    let found = impacts(&flights, &[false, true, true], &pairs, &mut ImpactScratch::default());
    let heights: Vec<f64> = found.iter().map(|impact| impact.end.center.z).collect();
    assert_eq!(heights.len(), 2);
    // A ball's radius and then a diameter above the door, except for target distances and the ball's facets.
    for (height, wanted) in heights.iter().zip([2.25, 2.75]) {
        assert!((height - wanted).abs() < 0.03, "{heights:?}");
    }
}

#[test]
fn a_squeezed_body_stays_with_the_body_that_yields_less() {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::ball(0.25, 2)]);
    let (up, down) = (DVec3::Z * 2.0, DVec3::Z * -2.0);
    for (wall_is_first, kind) in [
        (true, RigidBody::Kinematic),
        (false, RigidBody::Kinematic),
        (true, RigidBody::Dynamic),
        (false, RigidBody::Dynamic),
    ] {
        flights.clear();
        let wall = stay(DVec3::ZERO, DQuat::IDENTITY);
        let door = flight(up, DQuat::IDENTITY, down, DVec3::ZERO);
        let ball = stay(DVec3::Z, DQuat::IDENTITY);
        let (sweeps, kinds) = if wall_is_first {
            ([wall, door], [RigidBody::Static, kind])
        } else {
            ([door, wall], [kind, RigidBody::Static])
        };
        for (sweep, kind) in sweeps.into_iter().zip(kinds) {
            let i = flights.add(0, Vec3::ONE, sweep);
            flights.input.bodies.kind[i as usize] = kind;
        }
        flights.add(1, Vec3::ONE, ball);
        let pairs = [[0, 2], [1, 2]];
        let found = impacts(&flights, &[false, false, true], &pairs, &mut ImpactScratch::default());
        let [Impact { body: 2, end, .. }] = found[..] else {
            panic!("{found:?}");
        };
        assert!((0.24..0.27).contains(&end.center.z), "{end:?}");
    }
}

/// A ball lies on the ground. Neither a ball that falls on it nor a closing door carries it into the ground.
#[test]
fn nothing_is_carried_into_a_half_space() {
    for with_door in [true, false] {
        let mut flights = Flights::new(&[sheet(4.0, 4), shapes::ball(0.25, 2)]);
        flights.input.planes.push(Plane {
            normal: Vec3::Z,
            ..Plane::default()
        });
        flights.add(1, Vec3::ONE, stay(DVec3::Z * 0.26, DQuat::IDENTITY));
        let way = DVec3::new(0.5, 0.0, -3.0);
        let above = flight(DVec3::Z, DQuat::IDENTITY, way, DVec3::ZERO);
        flights.add(usize::from(!with_door), Vec3::ONE, above);
        let found = impacts(&flights, &[true, !with_door], &[[0, 1]], &mut ImpactScratch::default());
        assert_eq!(found[0].body, 0);
        assert!((found[0].end.center.z - 0.26).abs() < 1.0e-9, "{found:?}");
        assert!(found[0].end.center.x > 0.1, "it is carried along the ground");
        if let Some(other) = found.get(1) {
            assert!(other.end.center.z > 0.74, "{found:?}");
        }
    }
}

/// The contacts of the first body with the first plane are dropped, so that another body carries it through.
#[test]
fn a_half_space_that_a_body_passes_does_not_hold_it() {
    let mut flights = Flights::new(&[sheet(4.0, 4), shapes::ball(0.25, 2)]);
    for distance in [0.0, -2.0] {
        flights.input.planes.push(Plane {
            normal: Vec3::Z,
            distance,
            ..Plane::default()
        });
    }
    flights.add(1, Vec3::ONE, stay(DVec3::Z * 0.26, DQuat::IDENTITY));
    flights.add(
        0,
        Vec3::ONE,
        flight(DVec3::Z, DQuat::IDENTITY, DVec3::NEG_Z * 2.0, DVec3::ZERO),
    );
    let end_if = |pass: &dyn Fn([u32; 2]) -> bool| {
        let found = impacts_that_pass(pass, &flights, &[true], &[[0, 1]], &mut ImpactScratch::default());
        found[0].end.center.z
    };
    assert!((end_if(&|_| false) - 0.26).abs() < 1e-9);
    assert!((end_if(&|pair| pair == [1, 2]) - 0.26).abs() < 1e-9);
    let carried = end_if(&|pair| pair == [0, 2]);
    assert!((-1.3..-1.0).contains(&carried), "{carried}");
}

/// Every body has an impact of its own, and in a row of bodies each passes its impact on.
#[test]
fn thousands_of_impacts_are_told_apart() {
    let count = 3000u32;
    let mut flights = Flights::new(&[shapes::ball(0.25, 1)]);
    let mut pairs = Vec::new();
    for i in 0..count {
        let at = DVec3::X * 5.0 * f64::from(i);
        let (stays, travel) = (stay(at, DQuat::IDENTITY), DVec3::NEG_Z * (4.0 + f64::from(i % 7)));
        let ball = flights.add(0, Vec3::ONE, stays);
        flights.add(
            0,
            Vec3::ONE,
            flight(at + DVec3::Z * 3.0, DQuat::IDENTITY, travel, DVec3::ZERO),
        );
        pairs.push([ball, ball + 1]);
    }
    let found = impacts(
        &flights,
        &vec![true; 2 * count as usize],
        &pairs,
        &mut ImpactScratch::default(),
    );
    assert_eq!(found.len(), 2 * count as usize);
    for (i, two) in found.chunks(2).enumerate() {
        let travel = 4.0 + (i % 7) as f64;
        let [still, fast] = [two[0], two[1]];
        assert_eq!([still.body, fast.body], [2 * i as u32, 2 * i as u32 + 1]);
        assert_eq!(still.fraction, fast.fraction);
        assert!((f64::from(still.fraction) - 2.5 / travel).abs() < 0.02, "{still:?}");
        // They share the momentum.
        let rest = 0.5 * travel * (1.0 - f64::from(still.fraction));
        assert!((still.end.center.z + rest).abs() < 1e-4, "{still:?}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut flights = Flights::new(&[shapes::torus_240(), shapes::cube(0.6), shapes::ball_320()]);
    let mut random = Random::new(9);
    for i in 0..60 {
        let (from, travel) = (random.direction() * 5.0, random.direction() * 12.0);
        let turn = random.direction() * 5.0;
        flights.add(i % 3, Vec3::ONE, flight(from, random.rotation(), travel, turn));
    }
    let pairs: Vec<[u32; 2]> = (0..60).flat_map(|a| (a + 1..60).map(move |b| [a, b])).collect();
    let flags: Vec<bool> = (0..60).map(|i| i % 4 != 0).collect();
    let mut scratch = ImpactScratch::default();
    let runs = [1, 1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| fractions(&flights, &flags, &pairs, &mut scratch));
        found.into_iter().map(f32::to_bits).collect::<Vec<_>>()
    });
    let stopped = runs[0].iter().filter(|bits| f32::from_bits(**bits) < 1.0).count();
    assert!(stopped > 15, "{stopped}");
    for run in &runs[1..] {
        assert_eq!(*run, runs[0]);
    }
}
