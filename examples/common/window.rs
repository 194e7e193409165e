//! The window of the examples: camera, lights, a visible mesh for every body and a ground for every plane below.

use super::{DrawnByExample, Help, NotReady, Options, View, gif};
use bevy::asset::RenderAssetUsages;
use bevy::camera::Hdr;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll, MouseScrollUnit};
use bevy::light::{CascadeShadowConfigBuilder, DirectionalLightShadowMap, NotShadowCaster, NotShadowReceiver};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy_faceoff::plugin::debug::{FaceoffGizmos, FaceoffGizmosPlugin};
use bevy_faceoff::plugin::panel::{FaceoffPanel, FaceoffPanelPlugin};
use bevy_faceoff::prelude::*;

/// Colours of moving bodies, in the order in which their meshes load.
const COLORS: [Color; 6] = [
    Color::srgb(0.10, 0.36, 0.78),
    Color::srgb(0.86, 0.28, 0.12),
    Color::srgb(0.96, 0.66, 0.12),
    Color::srgb(0.16, 0.58, 0.36),
    Color::srgb(0.50, 0.28, 0.70),
    Color::srgb(0.10, 0.62, 0.68),
];
/// Colour of what does not move.
const STATIC: Color = Color::srgb(0.55, 0.56, 0.58);
/// Colours of the two kinds of squares of a ground.
const GROUND: [Color; 2] = [Color::srgb(0.42, 0.45, 0.50), Color::srgb(0.48, 0.51, 0.56)];
/// Colour behind all, into which a ground fades.
const SKY: Color = Color::srgb(0.50, 0.60, 0.72);
/// A ground is a square of so many squares of 1 m.
const GROUND_SQUARES: u32 = 80;

pub fn open(app: &mut App, title: &str, step: StepPlugin) {
    let options = app.world().resource::<Options>();
    let is_recorded = options.gif.is_some();
    let render = RenderPlugin {
        // So that the first picture is complete.
        synchronous_pipeline_compilation: is_recorded || options.screenshot.is_some(),
        ..default()
    };
    let interpolation = InterpolationPlugin {
        // Components of bodies that stay on the GPU do not follow them.
        interpolate_all: step.readback != Readback::Resident,
    };
    app.add_plugins((
        DefaultPlugins.set(render).set(WindowPlugin {
            primary_window: Some(Window {
                title: format!("bevy_faceoff: {title}"),
                resolution: if is_recorded { gif::SIZE } else { (960, 600) }.into(),
                ..default()
            }),
            ..default()
        }),
        FaceoffPlugins { step }.set(interpolation),
        FaceoffGizmosPlugin,
        FaceoffPanelPlugin {
            panel: FaceoffPanel::hidden(),
        },
        gif::GifPlugin,
    ))
    .insert_resource(ClearColor(SKY))
    // The smaller the window, the less is seen of its shadows.
    .insert_resource(DirectionalLightShadowMap {
        size: if is_recorded { 1024 } else { 2048 },
    })
    .init_resource::<View>()
    .init_resource::<Help>()
    .add_systems(Startup, (light_and_camera, write_help, hide_gizmos))
    .add_systems(
        Update,
        (turn_camera, switch_gizmos, (dress, draw_grounds, count_frames).chain()),
    );
}

fn light_and_camera(mut commands: Commands, view: Res<View>) {
    let distance = view.from.distance(view.at);
    commands.spawn((
        Camera3d::default(),
        // With it the background and the fog get the same tone.
        Hdr,
        Tonemapping::AcesFitted,
        Msaa::Sample4,
        Transform::from_translation(view.from).looking_at(view.at, Vec3::Y),
        AmbientLight {
            color: Color::srgb(0.85, 0.92, 1.0),
            brightness: 500.0,
            ..default()
        },
        DistanceFog {
            color: SKY,
            falloff: FogFalloff::Linear {
                start: 2.0 * distance,
                end: (6.0 * distance).min(0.5 * GROUND_SQUARES as f32).max(3.0 * distance),
            },
            ..default()
        },
    ));
    // One light with shadows, and two weaker ones, so that no side is black.
    for (illuminance, from, shadow_maps_enabled) in [
        (9_000.0, Vec3::new(3.0, 6.0, 4.0), true),
        (1_800.0, Vec3::new(-6.0, 2.0, 2.0), false),
        (1_000.0, Vec3::new(2.0, -5.0, 3.0), false),
    ] {
        commands.spawn((
            DirectionalLight {
                illuminance,
                shadow_maps_enabled,
                ..default()
            },
            CascadeShadowConfigBuilder {
                num_cascades: 2,
                first_cascade_far_bound: distance,
                maximum_distance: 3.0 * distance,
                ..default()
            }
            .build(),
            Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y),
        ));
    }
}

fn write_help(mut commands: Commands, help: Res<Help>, options: Res<Options>) {
    if options.gif.is_some() {
        return;
    }
    let separator = if help.0.is_empty() { "" } else { "\n" };
    commands.spawn((
        Text::new(format!(
            "{}{separator}mouse or arrows: look around, F3: figures, G: gizmos",
            help.0
        )),
        TextFont::from_font_size(15.0),
        TextColor(Color::srgb(0.08, 0.10, 0.14)),
        Node {
            position_type: PositionType::Absolute,
            left: px(12),
            bottom: px(10),
            ..default()
        },
    ));
}

/// Turns the camera about the point that it looks at: with the left mouse button or the arrow keys. The wheel moves it
/// nearer or away. Otherwise it leaves the camera alone, so that an example may move it.
fn turn_camera(
    mut view: ResMut<View>,
    mut camera: Single<&mut Transform, With<Camera3d>>,
    keys: Res<ButtonInput<KeyCode>>,
    buttons: Res<ButtonInput<MouseButton>>,
    motion: Res<AccumulatedMouseMotion>,
    scroll: Res<AccumulatedMouseScroll>,
    time: Res<Time>,
) {
    let key = |plus, minus| f32::from(keys.pressed(plus)) - f32::from(keys.pressed(minus));
    let arrows = Vec2::new(
        key(KeyCode::ArrowLeft, KeyCode::ArrowRight),
        key(KeyCode::ArrowUp, KeyCode::ArrowDown),
    );
    let mut turn = 1.5 * time.delta_secs() * arrows;
    if buttons.pressed(MouseButton::Left) {
        turn -= 0.005 * motion.delta;
    }
    let notches = match scroll.unit {
        MouseScrollUnit::Line => scroll.delta.y,
        MouseScrollUnit::Pixel => scroll.delta.y / 100.0,
    };
    if turn == Vec2::ZERO && notches == 0.0 {
        return;
    }
    let arm = view.from - view.at;
    let distance = arm.length().max(0.1);
    // Not quite straight up or down, where the direction of the turn is lost.
    let height = ((arm.y / distance).clamp(-1.0, 1.0).asin() - turn.y).clamp(-1.5, 1.5);
    let around = arm.x.atan2(arm.z) + turn.x;
    let out = Vec3::new(around.sin() * height.cos(), height.sin(), around.cos() * height.cos());
    view.from = view.at + distance * 0.9_f32.powf(notches.clamp(-10.0, 10.0)) * out;
    **camera = Transform::from_translation(view.from).looking_at(view.at, Vec3::Y);
}

fn hide_gizmos(mut store: ResMut<GizmoConfigStore>) {
    *store.config_mut().1 = few_gizmos();
}

/// Gizmos at the start: only what an example asks for with `ShowFacesTowards`.
fn few_gizmos() -> FaceoffGizmos {
    FaceoffGizmos {
        faces: FaceoffGizmos::all().faces,
        ..FaceoffGizmos::none()
    }
}

/// Shows and hides wireframes, boxes, velocities, planes and contacts.
fn switch_gizmos(keys: Res<ButtonInput<KeyCode>>, mut store: ResMut<GizmoConfigStore>) {
    if keys.just_pressed(KeyCode::KeyG) {
        let gizmos = store.config_mut::<FaceoffGizmos>().1;
        let all = FaceoffGizmos::all();
        *gizmos = if gizmos.contacts.is_some() {
            few_gizmos()
        } else {
            FaceoffGizmos {
                wireframes: all.wireframes,
                boxes: all.boxes,
                planes: all.planes,
                linear_velocities: all.linear_velocities,
                angular_velocities: all.angular_velocities,
                contacts: all.contacts,
                intersections: all.intersections,
                ..few_gizmos()
            }
        };
    }
}

/// Visible meshes and materials that entities share.
#[derive(Default)]
struct Wardrobe {
    meshes: HashMap<AssetId<CollisionMesh>, Handle<Mesh>>,
    moving: Vec<Handle<StandardMaterial>>,
    fixed: Option<Handle<StandardMaterial>>,
    sensor: Option<Handle<StandardMaterial>>,
    next: usize,
}

fn paint(base_color: Color) -> StandardMaterial {
    StandardMaterial {
        base_color,
        perceptual_roughness: 0.55,
        ..default()
    }
}

/// What sensors look like: one sees through them.
fn glass() -> StandardMaterial {
    StandardMaterial {
        alpha_mode: AlphaMode::Blend,
        unlit: true,
        ..paint(Color::srgba(0.3, 0.8, 1.0, 0.2))
    }
}

/// Draws the triangles that collide, as soon as they are loaded.
fn dress(
    mut commands: Commands,
    mut wardrobe: Local<Wardrobe>,
    bare: Query<(Entity, &MeshCollider, Has<Sensor>), (Without<Mesh3d>, Without<DrawnByExample>)>,
    bodies: Query<&RigidBody>,
    parents: Query<&ChildOf>,
    baked: Res<Assets<CollisionMesh>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Wardrobe {
        meshes: known,
        moving,
        fixed,
        sensor,
        next,
    } = &mut *wardrobe;
    if moving.is_empty() {
        moving.extend(COLORS.map(|color| materials.add(paint(color))));
    }
    for (entity, collider, is_sensor) in &bare {
        let Some(mesh) = baked.get(&collider.0) else { continue };
        let mesh = known
            .entry(collider.0.id())
            .or_insert_with(|| meshes.add(mesh.to_bevy_mesh()));
        let body = std::iter::once(entity)
            .chain(parents.iter_ancestors(entity))
            .find_map(|e| bodies.get(e).ok());
        let material = match body {
            _ if is_sensor => sensor.get_or_insert_with(|| materials.add(glass())),
            None | Some(RigidBody::Static) => fixed.get_or_insert_with(|| materials.add(paint(STATIC))),
            Some(_) => {
                *next += 1;
                &moving[(*next - 1) % COLORS.len()]
            }
        };
        let mut entity = commands.entity(entity);
        entity.insert((Mesh3d(mesh.clone()), MeshMaterial3d(material.clone())));
        if is_sensor {
            entity.insert((NotShadowCaster, NotShadowReceiver));
        }
    }
}

/// A plane whose ground is drawn, or which is not drawn because it is a wall or a ceiling.
#[derive(Component)]
struct Drawn;

/// Draws a ground for every plane that faces upward. It is a child, so that it follows the plane.
fn draw_grounds(
    mut commands: Commands,
    planes: Query<(Entity, &PlaneCollider, Option<&GlobalTransform>), Without<Drawn>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (entity, plane, pose) in &planes {
        commands.entity(entity).insert(Drawn);
        let normal = plane.normal.normalize_or_zero();
        let turn = pose.map_or(Quat::IDENTITY, GlobalTransform::rotation);
        if (turn * normal).y < 0.7 {
            continue;
        }
        // A plane need not have a place of its own, but what is drawn below it does.
        let place = (Transform::default(), Visibility::default());
        commands.entity(entity).insert_if_new(place).with_child((
            Mesh3d(meshes.add(checkered(GROUND_SQUARES))),
            MeshMaterial3d(materials.add(StandardMaterial {
                perceptual_roughness: 0.95,
                reflectance: 0.1,
                ..default()
            })),
            Transform::from_translation(plane.distance * normal)
                .with_rotation(Quat::from_rotation_arc(Vec3::Y, normal)),
        ));
    }
}

/// A square in the plane y = 0, of `count` by `count` squares of 1 m in two colours.
fn checkered(count: u32) -> Mesh {
    let half = 0.5 * count as f32;
    let (mut positions, mut colors, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
        let first = positions.len() as u32;
        let low = Vec2::new(i as f32, j as f32) - half;
        for (x, z) in [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)] {
            positions.push([low.x + x, 0.0, low.y + z]);
            colors.push(GROUND[(i + j) as usize % 2].to_linear().to_f32_array());
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }
    let normals = vec![[0.0, 1.0, 0.0]; positions.len()];
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
        .with_inserted_indices(Indices::U32(indices))
}

/// What is not visible yet.
pub type Waiting<'w, 's> = Query<
    'w,
    's,
    (),
    Or<(
        With<NotReady>,
        (With<MeshCollider>, Without<Mesh3d>, Without<DrawnByExample>),
    )>,
>;

/// Ends the app after `--frames` frames, counted from when all bodies are visible.
fn count_frames(
    mut commands: Commands,
    mut count: Local<u32>,
    options: Res<Options>,
    waiting: Waiting,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(frames) = options.frames else { return };
    if options.gif.is_some() || !waiting.is_empty() {
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
