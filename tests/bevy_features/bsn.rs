//! Components that name entities and Bevy's meshes, in `bsn!`.

use crate::asset_app::{update_until, write};
use crate::prefab::{has, nodes, sim};
use bevy::prelude::*;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::debug::ShowFacesTowards;
use bevy_faceoff::prelude::*;
use serde_json::json;

#[test]
fn an_entity_of_the_scene_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut sim = sim(folder.path());
    let scene = bsn! {
        #Lit
        ShowFacesTowards(#Other)
        Children [ #Other ]
    };
    let lit = sim.world().spawn_scene(scene).unwrap().id();
    let ShowFacesTowards(towards) = sim.get(lit);
    assert_eq!(sim.get::<Name>(towards).as_str(), "Other");
}

#[test]
fn a_mesh_of_a_gltf_file_is_named_by_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let file = nodes(&[("Cube", &shapes::cube(1.0), json!({}))]).for_bevy().glb();
    write(folder.path(), "cube.glb", file);
    let mut sim = sim(folder.path());
    let scene = bsn! {
        RigidBody::Static
        MeshColliderFrom("cube.glb#Mesh0/Primitive0")
    };
    let body = sim.world().spawn_scene(scene).unwrap().id();
    update_until(&mut sim.app, |app| app.world().get::<MeshCollider>(body).is_some());

    // Without a path it has no collider until it gets one.
    let empty = sim.world().spawn_scene(bsn! { MeshColliderFrom }).unwrap().id();
    sim.step(5);
    assert!(!has::<MeshCollider>(&sim, empty));
    let from: MeshColliderFrom = sim.get(body);
    sim.set(empty, from);
    update_until(&mut sim.app, |app| app.world().get::<MeshCollider>(empty).is_some());
    assert!(sim.rejected.is_empty());
}
