//! glTF files beside Bevy's own loader, which owns their extensions and has to keep them.

use crate::asset_app::*;
use crate::gltf_files::{Gltf, U16};
use bevy::asset::LoadedUntypedAsset;
use bevy::gltf::{Gltf as BevyGltf, GltfMesh, GltfPlugin};
use bevy::image::ImagePlugin;
use bevy::mesh::MeshPlugin;
use bevy::mesh::skinning::SkinnedMeshInverseBindposes;
use bevy::prelude::*;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::prelude::*;
use serde_json::json;

/// A torus and a cube.
fn two_meshes() -> Vec<u8> {
    let mut gltf = Gltf::of(&shapes::torus_240());
    let primitive = gltf.primitive(&shapes::cube(1.0), U16);
    let cube = gltf.mesh("Cube", vec![primitive]);
    gltf.root_node(json!({"mesh": cube, "translation": [9, 0, 0]}));
    gltf.for_bevy().glb()
}

/// An app with Bevy's glTF loader and all that it needs, and ours, in one order or the other.
fn both(folder: &std::path::Path, ours_first: bool) -> App {
    let mut app = app(plain(folder));
    if ours_first {
        app.add_plugins(FaceoffPlugins::default());
    }
    app.add_plugins((ImagePlugin::default(), MeshPlugin, WorldSerializationPlugin))
        .init_asset::<SkinnedMeshInverseBindposes>()
        .add_plugins(GltfPlugin::default());
    if !ours_first {
        app.add_plugins(FaceoffPlugins::default());
    }
    finish(&mut app);
    app
}

/// Corners of the triangles of a mesh that Bevy loaded.
fn corners(app: &App, handle: &Handle<Mesh>) -> usize {
    let mesh = app
        .world()
        .resource::<Assets<Mesh>>()
        .get(handle)
        .expect("it is loaded");
    // Without normals in the file Bevy gives every triangle corners of its own, and no indices.
    mesh.indices().map_or(mesh.count_vertices(), |indices| indices.len())
}

#[test]
fn each_loader_gets_what_is_its_own() {
    for ours_first in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let glb = two_meshes();
        for name in ["a.glb", "b.glb", "c.glb"] {
            write(folder.path(), name, &glb);
        }
        write(
            folder.path(),
            "cube.bake.ron",
            "(mesh: \"a.glb\", part: (mesh: \"Cube\"))",
        );
        let mut app = both(folder.path(), ours_first);
        let server = server(&app);

        // Bevy's mesh, then the collision mesh of the same file.
        let drawn: Handle<Mesh> = server.load("a.glb#Mesh0/Primitive0");
        settle(&mut app, &drawn).unwrap();
        assert_eq!(corners(&app, &drawn), 3 * 240, "ours first: {ours_first}");
        assert_eq!(loaded(&mut app, "a.glb").unwrap().mesh.triangles().len(), 252);

        // The other way round.
        assert_eq!(loaded(&mut app, "b.glb").unwrap().mesh.triangles().len(), 252);
        let drawn: Handle<Mesh> = server.load("b.glb#Mesh1/Primitive0");
        settle(&mut app, &drawn).unwrap();
        assert_eq!(corners(&app, &drawn), 3 * 12);

        // Both at once, the whole file for Bevy, and without a type.
        let whole: Handle<BevyGltf> = server.load("c.glb");
        let mesh: Handle<CollisionMesh> = server.load("c.glb");
        settle(&mut app, &whole).unwrap();
        settle(&mut app, &mesh).unwrap();
        assert_eq!(
            app.world()
                .resource::<Assets<BevyGltf>>()
                .get(&whole)
                .unwrap()
                .meshes
                .len(),
            2
        );
        let untyped = server.load_builder().load_untyped("c.glb");
        settle(&mut app, &untyped).unwrap();
        let handle = &app
            .world()
            .resource::<Assets<LoadedUntypedAsset>>()
            .get(&untyped)
            .unwrap()
            .handle;
        assert_eq!(handle.type_id(), std::any::TypeId::of::<BevyGltf>());

        // A recipe reads the file by itself.
        let cube = CollisionMesh::new(&shapes::cube(1.0));
        assert_eq!(loaded(&mut app, "cube.bake.ron").unwrap(), cube);
    }
}

#[test]
fn a_collider_of_what_bevy_loaded() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "two.glb", two_meshes());
    let mut app = both(folder.path(), false);
    let server = server(&app);
    let mesh: Handle<GltfMesh> = server.load("two.glb#Mesh1");
    settle(&mut app, &mesh).unwrap();
    let meshes = app.world().resource::<Assets<GltfMesh>>();
    let cube = meshes.get(&mesh).unwrap().primitives[0].mesh.clone();
    let body = app.world_mut().spawn(MeshColliderFrom(cube)).id();
    update_until(&mut app, |app| app.world().get::<MeshCollider>(body).is_some());
    let MeshCollider(handle) = app.world().get::<MeshCollider>(body).unwrap();
    let mesh = app.world().resource::<Assets<CollisionMesh>>().get(handle).unwrap();
    assert_eq!(mesh.mesh.triangles().len(), 12);
    assert!((mesh.mass.volume - 1.0).abs() < 1e-5, "{}", mesh.mass.volume);
}

/// A file that comes later, for example the end of a download.
#[test]
fn a_collider_of_a_mesh_that_could_not_be_loaded_at_first() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = both(folder.path(), false);
    let server = server(&app);
    let drawn: Handle<Mesh> = server.load("late.glb#Mesh1/Primitive0");
    let body = app.world_mut().spawn(MeshColliderFrom(drawn.clone())).id();
    settle(&mut app, &drawn).unwrap_err();
    for _ in 0..5 {
        app.update();
    }
    assert!(app.world().get::<MeshCollider>(body).is_none());
    write(folder.path(), "late.glb", two_meshes());
    // Bevy tries again what has failed when it is asked for.
    let again: Handle<Mesh> = server.load("late.glb#Mesh1/Primitive0");
    assert_eq!(again, drawn);
    update_until(&mut app, |app| app.world().get::<MeshCollider>(body).is_some());
}
