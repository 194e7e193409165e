//! A knot swings on a joint of Avian into another knot: `cargo run --release --example joint`.

use avian_faceoff::prelude::*;
use avian3d::math::AdjustPrecision;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use std::time::Duration;

#[derive(Component)]
struct Swings;

fn main() {
    let step = Duration::from_secs(1) / 64;
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        PhysicsPlugins::default().with_exact_meshes(),
    ))
    .insert_resource(Time::<Fixed>::from_duration(step))
    .insert_resource(TimeUpdateStrategy::ManualDuration(step))
    .add_systems(Startup, spawn)
    .add_observer(|started: On<CollisionStart>| println!("{} touches {}", started.collider1, started.collider2));
    app.finish();
    app.cleanup();
    for step in 0..320 {
        app.update();
        if step % 32 == 0 {
            let mut knots = app
                .world_mut()
                .query_filtered::<(&Transform, &LinearVelocity), With<Swings>>();
            for (at, velocity) in knots.iter(app.world()) {
                println!(
                    "{:.1} s: it is at {:.2}, with {:.2} m/s",
                    step as f32 / 64.0,
                    at.translation,
                    velocity.length()
                );
            }
        }
    }
    let graph = app.world().resource::<ContactGraph>();
    println!("{} pair of knots touches", graph.iter_active_touching().count());
}

fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<CollisionMesh>>) {
    let knot = ExactCollider(meshes.add(CollisionMesh::new(&shapes::knot_1120())));
    let anchor = commands.spawn((RigidBody::Static, Transform::default())).id();
    let arm = Vec3::X * 2.0;
    let pose = Transform::from_translation(arm);
    let swings = commands
        .spawn((Swings, RigidBody::Dynamic, knot.clone(), CollisionEventsEnabled, pose))
        .id();
    commands.spawn(SphericalJoint::new(anchor, swings).with_local_anchor2((-arm).adjust_precision()));
    commands.spawn((RigidBody::Static, knot, Transform::from_xyz(0.3, -2.0, 0.0)));
}
