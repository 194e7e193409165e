//! Scenes of Bevy's glTF loader that go in as they are.

mod bakes;
mod body;
mod changes;
mod settings;

use crate::app::Sim;
use crate::asset_app::{plain, update_until};
use crate::gltf_files::{Gltf, U16};
use bevy::gltf::GltfPlugin;
use bevy::image::ImagePlugin;
use bevy::mesh::MeshPlugin;
use bevy::mesh::skinning::SkinnedMeshInverseBindposes;
use bevy::prelude::*;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_faceoff::geometry::TriMesh;
use bevy_faceoff::plugin::prefab::PrefabError;
use bevy_faceoff::prelude::*;
use serde_json::{Value, json};
use std::path::Path;

/// What [`MeshColliderHierarchyReady`] told.
#[derive(Resource, Default)]
pub struct Told(pub Vec<MeshColliderHierarchyReady>);

/// Number of collision meshes that were made.
#[derive(Resource, Default)]
struct Made(usize);

/// A simulation that loads scenes from `folder`.
pub fn sim(folder: &Path) -> Sim {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        FaceoffHeadlessPlugins {
            assets: plain(folder),
            step: StepPlugin {
                backend: Backend::Cpu,
                threads: 1,
                ..default()
            },
        },
        ImagePlugin::default(),
        MeshPlugin,
        WorldSerializationPlugin,
    ))
    .init_asset::<SkinnedMeshInverseBindposes>()
    .add_plugins(GltfPlugin::default())
    .init_resource::<Told>()
    .init_resource::<Made>()
    .add_systems(
        First,
        |mut events: MessageReader<AssetEvent<CollisionMesh>>, mut made: ResMut<Made>| {
            made.0 += events
                .read()
                .filter(|event| matches!(event, AssetEvent::Added { .. }))
                .count();
        },
    )
    .add_observer(|ready: On<MeshColliderHierarchyReady>, mut told: ResMut<Told>| {
        told.0.push(ready.event().clone());
    });
    #[cfg(feature = "bevy_scene")]
    app.add_plugins(bevy::scene::ScenePlugin);
    Sim::of(app)
}

/// Spawns the first scene of a file.
pub fn spawn(sim: &mut Sim, file: &str, bundle: impl Bundle) -> Entity {
    let scene = sim.world().resource::<AssetServer>().load(format!("{file}#Scene0"));
    sim.spawn((WorldAssetRoot(scene), bundle))
}

/// Waits until the colliders are there `times` times.
#[track_caller]
pub fn ready_again(sim: &mut Sim, root: Entity, times: usize) -> MeshColliderHierarchyReady {
    let mut found = None;
    update_until(&mut sim.app, |app| {
        let told = &app.world().resource::<Told>().0;
        found = told.iter().filter(|ready| ready.entity == root).nth(times - 1).cloned();
        found.is_some()
    });
    found.unwrap()
}

#[track_caller]
pub fn ready(sim: &mut Sim, root: Entity) -> MeshColliderHierarchyReady {
    ready_again(sim, root, 1)
}

/// The entity of this name.
#[track_caller]
pub fn entity(sim: &mut Sim, name: &str) -> Entity {
    let world = sim.world();
    let mut names = world.query::<(Entity, &Name)>();
    let found: Vec<_> = names.iter(world).filter(|(_, own)| own.as_str() == name).collect();
    assert_eq!(found.len(), 1, "{name}");
    found[0].0
}

pub fn has<C: Component>(sim: &Sim, entity: Entity) -> bool {
    sim.app.world().get::<C>(entity).is_some()
}

pub fn collision_mesh(sim: &Sim, entity: Entity) -> CollisionMesh {
    let MeshCollider(handle) = sim.get(entity);
    sim.app
        .world()
        .resource::<Assets<CollisionMesh>>()
        .get(&handle)
        .unwrap()
        .clone()
}

/// Number of collision meshes that were made since the last call.
pub fn made(sim: &mut Sim) -> usize {
    // Bevy tells at the end of the frame.
    sim.step(2);
    std::mem::take(&mut sim.world().resource_mut::<Made>().0)
}

pub fn faults(errors: &[PrefabError]) -> Vec<(String, String)> {
    errors
        .iter()
        .map(|error| (error.node.clone(), error.to_string()))
        .collect()
}

/// A file with a node for each mesh, of the same name as the mesh.
pub fn nodes(meshes: &[(&str, &TriMesh, Value)]) -> Gltf {
    let mut gltf = Gltf::new();
    for (name, mesh, node) in meshes {
        let primitive = gltf.primitive(mesh, U16);
        let mesh = gltf.mesh(&format!("{name}Mesh"), vec![primitive]);
        let mut node = node.clone();
        (node["name"], node["mesh"]) = (json!(name), json!(mesh));
        gltf.root_node(node);
    }
    gltf
}
