//! Colliders without a mesh asset: `BallCollider` and others.

use crate::app::Sim;
use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// A world with gravity and a floor whose top is at 0.
fn with_floor() -> Sim {
    let mut sim = Sim::new();
    sim.world().insert_resource(Gravity::default());
    sim.spawn((
        CuboidCollider::new(20.0, 1.0, 20.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    sim
}

fn height(sim: &Sim, entity: Entity) -> f32 {
    sim.position(entity).y
}

#[test]
fn each_shape_falls_onto_the_floor_and_rests_there() {
    let mut sim = with_floor();
    let at = |x: f32| (RigidBody::Dynamic, Transform::from_xyz(x, 2.0, 0.0));
    let ball = sim.spawn((BallCollider::new(0.4), at(-4.0)));
    let capsule = sim.spawn((CapsuleCollider::new(0.3, 0.8), at(-2.0)));
    let cuboid = sim.spawn((CuboidCollider::new(1.0, 0.6, 1.0).with_rounding(0.1), at(0.0)));
    let cylinder = sim.spawn((CylinderCollider::new(0.5, 0.8), at(2.0)));
    let cone = sim.spawn((ConeCollider::new(0.5, 0.8), at(4.0)));
    sim.step(64 * 3);
    assert!(sim.rejected.is_empty());
    for (entity, rest) in [(ball, 0.4), (cuboid, 0.3), (cylinder, 0.4), (cone, 0.2)] {
        let y = height(&sim, entity);
        assert!((y - rest).abs() < 0.005, "{entity}: {y}, not {rest}");
    }
    // A capsule that stands on its end may stay or fall over.
    let y = height(&sim, capsule);
    assert!(y > 0.295 && y < 0.705, "{y}");
}

#[test]
fn shapes_of_one_size_share_a_mesh() {
    let mut sim = Sim::new();
    let [a, b, c] = [0.5, 0.5, 0.6].map(|radius| sim.spawn(BallCollider::new(radius)));
    let mesh = |sim: &Sim, entity| sim.app.world().get::<MeshCollider>(entity).unwrap().0.id();
    let ids = [a, b, c].map(|entity| mesh(&sim, entity));
    assert_eq!(ids[0], ids[1]);
    assert_ne!(ids[0], ids[2]);
    // The last of a size takes its mesh with it.
    sim.world().despawn(c);
    sim.step(2);
    assert_eq!(sim.app.world().resource::<Assets<CollisionMesh>>().len(), 1);
}

#[test]
fn a_shape_that_changes_has_its_new_size_in_the_next_step() {
    let mut sim = with_floor();
    let ball = sim.spawn((
        RigidBody::Dynamic,
        BallCollider::new(0.4),
        Transform::from_xyz(0.0, 0.4, 0.0),
    ));
    sim.step(32);
    sim.world().get_mut::<BallCollider>(ball).unwrap().radius = 0.2;
    sim.step(64);
    let y = height(&sim, ball);
    assert!((y - 0.2).abs() < 0.002, "{y}");
}

#[test]
fn a_scaled_ball_is_a_larger_ball_and_part_of_a_body() {
    let mut sim = with_floor();
    let body = sim.spawn((RigidBody::Dynamic, Transform::from_xyz(0.0, 2.0, 0.0)));
    for x in [-1.0, 1.0] {
        let ball = Transform::from_xyz(x, 0.0, 0.0).with_scale(Vec3::splat(2.0));
        sim.spawn((BallCollider::new(0.2), ball, ChildOf(body)));
    }
    sim.step(64 * 2);
    let y = height(&sim, body);
    assert!((y - 0.4).abs() < 0.003, "{y}");
}

#[test]
fn a_shape_without_a_size_is_refused_and_told() {
    let mut sim = Sim::new();
    let ball = sim.spawn((RigidBody::Dynamic, BallCollider::new(-1.0), Transform::default()));
    sim.step(2);
    assert!(sim.rejected.iter().any(|rejected| rejected.entity == ball));
    sim.world().get_mut::<BallCollider>(ball).unwrap().radius = 1.0;
    sim.step(2);
    assert_eq!(sim.report().bodies, 1);
}

#[test]
fn a_sensor_ball_detects_what_comes_within_its_radius() {
    let mut sim = Sim::new();
    let sensor = sim.spawn((Sensor, BallCollider::new(2.0), Transform::default()));
    let near = sim.spawn((
        RigidBody::Dynamic,
        BallCollider::new(0.5),
        Transform::from_xyz(2.4, 0.0, 0.0),
    ));
    let far = sim.spawn((
        RigidBody::Dynamic,
        CapsuleCollider::new(0.5, 1.0),
        Transform::from_xyz(0.0, 0.0, 2.6),
    ));
    sim.step(2);
    assert!(sim.touch(sensor, near));
    assert!(!sim.touch(sensor, far));
}

#[test]
fn a_fast_ball_with_continuous_collision_does_not_pass_a_thin_wall() {
    let mut sim = Sim::new();
    sim.spawn((CuboidCollider::new(0.02, 4.0, 4.0), Transform::default()));
    let bullet = |z: f32| {
        let velocity = LinearVelocity(Vec3::X * 200.0);
        (
            RigidBody::Dynamic,
            ContinuousCollision,
            velocity,
            Transform::from_xyz(-5.0, 0.3, z),
        )
    };
    let ball = sim.spawn((BallCollider::new(0.1), bullet(-1.0)));
    let capsule = sim.spawn((CapsuleCollider::new(0.05, 0.2), bullet(0.0)));
    let cuboid = sim.spawn((CuboidCollider::new(0.1, 0.1, 0.1).with_rounding(0.02), bullet(1.0)));
    sim.step(64);
    for entity in [ball, capsule, cuboid] {
        assert!(sim.position(entity).x < 0.0, "{entity}: {}", sim.position(entity));
    }
}
