//! A glTF scene as one body: dropped, and broken into bodies when it hits the floor.
//!
//! * `cargo run --release --example prefab --features window` shows it in a window;
//! * `cargo run --release --example prefab --features bevy_gltf -- --headless` needs neither window nor GPU, and prints
//!   what happens.
//!
//! `assets/pentominoes.gltf` has thirteen meshes, twelve of which are concave. The command `cargo run --example
//! make_assets` writes it. The module `common` opens the window. In your own game use `DefaultPlugins` for that.

mod common;

use bevy::prelude::*;
use bevy_faceoff::prelude::*;

/// Steps from the first touch until it breaks.
const DELAY: u32 = 4;

fn main() -> AppExit {
    let mut app = common::app("prefab", 64 * 5);
    if app.world().resource::<common::Options>().headless {
        add_scenes(&mut app);
    }
    app.add_systems(Startup, spawn)
        // These run after every step.
        .add_systems(FixedLast, (break_apart, report).chain())
        .run()
}

/// What Bevy's `DefaultPlugins` add for scenes in glTF files.
fn add_scenes(app: &mut App) {
    use bevy::mesh::skinning::SkinnedMeshInverseBindposes;
    app.add_plugins((
        bevy::image::ImagePlugin::default(),
        bevy::mesh::MeshPlugin,
        bevy::world_serialization::WorldSerializationPlugin,
    ))
    .init_asset::<SkinnedMeshInverseBindposes>()
    .add_plugins(bevy::gltf::GltfPlugin::default());
}

/// The whole scene.
#[derive(Component)]
struct Prefab;

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    // The scene is one body. Without a `RigidBody` it would be static.
    let mut prefab = commands.spawn((
        Name::new("prefab"),
        Prefab,
        WorldAssetRoot(assets.load("pentominoes.gltf#Scene0")),
        MeshColliderHierarchy::default(),
        RigidBody::Dynamic,
        Transform::from_xyz(0.0, 0.9, 0.0)
            .with_rotation(Quat::from_rotation_z(0.35) * Quat::from_rotation_y(0.4))
            .with_scale(Vec3::splat(0.2)),
        common::NotReady,
    ));
    prefab.observe(|ready: On<MeshColliderHierarchyReady>, mut commands: Commands| {
        println!("{} colliders, {} errors", ready.colliders.len(), ready.errors.len());
        commands.entity(ready.entity).remove::<common::NotReady>();
    });
    commands.spawn((
        Name::new("floor"),
        MeshCollider(assets.load("cube.bake.ron")),
        Transform::from_xyz(0.0, -1.25, 0.0).with_scale(Vec3::new(8.0, 0.5, 8.0)),
        Friction::new(0.8),
    ));
}

/// Makes every node of the scene a body of its own, some steps after the scene has hit something.
fn break_apart(
    mut commands: Commands,
    mut started: MessageReader<CollisionStart>,
    mut left: Local<Option<u32>>,
    prefab: Query<
        (
            Entity,
            &LinearVelocity,
            &AngularVelocity,
            &Transform,
            &ComputedCenterOfMass,
        ),
        (With<Prefab>, With<RigidBody>),
    >,
    colliders: Query<&ChildOf, With<MeshCollider>>,
    transforms: Query<&Transform>,
    parents: Query<&ChildOf>,
) {
    let Ok((root, &LinearVelocity(v), &AngularVelocity(w), whole, center)) = prefab.single() else {
        return;
    };
    if left.is_none() && started.read().any(|hit| [hit.body1, hit.body2].contains(&root)) {
        *left = Some(DELAY);
    }
    let Some(steps) = &mut *left else { return };
    *steps -= 1;
    if *steps > 0 {
        return;
    }
    let center = center.in_world(whole);
    for collider in &colliders {
        let node = collider.parent();
        if !parents.iter_ancestors(node).any(|above| above == root) {
            continue;
        }
        let Ok(place) = transforms.get(node) else { continue };
        // Each goes on with the velocity that the whole has there.
        let at = whole.transform_point(place.translation);
        commands.entity(node).insert((
            RigidBody::Dynamic,
            LinearVelocity(v + w.cross(at - center)),
            AngularVelocity(w),
        ));
    }
    commands.entity(root).remove::<RigidBody>();
}

/// Prints what takes part, once a second.
fn report(report: Res<StepReport>) {
    if report.step % 64 == 1 {
        println!(
            "step {:3}: {} bodies, {} asleep, {} pairs touch",
            report.step, report.bodies, report.sleeping, report.touching_pairs
        );
    }
}
