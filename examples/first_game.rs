//! A game in a window: tori fall onto the ground. Nothing but Bevy and this plugin, to begin with.

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

fn main() {
    let step = StepPlugin {
        backend: Backend::Cpu,
        ..default()
    };
    App::new()
        .add_plugins(DefaultPlugins)
        // Draws all bodies between two steps, so that motion is smooth at any frame rate.
        .add_plugins(FaceoffPlugins { step }.set(InterpolationPlugin::interpolate_all()))
        .add_systems(Startup, spawn)
        .add_systems(FixedLast, report)
        .run();
}

fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.0, 5.0, 12.0).looking_at(Vec3::Y, Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(4.0, 8.0, 6.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    // The ground. Bodies collide with the plane, which has no end; the mesh is only drawn.
    commands.spawn((
        PlaneCollider::default(),
        Mesh3d(meshes.add(Plane3d::default().mesh().size(20.0, 20.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.4, 0.5, 0.4))),
    ));
    let torus = meshes.add(Torus::default());
    let red = materials.add(Color::srgb(0.8, 0.3, 0.2));
    for i in 0..10 {
        let i = i as f32;
        commands.spawn((
            RigidBody::Dynamic,
            // The mesh that is drawn is also the one that collides. It is baked once for all ten.
            Mesh3d(torus.clone()),
            MeshColliderFrom(torus.clone()),
            MeshMaterial3d(red.clone()),
            Transform::from_xyz(0.2 * i, 2.0 + i, 0.0).with_rotation(Quat::from_rotation_x(i)),
        ));
    }
}

fn report(mut started: MessageReader<CollisionStart>) {
    for CollisionStart { body1, body2, .. } in started.read() {
        info!("{body1} touches {body2}");
    }
}
