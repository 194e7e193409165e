//! glTF files through Bevy's asset server, beside a loader that owns their extensions, as Bevy's own does.

mod asset_app;
mod gltf_files;

use asset_app::*;
use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use bevy_faceoff::asset::{CollisionMesh, CollisionMeshSettings, register};
use bevy_faceoff::geometry::shapes;
use gltf_files::*;
use serde_json::json;

/// What the owner of the extensions makes of a file.
#[derive(Asset, TypePath)]
struct DrawnScene;

#[derive(Asset, TypePath)]
struct DrawnMesh(usize);

#[derive(TypePath)]
struct SceneLoader;

impl AssetLoader for SceneLoader {
    type Asset = DrawnScene;
    type Settings = ();
    type Error = std::io::Error;
    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> std::io::Result<DrawnScene> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        context.add_labeled_asset("Mesh0", DrawnMesh(bytes.len()));
        Ok(DrawnScene)
    }
    fn extensions(&self) -> &[&str] {
        &["gltf", "glb"]
    }
}

fn register_scene_loader(app: &mut App) {
    app.init_asset::<DrawnScene>()
        .init_asset::<DrawnMesh>()
        .register_asset_loader(SceneLoader);
}

fn two_meshes() -> Gltf {
    let mut gltf = Gltf::of(&shapes::torus_240());
    let primitive = gltf.primitive(&shapes::cube(1.0), U16);
    let cube = gltf.mesh("Cube", vec![primitive]);
    gltf.root_node(json!({"mesh": cube, "translation": [9, 0, 0]}));
    gltf
}

#[test]
fn the_owner_of_the_extensions_keeps_them() {
    for ours_first in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let glb = two_meshes().glb();
        for name in ["a.glb", "b.glb", "c.glb"] {
            write(folder.path(), name, &glb);
        }
        let mut app = app(plain(folder.path()));
        if ours_first {
            register(&mut app);
        }
        register_scene_loader(&mut app);
        if !ours_first {
            register(&mut app);
        }
        finish(&mut app);
        let server = server(&app);

        // By label alone, by label after the collision mesh, and the other way round.
        let drawn: Handle<DrawnMesh> = server.load("a.glb#Mesh0");
        settle(&mut app, &drawn).unwrap();
        assert_eq!(loaded(&mut app, "a.glb").unwrap().mesh.triangles().len(), 252);
        assert_eq!(loaded(&mut app, "b.glb").unwrap().mesh.triangles().len(), 252);
        let drawn: Handle<DrawnMesh> = server.load("b.glb#Mesh0");
        settle(&mut app, &drawn).unwrap();
        assert_eq!(
            app.world().resource::<Assets<DrawnMesh>>().get(&drawn).unwrap().0,
            glb.len()
        );
        let scene: Handle<DrawnScene> = server.load("c.glb");
        let mesh: Handle<CollisionMesh> = server.load("c.glb");
        settle(&mut app, &scene).unwrap();
        settle(&mut app, &mesh).unwrap();
        let untyped = server.load_builder().load_untyped("c.glb");
        settle(&mut app, &untyped).unwrap();
    }
}

#[test]
fn scenes_parts_and_buffers_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let gltf = two_meshes();
    write(
        folder.path(),
        "meshes/two.gltf",
        gltf.with_uri("../data/two%20meshes.bin"),
    );
    write(folder.path(), "data/two meshes.bin", &gltf.bin);
    write(folder.path(), "two.glb", gltf.glb());
    write(folder.path(), "whole.bake.ron", "(mesh: \"meshes/two.gltf\")");
    write(
        folder.path(),
        "cube.bake.ron",
        "(mesh: \"meshes/two.gltf\", part: (mesh: \"Cube\"))",
    );
    write(
        folder.path(),
        "torus.bake.ron",
        "(mesh: \"two.glb\", part: (mesh: 0, primitive: 0))",
    );
    write(
        folder.path(),
        "none.bake.ron",
        "(mesh: \"two.glb\", part: (mesh: \"None\"))",
    );
    for (name, uri) in [
        ("up", "../../secret.bin"),
        ("gone", "gone.bin"),
        ("root", "/etc/passwd"),
        ("net", "http://x.y/z"),
    ] {
        write(folder.path(), &format!("meshes/{name}.gltf"), gltf.with_uri(uri));
        write(
            folder.path(),
            &format!("{name}.bake.ron"),
            format!("(mesh: \"meshes/{name}.gltf\")"),
        );
    }
    let mut app = app(plain(folder.path()));
    register(&mut app);
    finish(&mut app);
    for path in ["meshes/two.gltf", "two.glb", "whole.bake.ron"] {
        assert_eq!(loaded(&mut app, path).unwrap().mesh.triangles().len(), 252, "{path}");
    }
    assert_eq!(
        loaded(&mut app, "cube.bake.ron").unwrap(),
        CollisionMesh::new(&shapes::cube(1.0))
    );
    assert_eq!(
        loaded(&mut app, "torus.bake.ron").unwrap(),
        CollisionMesh::new(&shapes::torus_240())
    );
    for (name, words) in [
        ("none.bake.ron", ["no mesh \"None\"", "1 \"Cube\""]),
        ("meshes/up.gltf", ["meshes/up.gltf", "outside the asset folder"]),
        ("up.bake.ron", ["meshes/up.gltf", "outside the asset folder"]),
        ("gone.bake.ron", ["gone.bake.ron", "meshes/gone.bin"]),
        ("root.bake.ron", ["meshes/root.gltf", "no relative path"]),
        ("net.bake.ron", ["meshes/net.gltf", "no relative path"]),
    ] {
        let message = loaded(&mut app, name).unwrap_err();
        assert!(words.iter().all(|w| message.contains(w)), "{message}");
    }
}

#[test]
fn settings_choose_a_part() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "two.glb", two_meshes().glb());
    write(
        folder.path(),
        "meta.glb.meta",
        "(meta_format_version: \"1.0\", asset: Load(loader: \"bevy_faceoff::asset::loader::CollisionMeshLoader\", \
         settings: (part: Some((mesh: \"Cube\", primitive: Some(0))))))",
    );
    write(folder.path(), "meta.glb", two_meshes().glb());
    let mut app = app(plain(folder.path()));
    register(&mut app);
    finish(&mut app);
    let handle: Handle<CollisionMesh> = server(&app)
        .load_builder()
        .with_settings(|s: &mut CollisionMeshSettings| s.part = Some("Cube".into()))
        .load("two.glb");
    settle(&mut app, &handle).unwrap();
    let cube = CollisionMesh::new(&shapes::cube(1.0));
    assert!(app.world().resource::<Assets<CollisionMesh>>().get(&handle) == Some(&cube));
    assert_eq!(loaded(&mut app, "meta.glb").unwrap(), cube);
}
