//! A simulation without a window or GPU, as in a test or on a server: one fixed step per update, as fast as possible,
//! and assertions about the outcome. If an assertion fails, it panics and exits with an error.
//!
//! `cargo run --release --example headless`

use bevy::app::ScheduleRunnerPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::{TriMesh, shapes};
use bevy_faceoff::prelude::*;
use std::time::Duration;

const STEP: Duration = Duration::from_nanos(15_625_000);

fn main() {
    two_tori_bounce_off_each_other();
    a_ball_flies_through_the_hole_of_a_torus();
    println!("all as expected");
}

/// An app in which every update is one fixed step of 1/64 s.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        // Without the runner, because we call `update` ourselves.
        MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
        FaceoffHeadlessPlugins::default(),
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
    .insert_resource(Time::<Fixed>::from_duration(STEP))
    .insert_resource(Gravity(Vec3::ZERO))
    .init_resource::<Events>()
    .add_systems(Update, listen);
    app.finish();
    app.cleanup();
    app
}

/// All collision messages since the start.
#[derive(Resource, Default)]
struct Events {
    starts: Vec<CollisionStart>,
    ends: Vec<CollisionEnd>,
}

fn listen(
    mut events: ResMut<Events>,
    mut starts: MessageReader<CollisionStart>,
    mut ends: MessageReader<CollisionEnd>,
) {
    events.starts.extend(starts.read());
    events.ends.extend(ends.read());
}

fn collider(app: &mut App, mesh: &TriMesh) -> MeshCollider {
    let mut meshes = app.world_mut().resource_mut::<Assets<CollisionMesh>>();
    MeshCollider(meshes.add(CollisionMesh::new(mesh)))
}

fn body(collider: &MeshCollider, position: Vec3, velocity: Vec3) -> impl Bundle + use<> {
    (
        RigidBody::Dynamic,
        collider.clone(),
        Transform::from_translation(position),
        LinearVelocity(velocity),
        Mass(2.0),
        Restitution::new(1.0),
    )
}

fn two_tori_bounce_off_each_other() {
    let mut app = app();
    let torus = collider(&mut app, &shapes::torus_240());
    let bodies = [-1.0, 1.0].map(|side| {
        let start = Vec3::new(1.5 * side, 0.1 * side, 0.0);
        app.world_mut().spawn(body(&torus, start, Vec3::X * -side)).id()
    });
    for _ in 0..192 {
        app.update();
    }
    let events = app.world().resource::<Events>();
    println!(
        "tori: {} collisions started and {} ended",
        events.starts.len(),
        events.ends.len()
    );
    assert!(!events.starts.is_empty(), "they never met");
    assert_eq!(events.starts.len(), events.ends.len(), "they still touch");
    for start in &events.starts {
        assert!(bodies.contains(&start.collider1) && bodies.contains(&start.collider2));
    }
    let velocities = bodies.map(|body| app.world().get::<LinearVelocity>(body).expect("a body").0);
    assert!(
        velocities[0].x < 0.0 && velocities[1].x > 0.0,
        "they separate: {velocities:?}"
    );
    // Momentum is conserved, and the masses are equal.
    assert!((velocities[0] + velocities[1]).length() < 1e-4, "{velocities:?}");
}

fn a_ball_flies_through_the_hole_of_a_torus() {
    for (scale, fits) in [(0.3, true), (1.0, false)] {
        let mut app = app();
        let torus = shapes::torus_240();
        let hole = TriMesh::aabb(&torus);
        // The axis of a torus is the shortest side of its box.
        let axis = Vec3::AXES[(hole.max - hole.min).min_position()];
        let torus = collider(&mut app, &torus);
        let ball = collider(&mut app, &shapes::ball_320());
        app.world_mut().spawn((RigidBody::Static, torus));
        let ball = app
            .world_mut()
            .spawn((body(&ball, -2.5 * axis, 2.0 * axis), Sensor))
            .insert(Transform::from_translation(-2.5 * axis).with_scale(Vec3::splat(scale)))
            .id();
        for _ in 0..160 {
            app.update();
        }
        let place = app.world().get::<Transform>(ball).expect("the ball").translation;
        let touched = !app.world().resource::<Events>().starts.is_empty();
        println!("ball of scale {scale}: touched {touched}, is at {place}");
        // A sensor is not pushed, so it flies on. Bounding spheres overlap, but a small ball fits through the hole.
        assert!(place.dot(axis) > 2.0);
        assert_eq!(touched, !fits);
    }
}
