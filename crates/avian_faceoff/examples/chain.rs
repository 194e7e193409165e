//! A chain of 50 rings hangs from a static one: `cargo run --release --example chain`.
//!
//! There is no joint in it: each ring hangs on the surface of the one before.

use avian_faceoff::prelude::*;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use std::time::Duration;

/// From ring to ring at first, metres.
const LINK: f32 = 0.74;

#[derive(Component)]
struct Ring(usize);

fn main() {
    let step = Duration::from_secs(1) / 64;
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        PhysicsPlugins::default().with_exact_meshes(),
        // A long chain needs fresh contacts more often, and then fewer substeps for each.
        PhysicsStepsPlugin::new(2),
    ))
    .insert_resource(SubstepCount(3))
    .insert_resource(Time::<Fixed>::from_duration(step))
    .insert_resource(TimeUpdateStrategy::ManualDuration(step))
    .add_systems(Startup, spawn_chain);
    app.finish();
    app.cleanup();
    for second in 1..=10 {
        for _ in 0..64 {
            app.update();
        }
        let mut rings: Vec<(usize, Vec3)> = app
            .world_mut()
            .query::<(&Ring, &Transform)>()
            .iter(app.world())
            .map(|(ring, at)| (ring.0, at.translation))
            .collect();
        rings.sort_by_key(|(i, _)| *i);
        let longest = rings
            .windows(2)
            .map(|pair| pair[0].1.distance(pair[1].1))
            .fold(0.0, f32::max);
        println!("{second} s: neighbours are at most {longest:.3} m apart");
        assert!(longest < 0.9, "a link has opened");
    }
}

fn spawn_chain(mut commands: Commands, mut meshes: ResMut<Assets<CollisionMesh>>) {
    let ring = meshes.add(CollisionMesh::new(&shapes::ring()));
    for i in 0..50 {
        let turn = if i % 2 == 0 { 0.0 } else { std::f32::consts::FRAC_PI_2 };
        let pose = Transform::from_xyz(0.0, -LINK * i as f32, 0.0).with_rotation(Quat::from_rotation_y(turn));
        let body = if i == 0 { RigidBody::Static } else { RigidBody::Dynamic };
        commands.spawn((Ring(i), body, ExactCollider(ring.clone()), pose));
    }
}
