//! Time on the main thread while a scene of fifty meshes is spawned: with and without colliders, for the first time and
//! again.
//!
//! `cargo bench --bench prefab --features bevy_gltf`

#[path = "../tests/common/gltf_files.rs"]
mod gltf_files;

use bevy::app::ScheduleRunnerPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use gltf_files::{Gltf, U16};
use serde_json::json;
use std::path::Path;
use std::time::{Duration, Instant};

const MESHES: u32 = 50;
/// Spawns of the same scene, of which the fastest counts.
const TIMES: usize = 20;

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for minor in [10, 60] {
        let triangles = 2 * 40 * minor;
        let name = format!("scene_{minor}.glb");
        std::fs::write(folder.path().join(&name), scene(minor)).expect("a file");
        println!("{MESHES} meshes of {triangles} triangles; longest frame in ms");
        let [bare_first, bare_again] = frames(folder.path(), &name, false);
        let [first, again] = frames(folder.path(), &name, true);
        println!("  first spawn: {first:6.2} with colliders, {bare_first:6.2} without");
        println!("  next spawns: {again:6.2} with colliders, {bare_again:6.2} without");
    }
}

/// A file of tori in a row, no two alike.
fn scene(minor: u32) -> Vec<u8> {
    let mut gltf = Gltf::new();
    for i in 0..MESHES {
        let torus = shapes::torus(40, minor, 0.4 + 0.001 * f64::from(i), 0.1);
        let primitive = gltf.primitive(&torus, U16);
        let mesh = gltf.mesh(&format!("Torus{i}"), vec![primitive]);
        gltf.root_node(json!({"name": format!("Node{i}"), "mesh": mesh, "translation": [i, 0, 0]}));
    }
    gltf.for_bevy().glb()
}

/// The longest frame in milliseconds while the scene is spawned for the first time, and in the fastest of the next
/// times.
fn frames(folder: &Path, name: &str, with_colliders: bool) -> [f64; 2] {
    let mut app = app(folder);
    let scene = app.world().resource::<AssetServer>().load(format!("{name}#Scene0"));
    let spawn = |app: &mut App| {
        let mut root = app.world_mut().spawn(WorldAssetRoot(scene.clone()));
        if with_colliders {
            root.insert(MeshColliderHierarchy::default());
        }
        let root = root.id();
        let mut longest = Duration::ZERO;
        let mut left = 3;
        while left > 0 {
            let begun = Instant::now();
            app.update();
            longest = longest.max(begun.elapsed());
            if is_done(app, root, with_colliders) {
                left -= 1;
            }
        }
        app.world_mut().despawn(root);
        app.update();
        longest.as_secs_f64() * 1e3
    };
    let first = spawn(&mut app);
    let next = (0..TIMES).map(|_| spawn(&mut app)).fold(f64::INFINITY, f64::min);
    [first, next]
}

fn is_done(app: &mut App, root: Entity, with_colliders: bool) -> bool {
    let world = app.world_mut();
    if world.get::<Children>(root).is_none() {
        return false;
    }
    let colliders = world.query::<&MeshCollider>().iter(world).len();
    !with_colliders || colliders as u32 == MESHES
}

fn app(folder: &Path) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins.build().disable::<ScheduleRunnerPlugin>(),
        FaceoffHeadlessPlugins {
            assets: AssetPlugin {
                file_path: folder.to_string_lossy().into_owned(),
                ..default()
            },
            step: StepPlugin {
                backend: Backend::Cpu,
                ..default()
            },
        },
        bevy::image::ImagePlugin::default(),
        bevy::mesh::MeshPlugin,
        bevy::world_serialization::WorldSerializationPlugin,
    ))
    .init_asset::<bevy::mesh::skinning::SkinnedMeshInverseBindposes>()
    .add_plugins(bevy::gltf::GltfPlugin::default())
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_nanos(15_625_000)));
    app.finish();
    app.cleanup();
    app
}
