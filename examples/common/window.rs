//! The window of the examples: camera, lights, and a visible mesh for every body.

use super::{NotReady, Options};
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy_faceoff::plugin::debug::FaceoffGizmosPlugin;
use bevy_faceoff::prelude::*;

/// Colours of bodies, in the order in which their meshes load.
const COLORS: [Color; 4] = [
    Color::srgb(0.16, 0.47, 0.87),
    Color::srgb(0.90, 0.36, 0.20),
    Color::srgb(0.42, 0.68, 0.30),
    Color::srgb(0.62, 0.40, 0.78),
];

pub fn open(app: &mut App, title: &str) {
    app.add_plugins((
        DefaultPlugins.set(WindowPlugin {
            primary_window: Some(Window {
                title: format!("bevy_faceoff: {title}"),
                resolution: (960, 600).into(),
                ..default()
            }),
            ..default()
        }),
        FaceoffPlugins::default().set(InterpolationPlugin::interpolate_all()),
        FaceoffGizmosPlugin,
    ))
    .insert_resource(ClearColor(Color::srgb(0.07, 0.08, 0.10)))
    .add_systems(Startup, light_and_camera)
    .add_systems(Update, (dress, count_frames).chain());
}

fn light_and_camera(mut commands: Commands) {
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.0, 1.3, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
        AmbientLight {
            brightness: 400.0,
            ..default()
        },
    ));
    // One light with shadows, and two weaker ones, so that no side is black.
    for (illuminance, from, shadow_maps_enabled) in [
        (8_000.0, Vec3::new(3.0, 6.0, 5.0), true),
        (3_000.0, Vec3::new(-6.0, 1.0, 2.0), false),
        (3_000.0, Vec3::new(2.0, -5.0, 3.0), false),
    ] {
        commands.spawn((
            DirectionalLight {
                illuminance,
                shadow_maps_enabled,
                ..default()
            },
            Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y),
        ));
    }
}

/// Draws the triangles that collide, as soon as they are loaded.
fn dress(
    mut commands: Commands,
    bare: Query<(Entity, &MeshCollider), Without<Mesh3d>>,
    dressed: Query<(), With<Mesh3d>>,
    baked: Res<Assets<CollisionMesh>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let mut next = dressed.iter().len();
    for (entity, collider) in &bare {
        let Some(mesh) = baked.get(&collider.0) else { continue };
        commands.entity(entity).insert((
            Mesh3d(meshes.add(mesh.to_bevy_mesh())),
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color: COLORS[next % COLORS.len()],
                perceptual_roughness: 0.6,
                ..default()
            })),
        ));
        next += 1;
    }
}

/// Ends the app after `--frames` frames, counted from when all bodies are visible.
fn count_frames(
    mut commands: Commands,
    mut count: Local<u32>,
    options: Res<Options>,
    waiting: Query<(), Or<(With<NotReady>, (With<MeshCollider>, Without<Mesh3d>))>>,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(frames) = options.frames else { return };
    if !waiting.is_empty() {
        return;
    }
    *count += 1;
    if *count != frames {
        return;
    }
    match options.screenshot.clone() {
        None => {
            exit.write(AppExit::Success);
        }
        Some(file) => {
            commands
                .spawn(Screenshot::primary_window())
                .observe(save_to_disk(file))
                .observe(|_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
                    exit.write(AppExit::Success);
                });
        }
    }
}
