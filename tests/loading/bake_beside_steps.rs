//! A bake does not hold up the fixed step.

use crate::asset_app::alone;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use std::time::{Duration, Instant};

const STEP: Duration = Duration::from_nanos(15_625_000);

/// The longest of `updates` updates, each of which runs one step, or of all until `done`.
fn longest(app: &mut App, updates: usize, mut done: impl FnMut(&mut App) -> bool) -> (Duration, usize) {
    let mut longest = Duration::ZERO;
    for n in 0..updates {
        if done(app) {
            return (longest, n);
        }
        let start = Instant::now();
        app.update();
        longest = longest.max(start.elapsed());
    }
    (longest, updates)
}

#[test]
fn steps_beside_a_long_bake_take_about_as_long_as_without() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let torus = shapes::torus_240();
    std::fs::write(folder.path().join("torus.obj"), bevy_faceoff::asset::to_obj(&torus)).unwrap();
    let recipe = "(mesh: \"torus.obj\", settings: (faces: true, degrees: 1, image: 256))";
    std::fs::write(folder.path().join("torus.bake.ron"), recipe).unwrap();

    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        FaceoffHeadlessPlugins {
            assets: AssetPlugin {
                file_path: folder.path().to_string_lossy().into_owned(),
                ..default()
            },
            ..default()
        },
    ))
    .insert_resource(Time::<Fixed>::from_duration(STEP))
    .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
    .insert_resource(Response::None);
    app.finish();
    app.cleanup();
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<CollisionMesh>>()
        .add(CollisionMesh::new(&torus));
    for i in 0..200 {
        let at = Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0) * 1.1;
        app.world_mut().spawn((
            RigidBody::Kinematic,
            MeshCollider(mesh.clone()),
            Transform::from_translation(at),
        ));
        app.world_mut().spawn((
            RigidBody::Dynamic,
            MeshCollider(mesh.clone()),
            Transform::from_translation(at + Vec3::Z * 0.2),
            GravityScale(0.0),
        ));
    }
    longest(&mut app, 10, |_| false);
    let (quiet, _) = longest(&mut app, 100, |_| false);

    let baked: Handle<CollisionMesh> = app.world().resource::<AssetServer>().load("torus.bake.ron");
    let (busy, steps) = longest(&mut app, 1_000_000, |app| {
        app.world().resource::<Assets<CollisionMesh>>().contains(&baked)
    });
    let report = app.world().resource::<StepReport>();
    assert!(report.touching_pairs >= 200, "{report:?}");
    println!("longest step: quiet {quiet:?}, beside a bake {busy:?} ({steps} steps)");
    assert!(steps > 10, "the bake was over after {steps} steps");
    assert!(
        busy < 10 * quiet + Duration::from_millis(200),
        "{busy:?} against {quiet:?}"
    );
}
