//! Bodies that a game moves by writing `Transform`: lifts, doors, teleports. Other tests run them on a GPU.

use crate::app::{DT, Sim, assert_near, end_of, resting, sorted};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;

/// A simulation with gravity and a kinematic slab of 4 x 1 x 4 m whose top is at 0, with a cube of 1 m at rest on it.
fn lift() -> (Sim, Entity, Entity) {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Contacts);
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let size = Vec3::new(4.0, 1.0, 4.0);
    let slab = sim.spawn((
        RigidBody::Kinematic,
        cube.clone(),
        Transform::from_xyz(0.0, -0.5, 0.0).with_scale(size),
    ));
    let rider = sim.spawn((RigidBody::Dynamic, cube, Transform::from_xyz(0.0, 0.5, 0.0)));
    sim.step(32);
    (sim, slab, rider)
}

fn shift(sim: &mut Sim, entity: Entity, by: Vec3) {
    sim.world().get_mut::<Transform>(entity).unwrap().translation += by;
}

pub fn a_lift_moved_by_its_transform_carries_what_stands_on_it() {
    let (mut sim, slab, rider) = lift();
    for way in [Vec3::Y * 1.5, Vec3::X * 1.0] {
        let start = sim.position(rider);
        for step in 0..96 {
            shift(&mut sim, slab, way * DT);
            let wanted = sim.get::<Transform>(slab);
            sim.step(1);
            assert_eq!(sim.get::<Transform>(slab), wanted, "it is where the game put it");
            assert_near(sim.velocity(slab), way, 1e-4);
            if step >= 48 {
                assert_near(sim.velocity(rider), way, 0.02);
            }
        }
        // It is taken along within a few steps by friction, and at once by the push from below.
        let late = way * 96.0 * DT - (sim.position(rider) - start);
        assert!(late.length() < 0.12, "{late}");
        let height = sim.position(rider).y - sim.position(slab).y;
        assert!((height - 1.0).abs() < 0.004, "{height}");
        // It stops with the lift.
        sim.step(64);
        assert_near(sim.velocity(rider), Vec3::ZERO, 1e-3);
    }
}

pub fn a_door_turned_by_its_transform_sweeps_a_ball_away() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Contacts);
    let cube = sim.mesh(&shapes::cube(1.0));
    let ball = sim.mesh(&shapes::ball(0.25, 3));
    let hinge = sim.spawn(Transform::from_xyz(1.0, 0.0, 0.0));
    let leaf = Transform::from_xyz(1.0, 0.0, 0.0).with_scale(Vec3::new(2.0, 2.0, 0.1));
    sim.spawn((RigidBody::Kinematic, cube, leaf, ChildOf(hinge)));
    let ball = sim.spawn(resting(&ball, Vec3::new(2.5, 0.0, -0.5)));
    sim.step(1);
    // A quarter turn in a second.
    for _ in 0..64 {
        let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 * DT);
        sim.world().get_mut::<Transform>(hinge).unwrap().rotate(turn);
        sim.step(1);
    }
    // 1.5 m from the hinge the leaf moves at 2.4 m/s. Along it the ball may slide outward.
    let speed = sim.velocity(ball).length();
    assert!((1.5..6.0).contains(&speed), "{speed}");
    assert!(sim.position(ball).z < -1.0, "{}", sim.position(ball));
}

/// Its velocity can be read while it moves, does not move it when nobody moves it, and stays when it becomes dynamic.
pub fn a_slab_that_is_moved_has_a_velocity_and_goes_on_with_it() {
    let (mut sim, slab, _) = slab_beside_a_body();
    let (way, turn) = (Vec3::new(-1.0, 0.5, 0.0), Vec3::Z * 0.25);
    let drive = |sim: &mut Sim, steps: usize| {
        for _ in 0..steps {
            shift(sim, slab, way * DT);
            let mut transform = sim.world().get_mut::<Transform>(slab).unwrap();
            transform.rotate(Quat::from_scaled_axis(turn * DT));
            sim.step(1);
        }
    };
    drive(&mut sim, 8);
    assert_near(sim.velocity(slab), way, 1e-4);
    assert_near(sim.spin(slab), turn, 1e-4);
    // It stands still.
    let at = sim.position(slab);
    sim.step(4);
    assert_eq!(sim.position(slab), at);
    assert_eq!((sim.velocity(slab), sim.spin(slab)), (Vec3::ZERO, Vec3::ZERO));
    // It is moved again, and then by a velocity of its own.
    drive(&mut sim, 4);
    sim.set(slab, LinearVelocity(Vec3::X * -2.0));
    let at = sim.position(slab);
    sim.step(4);
    assert_near(sim.position(slab), at - Vec3::X * 2.0 * 4.0 * DT, 1e-5);
    assert_eq!((sim.velocity(slab), sim.spin(slab)), (Vec3::X * -2.0, Vec3::ZERO));
    sim.set(slab, LinearVelocity(Vec3::ZERO));
    sim.step(1);
    drive(&mut sim, 4);
    // What is left out of steps keeps it, and is not moved by it afterwards.
    sim.set(slab, RigidBodyDisabled);
    sim.step(2);
    sim.world().entity_mut(slab).remove::<RigidBodyDisabled>();
    let at = sim.position(slab);
    sim.step(2);
    assert_eq!(sim.position(slab), at);
    drive(&mut sim, 4);
    sim.set(slab, RigidBody::Dynamic);
    let at = sim.position(slab);
    sim.step(16);
    assert_near(sim.velocity(slab), way, 1e-3);
    assert_near(sim.position(slab), at + way * 16.0 * DT, 1e-3);
    assert_near(sim.spin(slab), turn, 1e-3);
}

/// A weightless body at the origin and a kinematic slab, half a metre before it, after two steps.
fn slab_beside_a_body() -> (Sim, Entity, Entity) {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Contacts);
    let cube = sim.mesh(&shapes::cube(1.0));
    let slab = sim.spawn((
        RigidBody::Kinematic,
        cube.clone(),
        Transform::from_xyz(-1.1, 0.0, 0.0).with_scale(Vec3::new(0.2, 2.0, 2.0)),
    ));
    let body = sim.spawn((RigidBody::Dynamic, cube, Transform::default()));
    sim.step(2);
    (sim, slab, body)
}

pub fn a_slab_that_teleports_pushes_nothing_and_one_that_is_moved_does() {
    for teleports in [true, false] {
        let (mut sim, slab, body) = slab_beside_a_body();
        shift(&mut sim, slab, Vec3::X * 0.6);
        if teleports {
            // Beyond the body.
            shift(&mut sim, slab, Vec3::X * 2.0);
            sim.set(slab, Teleport);
        }
        sim.step(1);
        let speed = sim.velocity(body).length();
        assert_eq!(speed == 0.0, teleports, "{speed}");
        assert!(sim.app.world().get::<Teleport>(slab).is_none(), "the marker is used up");
        sim.step(8);
        assert_eq!(sim.velocity(body).length() == 0.0, teleports);
        let at = if teleports { 1.5 } else { -0.5 };
        assert_near(sim.position(slab), Vec3::X * at, 1e-6);
    }
}

pub fn a_slab_that_teleports_while_it_is_left_out_pushes_nothing_when_it_returns() {
    let (mut sim, slab, body) = slab_beside_a_body();
    sim.set(slab, RigidBodyDisabled);
    sim.step(4);
    shift(&mut sim, slab, Vec3::X * 2.6);
    sim.set(slab, Teleport);
    sim.step(4);
    sim.world().entity_mut(slab).remove::<RigidBodyDisabled>();
    sim.step(8);
    assert_eq!(sim.velocity(body), Vec3::ZERO);
    assert_near(sim.position(slab), Vec3::X * 1.5, 1e-6);
}

pub fn a_body_of_several_colliders_is_moved_by_its_transform_too() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Contacts);
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let tray = sim.spawn((RigidBody::Kinematic, Transform::default()));
    let part = |at: Vec3, size: Vec3| {
        let pose = Transform::from_translation(at).with_scale(size);
        (cube.clone(), pose, ChildOf(tray))
    };
    sim.spawn(part(Vec3::new(0.0, -0.1, 0.0), Vec3::new(3.0, 0.2, 3.0)));
    sim.spawn(part(Vec3::new(-1.6, 0.2, 0.0), Vec3::new(0.2, 0.8, 3.0)));
    let rider = sim.spawn((
        RigidBody::Dynamic,
        cube.clone(),
        Transform::from_xyz(0.0, 0.5, 0.0),
        Friction::new(0.0),
    ));
    sim.step(32);
    // The rim, a metre from the rider, takes it along.
    for _ in 0..128 {
        shift(&mut sim, tray, Vec3::X * DT);
        let wanted = sim.get::<Transform>(tray);
        sim.step(1);
        assert_eq!(sim.get::<Transform>(tray), wanted);
    }
    assert_near(sim.velocity(rider), Vec3::X, 0.02);
    assert!((sim.position(rider).y - 0.5).abs() < 0.004);
}

/// A `Transform` written to a dynamic body is a teleport: the body keeps its velocity, and its collision ends at once.
pub fn a_dynamic_body_that_is_put_elsewhere_ends_its_collisions_at_once() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Contacts);
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let ground = sim.spawn((cube.clone(), Transform::from_xyz(0.0, -0.5, 0.0)));
    let body = sim.spawn((
        RigidBody::Dynamic,
        cube,
        Transform::from_xyz(0.0, 0.5, 0.0),
        CollidingEntities::default(),
    ));
    sim.step(16);
    assert_eq!(sim.get::<CollidingEntities>(body)[..], [ground]);
    let before = sim.velocity(body);
    shift(&mut sim, body, Vec3::Y * 10.0);
    sim.step(1);
    assert!(sim.get::<CollidingEntities>(body).is_empty());
    assert_eq!(sim.ended, [end_of(sorted(ground, body))]);
    assert_near(sim.velocity(body), before - Vec3::Y * 9.81 * DT, 1e-4);
    sim.step(16);
    assert_eq!((sim.started.len(), sim.ended.len()), (1, 1));
}

/// A trigger that is moved reports in the same step what it is put on.
pub fn a_sensor_is_tested_where_it_is_put() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Contacts);
    let cube = sim.mesh(&shapes::cube(1.0));
    let zone = sim.spawn((
        RigidBody::Kinematic,
        Sensor,
        cube.clone(),
        Transform::from_xyz(5.0, 0.0, 0.0),
    ));
    let body = sim.spawn(resting(&cube, Vec3::ZERO));
    sim.step(2);
    shift(&mut sim, zone, Vec3::X * -4.5);
    sim.step(1);
    assert!(sim.touch(zone, body));
}

/// With [`Response::None`] nothing is pushed: a body is where its `Transform` says when the step begins.
pub fn without_response_a_body_is_tested_where_it_is_put() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::None);
    let cube = sim.mesh(&shapes::cube(1.0));
    let moved = sim.spawn((RigidBody::Kinematic, cube.clone(), Transform::from_xyz(5.0, 0.0, 0.0)));
    let body = sim.spawn((RigidBody::Dynamic, cube, Transform::default()));
    sim.step(2);
    assert!(!sim.touch(moved, body));
    shift(&mut sim, moved, Vec3::X * -4.5);
    sim.step(1);
    assert!(sim.touch(moved, body));
}

/// A plane is in the coordinates of its entity, and follows it.
pub fn a_plane_follows_its_entity() {
    let mut sim = Sim::new();
    sim.world().insert_resource(Response::Contacts);
    sim.world().insert_resource(Gravity::default());
    let cube = sim.mesh(&shapes::cube(1.0));
    let parent = sim.spawn(Transform::from_xyz(0.0, 1.0, 0.0));
    let ground = sim.spawn((
        PlaneCollider::through(Vec3::Y * 0.5, Vec3::Y),
        Transform::from_xyz(3.0, 0.5, 0.0),
        ChildOf(parent),
    ));
    let body = sim.spawn(resting(&cube, Vec3::Y * 2.5));
    sim.step(128);
    assert!(sim.touch(ground, body));
    assert!((sim.position(body).y - 2.5).abs() < 0.002, "{}", sim.position(body));
    assert!(sim.get::<Sleeping>(body).0);
    // It sinks, the body wakes and follows.
    shift(&mut sim, parent, Vec3::Y * -1.0);
    sim.step(96);
    assert!((sim.position(body).y - 1.5).abs() < 0.002, "{}", sim.position(body));
    // It rises slowly, and pushes the body out.
    for _ in 0..64 {
        shift(&mut sim, ground, Vec3::Y * 0.005);
        sim.step(1);
    }
    sim.step(64);
    assert!((sim.position(body).y - 1.82).abs() < 0.004, "{}", sim.position(body));
    // Turned and scaled unequally: at 45 degrees and twice as wide, the surface rises by a half.
    let turned = Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
    sim.set(parent, Transform::from_scale(Vec3::new(2.0, 1.0, 1.0)));
    sim.set(ground, Transform::from_rotation(turned));
    sim.step(1);
    sim.set(body, Transform::from_xyz(-2.0, 5.0, 0.0));
    sim.set(body, LinearVelocity(Vec3::ZERO));
    sim.set(body, Friction::new(0.0).with_combine(CombineRule::Min));
    sim.step(192);
    // It slides down along the surface.
    let down = Vec3::new(-2.0, -1.0, 0.0).normalize();
    assert_near(sim.velocity(body).normalize(), down, 0.01);
}
