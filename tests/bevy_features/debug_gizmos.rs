//! Gizmos of collisions, as Bevy gets them to draw.

use bevy::app::ScheduleRunnerPlugin;
use bevy::gizmos::{GizmoAsset, GizmoHandles, GizmoPlugin};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::debug::{FaceoffGizmos, FaceoffGizmosPlugin, ShowFacesTowards};
use bevy_faceoff::prelude::*;
use bevy_faceoff::projection::{Progress, bake_pool};
use std::any::TypeId;
use std::time::Duration;

fn app(gizmos: bool) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
        TransformPlugin,
        FaceoffHeadlessPlugins::default(),
    ))
    .insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(Duration::from_nanos(
        15_625_000,
    )))
    .insert_resource(Gravity(Vec3::ZERO));
    // Bevy's own gizmos look for these, where there are meshes.
    #[cfg(feature = "bevy_mesh")]
    app.add_plugins(bevy::mesh::MeshPlugin)
        .init_asset::<bevy::mesh::skinning::SkinnedMeshInverseBindposes>();
    if gizmos {
        app.add_plugins(GizmoPlugin);
    }
    app.add_plugins(FaceoffGizmosPlugin);
    app.finish();
    app.cleanup();
    app
}

fn show(app: &mut App, change: impl FnOnce(&mut FaceoffGizmos)) {
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    let gizmos = store.config_mut::<FaceoffGizmos>().1;
    *gizmos = FaceoffGizmos {
        bounding_spheres: None,
        contacts: None,
        intersections: None,
        faces: None,
        ..default()
    };
    change(gizmos);
}

/// Whether the last frame left anything to draw.
fn draws(app: &mut App) -> bool {
    app.update();
    app.update();
    let handle = &app.world().resource::<GizmoHandles>().handles()[&TypeId::of::<FaceoffGizmos>()];
    handle
        .as_ref()
        .is_some_and(|handle| app.world().resource::<Assets<GizmoAsset>>().contains(handle))
}

#[test]
fn each_kind_is_drawn_on_its_own() {
    let mut app = app(true);
    let settings = BakeSettings {
        faces: true,
        degrees: 30,
        image: 64,
        ..BakeSettings::default()
    };
    let mesh = CollisionMesh::bake(&shapes::torus_240(), settings, bake_pool(), &Progress::default()).unwrap();
    let mesh = app.world_mut().resource_mut::<Assets<CollisionMesh>>().add(mesh);
    let mut spawn = |x| {
        app.world_mut()
            .spawn((
                RigidBody::Dynamic,
                Sensor,
                MeshCollider(mesh.clone()),
                Transform::from_xyz(x, 0.0, 0.0),
            ))
            .id()
    };
    let [one, other] = [spawn(0.0), spawn(0.3)];
    app.world_mut().entity_mut(one).remove::<Sensor>();
    show(&mut app, |_| {});
    assert!(!draws(&mut app));
    show(&mut app, |g| g.bounding_spheres = Some(Color::WHITE));
    assert!(draws(&mut app));
    show(&mut app, |g| g.contacts = Some(Color::WHITE));
    assert!(draws(&mut app));
    show(&mut app, |g| g.intersections = Some(Color::WHITE));
    assert!(draws(&mut app));
    show(&mut app, |g| g.faces = Some(Color::WHITE));
    assert!(!draws(&mut app), "nobody asked for any faces");
    app.world_mut().entity_mut(one).insert(ShowFacesTowards(other));
    assert!(draws(&mut app));
    // A partner that is gone, or has no shape, is none.
    app.world_mut().despawn(other);
    assert!(!draws(&mut app));
}

#[test]
fn without_bevys_gizmos_nothing_happens() {
    let mut app = app(false);
    app.update();
    app.update();
}
