//! A hundred tori fly about in a box without gravity, as in the paper: `cargo run --release --example tori`.

use avian_faceoff::prelude::*;
use avian3d::math::AdjustPrecision;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use std::time::{Duration, Instant};

/// Edge of the box, metres.
const EDGE: f32 = 6.0;

fn main() {
    let step = Duration::from_secs(1) / 64;
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        PhysicsPlugins::default().with_exact_meshes(),
    ))
    .insert_resource(Gravity(Vec3::ZERO.adjust_precision()))
    .insert_resource(Time::<Fixed>::from_duration(step))
    .insert_resource(TimeUpdateStrategy::ManualDuration(step))
    .add_systems(Startup, (spawn_box, spawn_tori));
    app.finish();
    app.cleanup();
    let start = Instant::now();
    let steps = 256;
    for _ in 0..steps {
        app.update();
    }
    let milliseconds = 1e3 * start.elapsed().as_secs_f64() / f64::from(steps);
    let touching = app.world().resource::<ContactGraph>().iter_active_touching().count();
    let mut tori = app.world_mut().query_filtered::<&Position, With<ExactCollider>>();
    let inside = tori
        .iter(app.world())
        .filter(|at| at.0.abs().max_element() < 0.5 * EDGE.adjust_precision())
        .count();
    println!("{inside} tori are in the box, {touching} pairs touch, {milliseconds:.1} ms a step");
    assert_eq!(inside, 100, "all stay in the box");
}

/// Walls are boxes of Avian: mixed pairs work as ever.
fn spawn_box(mut commands: Commands) {
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for out in [axis, -axis] {
            let size = (Vec3::splat(EDGE + 2.0) - axis * EDGE).adjust_precision();
            let wall = Collider::cuboid(size.x, size.y, size.z);
            commands.spawn((
                RigidBody::Static,
                wall,
                Transform::from_translation(out * (0.5 * EDGE + 1.0)),
            ));
        }
    }
}

fn spawn_tori(mut commands: Commands, mut meshes: ResMut<Assets<CollisionMesh>>) {
    let torus = meshes.add(CollisionMesh::new(&shapes::torus_240()));
    let mut random = fastrand::Rng::with_seed(1);
    for i in 0..100 {
        let cell = Vec3::new((i % 5) as f32, (i / 5 % 5) as f32, (i / 25) as f32);
        let mut vector = || Vec3::new(random.f32(), random.f32(), random.f32()) - 0.5;
        commands.spawn((
            RigidBody::Dynamic,
            ExactCollider(torus.clone()),
            Transform::from_translation(1.1 * (cell - Vec3::new(2.0, 2.0, 1.5))),
            LinearVelocity((4.0 * vector()).adjust_precision()),
            AngularVelocity((4.0 * vector()).adjust_precision()),
            Friction::new(0.0),
        ));
    }
}
