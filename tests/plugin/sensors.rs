//! What sensors notice, and what is told of touches that come and go.

use crate::app::{DT, Sim, assert_near, place, resting, sorted};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// Gravity, ground at height 0, and exact events.
fn on_the_ground() -> Sim {
    let mut sim = Sim::new().exact();
    sim.world().insert_resource(Gravity(Vec3::NEG_Y * 10.0));
    sim.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    sim
}

/// How often a pair was told to begin and to end.
fn told(sim: &Sim, one: Entity, other: Entity) -> [usize; 2] {
    let pair = sorted(one, other);
    let starts = sim.started.iter().filter(|s| [s.collider1, s.collider2] == pair);
    let ends = sim.ended.iter().filter(|e| [e.collider1, e.collider2] == pair);
    [starts.count(), ends.count()]
}

fn zone(sim: &mut Sim, at: Vec3) -> Entity {
    let cube = sim.mesh(&shapes::cube(2.0));
    sim.spawn((
        cube,
        Sensor,
        Transform::from_translation(at),
        CollidingEntities::default(),
    ))
}

pub fn a_sensor_keeps_what_falls_asleep_in_it() {
    for kind in [None, Some(RigidBody::Static), Some(RigidBody::Kinematic)] {
        // Wholly in it, and across its wall.
        for at in [Vec3::Y * 0.9, Vec3::new(1.0, 0.9, 0.3)] {
            let mut sim = on_the_ground();
            let ball = sim.mesh(&shapes::ball(0.25, 2));
            let zone = zone(&mut sim, Vec3::ZERO);
            if let Some(kind) = kind {
                sim.set(zone, kind);
            }
            let body = sim.spawn((resting(&ball, at), CollidingEntities::default()));
            sim.step(200);
            assert!(sim.get::<Sleeping>(body).0);
            assert_eq!(told(&sim, zone, body), [1, 0], "{kind:?} at {at}");
            assert_eq!(*sim.get::<CollidingEntities>(zone), [body]);
            assert!(sim.get::<CollidingEntities>(body).contains(&zone));
            let collision = sim.collisions().get(zone, body).unwrap();
            assert_eq!(collision.contained, at.x == 0.0);
            assert_eq!(collision.faces.unwrap().is_empty(), collision.contained);
            // It wakes and goes on.
            sim.set(body, LinearVelocity(Vec3::X * 4.0));
            sim.step(100);
            assert_eq!(told(&sim, zone, body), [1, 1]);
        }
    }
}

/// A lake 1 m deep.
pub fn a_plane_can_be_a_sensor() {
    for response in [Response::Contacts, Response::Impulse] {
        let mut sim = on_the_ground();
        sim.world().insert_resource(response);
        let ball = sim.mesh(&shapes::ball(0.25, 2));
        let surface = PlaneCollider::through(Vec3::Y, Vec3::Y);
        let lake = sim.spawn((surface, Sensor, CollidingEntities::default()));
        let falls = sim.spawn(resting(&ball, Vec3::Y * 3.0));
        let dives = sim.spawn((
            RigidBody::Kinematic,
            ball.clone(),
            Transform::from_xyz(2.0, 1.5, 0.0),
            LinearVelocity(Vec3::NEG_Y),
        ));
        let stone = sim.spawn((ball, Transform::from_xyz(4.0, 0.25, 0.0)));
        sim.step(12);
        assert!(
            sim.get::<CollidingEntities>(lake).is_empty(),
            "it sees no static {stone}"
        );
        sim.step(32);
        assert_near(sim.velocity(falls), Vec3::NEG_Y * 44.0 * 10.0 * DT, 1e-4);
        assert_eq!([told(&sim, lake, falls), told(&sim, lake, dives)], [[1, 0]; 2]);
        let collision = sim.collisions().get(lake, falls).unwrap();
        assert!(collision.points.is_empty(), "nothing is pushed");
        sim.step(200);
        if response == Response::Contacts {
            assert!(sim.get::<Sleeping>(falls).0);
        }
        assert_near(sim.position(falls), Vec3::Y * 0.25, 0.01);
        assert_eq!(*sim.get::<CollidingEntities>(lake), sorted(falls, dives));
        sim.set(falls, LinearVelocity(Vec3::Y * 8.0));
        sim.step(50);
        assert_eq!([told(&sim, lake, falls), told(&sim, lake, dives)], [[1, 1], [1, 0]]);
    }
}

pub fn a_sensor_spawned_over_sleepers_reports_them_until_it_goes() {
    let mut sim = on_the_ground();
    let ball = sim.mesh(&shapes::ball(0.25, 2));
    let body = sim.spawn(resting(&ball, Vec3::Y * 0.26));
    sim.step(100);
    assert!(sim.get::<Sleeping>(body).0);
    let zone = zone(&mut sim, Vec3::ZERO);
    sim.step(1);
    assert_eq!(told(&sim, zone, body), [1, 0]);
    sim.step(50);
    assert_eq!(told(&sim, zone, body), [1, 0]);
    assert!(sim.get::<Sleeping>(body).0, "a sensor wakes nobody");
    sim.set(zone, Transform::from_xyz(9.0, 0.0, 0.0));
    sim.step(1);
    assert_eq!(told(&sim, zone, body), [1, 1]);
    sim.set(zone, Transform::default());
    sim.step(20);
    assert_eq!(told(&sim, zone, body), [2, 1]);
    sim.world().despawn(zone);
    sim.step(1);
    assert_eq!(told(&sim, zone, body), [2, 2]);
}

pub fn a_dynamic_sensor_that_falls_asleep_goes_on_reporting() {
    let mut sim = on_the_ground();
    let (ball, cube) = (sim.mesh(&shapes::ball(0.25, 2)), sim.mesh(&shapes::cube(1.0)));
    let block = sim.spawn((cube, Transform::from_xyz(0.8, 1.0, 0.0)));
    let body = sim.spawn(resting(&ball, Vec3::Y * 0.26));
    let sensor = sim.spawn((
        resting(&ball, Vec3::new(0.4, 0.3, 0.0)),
        Sensor,
        GravityScale(0.0),
        CollidingEntities::default(),
    ));
    sim.set(block, Transform::from_xyz(1.0, 0.5, 0.0));
    sim.step(200);
    assert!(sim.get::<Sleeping>(sensor).0 && sim.get::<Sleeping>(body).0);
    for other in [block, body] {
        assert_eq!(told(&sim, sensor, other), [1, 0]);
    }
    let mut others = vec![block, body];
    others.sort_by_key(place);
    assert_eq!(*sim.get::<CollidingEntities>(sensor), others);
}

/// A cube of edge 1 keeps a gap of 8.7 mm and is looked at up to 17 mm away.
pub fn who_falls_asleep_beside_a_wall_does_not_begin_to_touch_it() {
    let mut sim = on_the_ground();
    let cube = sim.mesh(&shapes::cube(1.0));
    let wall = sim.spawn((cube.clone(), Transform::from_xyz(1.013, 0.5, 0.0)));
    let body = sim.spawn(resting(&cube, Vec3::Y * 0.51));
    sim.step(100);
    assert!(sim.get::<Sleeping>(body).0);
    assert_eq!(told(&sim, wall, body), [0, 0]);
    assert!(!sim.touch(wall, body));
}

/// A sensor 0.2 m thick in the plane x = 0.
fn gate(sim: &mut Sim) -> Entity {
    let cube = sim.mesh(&shapes::cube(1.0));
    let flat = Transform::from_scale(Vec3::new(0.2, 4.0, 4.0));
    sim.spawn((cube, Sensor, flat, CollidingEntities::default()))
}

/// From 16 starts within the way of a step.
fn starts() -> impl Iterator<Item = f32> {
    (0..16).map(|phase| -2.0 - 30.0 * DT * phase as f32 / 16.0)
}

pub fn what_is_fast_and_flagged_is_noticed_by_a_sensor_and_not_stopped() {
    let mut unseen = 0;
    for (start, flagged) in starts().flat_map(|start| [(start, true), (start, false)]) {
        let mut sim = Sim::new();
        let gate = gate(&mut sim);
        let ball = sim.mesh(&shapes::ball(0.05, 2));
        let body = sim.spawn((resting(&ball, Vec3::X * start), LinearVelocity(Vec3::X * 30.0)));
        if flagged {
            sim.set(body, ContinuousCollision);
        }
        let mut passed = false;
        for step in 1..=12 {
            let (before, ends) = (sim.position(body).x, sim.ended.len());
            sim.step(1);
            let after = sim.position(body).x;
            assert_near(sim.position(body), Vec3::X * (start + 30.0 * DT * step as f32), 1e-5);
            let Some(collision) = sim.collisions().get(gate, body) else {
                // A pass within one step ends without waiting.
                assert!(!passed || sim.ended.len() == ends + 1);
                passed = false;
                continue;
            };
            let is_inside = before.abs() < 0.15;
            passed = collision.passing;
            assert_eq!(passed, !is_inside, "from {before} to {after}");
            if passed {
                // Where the ball's front meets the sensor's, but for its corners.
                assert_near(collision.contact.point, Vec3::X * -0.1, 3e-3);
                let out = if collision.collider1 == body { 1.0 } else { -1.0 };
                assert_near(collision.contact.normal, Vec3::X * out, 1e-3);
                assert_eq!(*sim.get::<CollidingEntities>(gate), [body]);
            }
        }
        sim.step(20);
        let seen = told(&sim, gate, body);
        if flagged {
            assert_eq!(seen, [1, 1], "from {start}");
        } else {
            unseen += usize::from(seen == [0, 0]);
        }
        assert_eq!(sim.velocity(body), Vec3::X * 30.0);
    }
    // A way of 0.47 m a step, and 0.3 m to be seen in.
    assert!((4..=8).contains(&unseen), "{unseen} of 16 unseen without the flag");
}

pub fn a_flagged_sensor_notices_what_it_passes() {
    for start in starts() {
        let mut sim = Sim::new();
        let gate = gate(&mut sim);
        let ball = sim.mesh(&shapes::ball(0.05, 2));
        let body = sim.spawn(resting(&ball, Vec3::ZERO));
        sim.set(
            gate,
            (
                RigidBody::Kinematic,
                ContinuousCollision,
                LinearVelocity(Vec3::X * 30.0),
                Transform::from_xyz(start, 0.0, 0.0).with_scale(Vec3::new(0.2, 4.0, 4.0)),
            ),
        );
        sim.step(30);
        assert_eq!(told(&sim, gate, body), [1, 1], "from {start}");
        assert_eq!(sim.velocity(body), Vec3::ZERO);
    }
}

pub fn a_bullet_that_is_stopped_is_noticed_up_to_there_and_no_farther() {
    let mut sim = Sim::new();
    let (cube, ball) = (sim.mesh(&shapes::cube(1.0)), sim.mesh(&shapes::ball(0.05, 2)));
    let flat = Vec3::new(0.2, 4.0, 4.0);
    let [before, wall, behind] =
        [0.0, 1.0, 2.0].map(|x| sim.spawn((cube.clone(), Transform::from_xyz(x, 0.0, 0.0).with_scale(flat))));
    sim.set(before, Sensor);
    sim.set(behind, Sensor);
    let bullet = sim.spawn((
        resting(&ball, Vec3::X * -3.0),
        LinearVelocity(Vec3::X * 400.0),
        ContinuousCollision,
    ));
    sim.step(30);
    assert_eq!(told(&sim, before, bullet)[0], 1);
    assert!(told(&sim, wall, bullet)[0] >= 1);
    assert_eq!(told(&sim, behind, bullet), [0, 0]);
}

/// A ball of 1,280 faces rolls for eight seconds over a pad that reaches 0.75 mm above the ground, which some of its
/// corners touch and some of its faces do not. Tells how often the pair was told to begin and to end, and in which
/// steps it touched.
fn roll_over_a_pad(hysteresis: Option<f32>) -> ([usize; 2], Vec<bool>) {
    let mut sim = on_the_ground();
    sim.world()
        .insert_resource(hysteresis.map_or_else(EventHysteresis::default, EventHysteresis));
    let (ball, cube) = (sim.mesh(&shapes::ball(0.25, 3)), sim.mesh(&shapes::cube(1.0)));
    let flat = Transform::from_xyz(0.0, -0.5, 0.0).with_scale(Vec3::new(60.0, 1.0015, 9.0));
    let pad = sim.spawn((cube, Sensor, flat));
    let body = sim.spawn((
        resting(&ball, Vec3::new(-8.0, 0.25025, 0.0)),
        LinearVelocity(Vec3::X),
        AngularVelocity(Vec3::Z * -4.0),
    ));
    let mut touched = Vec::new();
    for _ in 0..512 {
        sim.step(1);
        touched.push(sim.touch(pad, body));
    }
    (told(&sim, pad, body), touched)
}

pub fn touches_that_come_and_go_are_told_once_unless_they_are_to_be_exact() {
    let ([starts, ends], touched) = roll_over_a_pad(Some(0.0));
    let begun = touched.windows(2).filter(|pair| !pair[0] && pair[1]).count() + usize::from(touched[0]);
    assert!(starts > 8, "{starts}");
    assert_eq!((starts, ends), (begun, begun - usize::from(touched[511])));
    for hysteresis in [None, Some(0.05), Some(f32::INFINITY), Some(f32::NAN)] {
        let (told, the_same) = roll_over_a_pad(hysteresis);
        assert_eq!(told, [1, 0], "{hysteresis:?}");
        assert_eq!(the_same, touched, "`Collisions` is exact");
    }
}

/// 0.1 s are 6.4 steps.
pub fn an_end_is_told_when_it_has_lasted_and_again_after_going_back() {
    for (hysteresis, steps) in [
        (None, 7),
        (Some(0.0), 1),
        (Some(-1.0), 1),
        (Some(3.0 * DT), 3),
        (Some(0.5), 32),
    ] {
        let mut sim = Sim::new();
        sim.world()
            .insert_resource(hysteresis.map_or_else(EventHysteresis::default, EventHysteresis));
        let zone = zone(&mut sim, Vec3::ZERO);
        let ball = sim.mesh(&shapes::ball(0.25, 2));
        let body = sim.spawn((resting(&ball, Vec3::X * 1.2), LinearVelocity(Vec3::X)));
        while sim.report().step < 2 || sim.touch(zone, body) {
            sim.step(1);
        }
        // The first step without a touch is done.
        let mut before = 1;
        let snapshot = Snapshot::take(sim.world());
        for _ in 0..2 {
            while told(&sim, zone, body) == [1, 0] {
                assert_eq!(*sim.get::<CollidingEntities>(zone), [body]);
                sim.step(1);
                before += 1;
            }
            assert_eq!(told(&sim, zone, body), [1, 1]);
            assert_eq!(before, steps, "{hysteresis:?}");
            assert!(sim.get::<CollidingEntities>(zone).is_empty());
            if steps == 1 {
                break;
            }
            snapshot.restore(sim.world());
            sim.ended.clear();
            sim.step(1);
            before = 2;
        }
    }
}

pub fn an_end_is_told_at_once_if_one_of_the_two_is_gone() {
    for rejected in [true, false] {
        let mut sim = Sim::new();
        let zone = zone(&mut sim, Vec3::ZERO);
        let ball = sim.mesh(&shapes::ball(0.25, 2));
        let body = sim.spawn((resting(&ball, Vec3::X * 1.2), LinearVelocity(Vec3::X)));
        while sim.report().step < 2 || sim.touch(zone, body) {
            sim.step(1);
        }
        assert_eq!(told(&sim, zone, body), [1, 0]);
        if rejected {
            sim.set(body, Mass(f32::NAN));
        } else {
            sim.world().despawn(body);
        }
        sim.step(1);
        assert_eq!(told(&sim, zone, body), [1, 1]);
        assert_eq!(sim.rejected.len(), usize::from(rejected));
        assert!(sim.get::<CollidingEntities>(zone).is_empty());
    }
}

/// Without any ground, and beside another body that flies alike.
pub fn who_flies_in_company_is_noticed_by_a_sensor_too() {
    for start in starts() {
        let mut sim = Sim::new();
        let gate = gate(&mut sim);
        let ball = sim.mesh(&shapes::ball(0.05, 2));
        let fly = |at: Vec3| (resting(&ball, at), LinearVelocity(Vec3::X * 30.0));
        sim.spawn(fly(Vec3::new(start, 50.0, 0.0)));
        let body = sim.spawn(fly(Vec3::X * start));
        sim.set(body, ContinuousCollision);
        sim.step(32);
        assert_eq!(told(&sim, gate, body), [1, 1], "from {start}");
    }
}
