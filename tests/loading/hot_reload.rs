//! A mesh that changes while the simulation runs.

use crate::asset_app::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::asset::to_obj;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use std::time::Duration;

#[test]
fn a_reloaded_recipe_swaps_the_mesh_of_running_bodies() {
    let _beside = beside_others();
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "cube.obj", to_obj(&shapes::cube(1.0)));
    write(folder, "cube.bake.ron", "(mesh: \"cube.obj\")");
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins.build().disable::<bevy::app::ScheduleRunnerPlugin>(),
        FaceoffHeadlessPlugins {
            assets: AssetPlugin {
                watch_for_changes_override: Some(false),
                ..plain(folder)
            },
            ..default()
        },
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 64.0)))
    .insert_resource(Gravity(Vec3::ZERO))
    .insert_resource(Response::None);
    finish(&mut app);
    let cube: Handle<CollisionMesh> = server(&app).load("cube.bake.ron");
    for x in [0.0, 0.8] {
        app.world_mut().spawn((
            RigidBody::Dynamic,
            MeshCollider(cube.clone()),
            Transform::from_xyz(x, 0.1 * x, 0.2 * x),
        ));
    }
    let touching = |app: &App| app.world().resource::<Collisions>().iter().count();
    update_until(&mut app, |app| touching(app) == 1);

    // They touch for as long as the file is not loaded again.
    write(folder, "cube.obj", to_obj(&shapes::cube(0.5)));
    for _ in 0..20 {
        app.update();
        assert_eq!(touching(&app), 1);
    }
    server(&app).reload("cube.bake.ron");
    update_until(&mut app, |app| touching(app) == 0);

    // A broken file changes nothing: the mesh that was there goes on.
    write(folder, "cube.obj", "v 1 2\n");
    server(&app).reload("cube.bake.ron");
    for _ in 0..50 {
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(app.world().resource::<Assets<CollisionMesh>>().get(&cube).is_some());
    write(folder, "cube.obj", to_obj(&shapes::cube(1.5)));
    server(&app).reload("cube.bake.ron");
    update_until(&mut app, |app| touching(app) == 1);
}
