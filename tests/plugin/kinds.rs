//! Kinds of bodies, sensors and layers: who meets whom, and who pushes whom.

use crate::app::{Sim, assert_near, ball_like, end_of, resting, sorted, start_of};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

const KINDS: [RigidBody; 3] = [RigidBody::Dynamic, RigidBody::Kinematic, RigidBody::Static];

#[test]
fn a_pair_is_reported_if_one_of_it_is_dynamic() {
    for first in KINDS {
        for second in KINDS {
            let mut sim = Sim::new();
            let cube = sim.mesh(&shapes::cube(1.0));
            let one = sim.spawn(resting(&cube, Vec3::ZERO));
            let other = sim.spawn(resting(&cube, Vec3::splat(0.3)));
            sim.set(one, first);
            sim.set(other, second);
            sim.step(1);
            let expected = first == RigidBody::Dynamic || second == RigidBody::Dynamic;
            assert_eq!(sim.touch(one, other), expected, "{first:?} and {second:?}");
            assert_eq!(sim.started.len(), usize::from(expected));
            assert_eq!(sim.report().bodies, 2);
        }
    }
}

#[test]
fn a_mesh_collider_alone_is_static() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let ground = sim.spawn((cube.clone(), Transform::default()));
    let other = sim.spawn((cube.clone(), Transform::from_xyz(0.4, 0.0, 0.0)));
    let body = sim.spawn(resting(&cube, Vec3::new(0.2, 0.95, 0.0)));
    sim.step(2);
    assert!(!sim.touch(ground, other));
    assert!(sim.touch(ground, body));
    sim.step(20);
    assert_eq!(sim.position(ground), Vec3::ZERO);
    assert!(sim.app.world().get::<LinearVelocity>(ground).is_none());
}

/// Neither bodies nor questions find a plane that is disabled.
#[test]
fn a_disabled_plane_is_not_there() {
    fn is_hit(sim: &mut Sim, plane: Entity) -> bool {
        let ray = |world: SpatialQuery| {
            let start = Vec3::new(20.0, 3.0, 0.0);
            world.cast_ray(start, Dir3::NEG_Y, 9.0, &SpatialQueryFilter::default())
        };
        let hit = sim.world().run_system_cached(ray).unwrap();
        assert!(hit.is_none_or(|hit| hit.collider == plane));
        hit.is_some()
    }
    for response in [Response::Contacts, Response::Impulse] {
        let mut sim = Sim::new().exact();
        sim.world().insert_resource(response);
        sim.world().insert_resource(Gravity::default());
        let cube = sim.mesh(&shapes::cube(1.0));
        let plane = sim.spawn((PlaneCollider::default(), ColliderDisabled));
        let body = sim.spawn(resting(&cube, Vec3::Y * 0.499));
        // From here on there is somebody who asks.
        is_hit(&mut sim, plane);
        sim.step(16);
        assert!(!is_hit(&mut sim, plane));
        assert!(sim.position(body).y < 0.3);
        assert_eq!((sim.started.len(), sim.report().touching_pairs), (0, 0));

        sim.world().entity_mut(plane).remove::<ColliderDisabled>();
        sim.set(body, (Transform::from_xyz(0.0, 0.499, 0.0), LinearVelocity::default()));
        sim.step(128);
        assert!(is_hit(&mut sim, plane) && !sim.started.is_empty(), "{response:?}");
        assert!(sim.position(body).y > 0.4, "{response:?}");
        if response == Response::Contacts {
            assert!(sim.touch(plane, body) && sim.get::<Sleeping>(body).0);
        }

        // Who sleeps on it wakes.
        sim.set(plane, ColliderDisabled);
        sim.step(16);
        assert!(!is_hit(&mut sim, plane));
        assert!(sim.position(body).y < 0.4, "{response:?}");
        assert_eq!(sim.started.len(), sim.ended.len());
    }
}

#[test]
fn a_static_body_does_not_move_whatever_its_velocity() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let wall = sim.spawn((
        RigidBody::Static,
        cube.clone(),
        Transform::default(),
        LinearVelocity(Vec3::X * 50.0),
        AngularVelocity(Vec3::ONE),
    ));
    let body = sim.spawn((ball_like(&cube, Vec3::X * 1.01, Vec3::ZERO), GravityScale(0.0)));
    sim.step(30);
    assert_eq!(sim.get::<Transform>(wall), Transform::default());
    assert_eq!(sim.velocity(wall), Vec3::X * 50.0, "a user's value is left alone");
    assert_near(sim.velocity(body), Vec3::ZERO, 1e-5);
}

#[test]
fn a_kinematic_body_moves_by_its_velocity_pushes_and_is_not_pushed() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    let ball = sim.mesh(&shapes::ball(0.5, 2));
    let pusher = sim.spawn(ball_like(&ball, Vec3::Z * -1.5, Vec3::Z));
    sim.set(pusher, (RigidBody::Kinematic, AngularVelocity(Vec3::Z), Mass(1e-3)));
    let body = sim.spawn((ball_like(&ball, Vec3::ZERO, Vec3::ZERO), GravityScale(0.0), Mass(1e3)));
    sim.step(64);
    assert_eq!(sim.velocity(pusher), Vec3::Z);
    assert_eq!(sim.spin(pusher), Vec3::Z);
    assert_near(sim.position(pusher), Vec3::Z * -0.5, 1e-5);
    // A wall that moves at 1 and loses nothing throws a body that rests away at 2.
    assert_near(sim.velocity(body), Vec3::Z * 2.0, 2e-2);
}

#[test]
fn kinematic_bodies_pass_through_planes() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    sim.spawn(PlaneCollider::through(Vec3::X, Vec3::NEG_X));
    let body = sim.spawn(ball_like(&cube, Vec3::ZERO, Vec3::X * 4.0));
    sim.set(body, RigidBody::Kinematic);
    sim.step(64);
    assert_near(sim.position(body), Vec3::X * 4.0, 1e-5);
    assert!(sim.started.is_empty());
}

#[test]
fn a_body_may_change_its_kind_between_steps() {
    let mut sim = Sim::new().exact();
    let cube = sim.mesh(&shapes::cube(1.0));
    let [one, other] = [0.0, 0.3].map(|x| sim.spawn((cube.clone(), Transform::from_translation(Vec3::splat(x)))));
    sim.step(1);
    assert!(!sim.touch(one, other));
    sim.set(other, RigidBody::Dynamic);
    sim.step(1);
    assert!(sim.touch(one, other));
    sim.set(other, RigidBody::Kinematic);
    sim.step(1);
    assert!(!sim.touch(one, other));
    assert_eq!((sim.started.len(), sim.ended.len()), (1, 1));
}

#[test]
fn a_sensor_reports_and_neither_pushes_nor_is_pushed() {
    let mut sim = Sim::new();
    let torus = sim.mesh(&shapes::torus_240());
    let sensor = sim.spawn((ball_like(&torus, Vec3::X * -1.0, Vec3::X), Sensor));
    let body = sim.spawn(ball_like(&torus, Vec3::X, Vec3::NEG_X));
    sim.step(128);
    assert_near(sim.position(sensor), Vec3::X, 1e-4);
    assert_near(sim.position(body), Vec3::NEG_X, 1e-4);
    let pair = sorted(sensor, body);
    assert!(sim.started.contains(&start_of(pair)));
    assert!(sim.ended.contains(&end_of(pair)));
    assert_eq!(sim.spin(body), Vec3::ZERO);
}

#[test]
fn a_sensor_reports_a_plane_and_is_not_pushed_by_it() {
    let mut sim = Sim::new();
    let cube = sim.mesh(&shapes::cube(1.0));
    let plane = sim.spawn((PlaneCollider::through(Vec3::X, Vec3::NEG_X), Restitution::new(1.0)));
    let sensor = sim.spawn((ball_like(&cube, Vec3::ZERO, Vec3::X * 2.0), Sensor));
    sim.step(64);
    assert_near(sim.position(sensor), Vec3::X * 2.0, 1e-5);
    assert_eq!(sim.velocity(sensor), Vec3::X * 2.0);
    let pair = sorted(sensor, plane);
    assert_eq!(sim.started, [start_of(pair)]);
}

#[test]
fn a_sensor_in_the_way_does_not_change_how_others_bounce() {
    let bounce = |with_sensor: bool| {
        let mut sim = Sim::new();
        let ball = sim.mesh(&shapes::ball(0.5, 2));
        let one = sim.spawn(ball_like(&ball, Vec3::X * -1.0, Vec3::X));
        let other = sim.spawn(ball_like(&ball, Vec3::X, Vec3::NEG_X));
        if with_sensor {
            sim.spawn((resting(&ball, Vec3::ZERO), Sensor));
        }
        sim.step(100);
        (sim.velocity(one), sim.velocity(other), sim.started.len())
    };
    let (alone, beside) = (bounce(false), bounce(true));
    assert_eq!((alone.0, alone.1), (beside.0, beside.1));
    assert!(alone.0.x < 0.0 && beside.2 > alone.2);
}

#[test]
fn layers_let_two_bodies_meet_only_if_each_wants_the_other() {
    let layers = |memberships, filters| CollisionLayers { memberships, filters };
    let all = u32::MAX;
    for (one, other, meet) in [
        (CollisionLayers::default(), CollisionLayers::default(), true),
        (layers(1, 2), layers(2, 1), true),
        (layers(1, 2), layers(2, 4), false),
        (layers(1, 4), layers(2, 1), false),
        (layers(0, all), layers(1, all), false),
        (layers(1, 0), layers(1, all), false),
        (layers(3, 4), layers(1 << 31 | 4, 2), true),
    ] {
        let mut sim = Sim::new();
        let cube = sim.mesh(&shapes::cube(1.0));
        let a = sim.spawn((resting(&cube, Vec3::ZERO), one));
        let b = sim.spawn((resting(&cube, Vec3::splat(0.3)), other));
        sim.step(1);
        assert_eq!(sim.touch(a, b), meet, "{one:?} and {other:?}");
        assert_eq!(one.interacts_with(other), meet);
    }
}

#[test]
fn changing_layers_ends_a_touch_and_begins_it_again() {
    let mut sim = Sim::new().exact();
    let cube = sim.mesh(&shapes::cube(1.0));
    let one = sim.spawn((cube.clone(), Transform::default()));
    let other = sim.spawn(resting(&cube, Vec3::splat(0.3)));
    sim.step(1);
    sim.set(
        other,
        CollisionLayers {
            memberships: 2,
            filters: 2,
        },
    );
    sim.step(2);
    assert!(!sim.touch(one, other));
    assert_eq!((sim.started.len(), sim.ended.len()), (1, 1));
    sim.world().entity_mut(other).remove::<CollisionLayers>();
    sim.step(2);
    assert!(sim.touch(one, other));
    assert_eq!((sim.started.len(), sim.ended.len()), (2, 1));
}

#[test]
fn uneven_and_mirrored_scales_decide_who_touches() {
    let mut sim = Sim::new();
    // A wedge that is thick at x = -1 and an edge at x = 1; mirrored, the other way round.
    let points = [(-1, -1, -1), (-1, 1, -1), (-1, 0, 1), (1, -1, -1), (1, 1, -1)];
    let vertices = points.map(|(x, y, z)| Vec3::new(x as f32, y as f32, z as f32)).to_vec();
    let faces = vec![[0, 2, 1], [0, 1, 4], [0, 4, 3], [0, 3, 2], [1, 2, 4], [2, 3, 4]];
    let wedge = sim.mesh(&TriMesh::new(vertices, faces).unwrap());
    let probe = sim.mesh(&shapes::cube(0.2));
    let body = sim.spawn((RigidBody::Static, wedge, Transform::default()));
    let high = sim.spawn((resting(&probe, Vec3::new(-1.0, 0.0, 0.6)), Sensor));
    let far = sim.spawn((resting(&probe, Vec3::new(0.9, 0.0, 0.5)), Sensor));
    let wide = sim.spawn((resting(&probe, Vec3::new(-0.9, 2.5, -0.6)), Sensor));
    for (scale, touched) in [
        (Vec3::ONE, [true, false, false]),
        (Vec3::new(-1.0, 1.0, 1.0), [false, true, false]),
        (Vec3::new(1.0, 3.0, 1.0), [true, false, true]),
        (Vec3::new(1.0, 1.0, -1.0), [true, false, false]),
        (Vec3::new(-1.0, -3.0, 1.0), [false, true, false]),
        (Vec3::new(1.0, 3.0, 0.4), [false, false, false]),
    ] {
        sim.set(body, Transform::from_scale(scale));
        sim.step(1);
        let found = [high, far, wide].map(|probe| sim.touch(body, probe));
        assert_eq!(found, touched, "scaled by {scale}");
    }
}

#[test]
fn a_mirrored_body_bounces_like_the_one_it_mirrors() {
    let bounce = |scale: Vec3| {
        let mut sim = Sim::new();
        sim.world().insert_resource(Response::Impulse);
        let ball = sim.mesh(&shapes::ball(0.5, 2));
        let one = sim.spawn(ball_like(&ball, Vec3::Z * -1.0, Vec3::Z));
        let other = sim.spawn(ball_like(&ball, Vec3::Z, Vec3::NEG_Z));
        for body in [one, other] {
            sim.world().get_mut::<Transform>(body).unwrap().scale = scale;
        }
        sim.step(100);
        assert_eq!(sim.started.len(), 1);
        sim.velocity(one)
    };
    let plain = bounce(Vec3::ONE);
    assert_near(plain, Vec3::NEG_Z, 1e-2);
    assert_near(bounce(Vec3::new(1.0, 1.0, -1.0)), plain, 1e-2);
    assert_near(bounce(Vec3::new(-1.0, -1.0, -1.0)), plain, 1e-2);
}
