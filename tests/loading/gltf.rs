//! glTF files through Bevy's asset server. `bevy_gltf.rs` has Bevy's own loader beside ours.

use crate::asset_app::*;
use crate::gltf_files::{Gltf, U16};
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::plugin::assets::{CollisionMeshSettings, register};
use serde_json::json;

fn two_meshes() -> Gltf {
    let mut gltf = Gltf::of(&shapes::torus_240());
    let primitive = gltf.primitive(&shapes::cube(1.0), U16);
    let cube = gltf.mesh("Cube", vec![primitive]);
    gltf.root_node(json!({"mesh": cube, "translation": [9, 0, 0], "name": "Placed cube"}));
    gltf
}

#[test]
fn scenes_parts_and_buffers_elsewhere() {
    let _beside = beside_others();
    let folder = tempfile::tempdir().unwrap();
    let gltf = two_meshes();
    write(
        folder.path(),
        "meshes/two.gltf",
        gltf.with_uri("../data/two%20meshes.bin"),
    );
    write(folder.path(), "data/two meshes.bin", &gltf.bin);
    write(folder.path(), "two.glb", gltf.glb());
    write(
        folder.path(),
        "whole.bake.ron",
        "(mesh: \"meshes/two.gltf\", read_outside: true)",
    );
    write(
        folder.path(),
        "cube.bake.ron",
        "(mesh: \"meshes/two.gltf\", part: (mesh: \"Cube\"), read_outside: true)",
    );
    write(
        folder.path(),
        "node.bake.ron",
        "(mesh: \"two.glb\", part: (node: \"Placed cube\"))",
    );
    write(folder.path(), "inside.bake.ron", "(mesh: \"meshes/two.gltf\")");
    write(folder.path(), "two.bin", &gltf.bin);
    write(folder.path(), "beside.gltf", gltf.with_uri("meshes/../two.bin"));
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
            format!("(mesh: \"meshes/{name}.gltf\", read_outside: true)"),
        );
    }
    let mut app = app(plain(folder.path()));
    register(&mut app);
    finish(&mut app);
    for path in ["beside.gltf", "two.glb", "whole.bake.ron"] {
        assert_eq!(loaded(&mut app, path).unwrap().mesh.triangles().len(), 252, "{path}");
    }
    for path in ["cube.bake.ron", "node.bake.ron"] {
        assert_eq!(loaded(&mut app, path).unwrap(), CollisionMesh::new(&shapes::cube(1.0)));
    }
    assert_eq!(
        loaded(&mut app, "torus.bake.ron").unwrap(),
        CollisionMesh::new(&shapes::torus_240())
    );
    for (name, words) in [
        ("none.bake.ron", ["no mesh \"None\"", "1 \"Cube\""]),
        ("meshes/two.gltf", ["\"../data/two meshes.bin\"", "read_outside: true"]),
        ("inside.bake.ron", ["meshes/two.gltf", "read_outside: true"]),
        ("up.bake.ron", ["meshes/up.gltf", "outside the asset folder"]),
        ("gone.bake.ron", ["gone.bake.ron", "meshes/gone.bin"]),
        ("root.bake.ron", ["meshes/root.gltf", "is not a relative path"]),
        ("net.bake.ron", ["meshes/net.gltf", "is not a relative path"]),
    ] {
        let message = loaded(&mut app, name).unwrap_err();
        assert!(words.iter().all(|w| message.contains(w)), "{message}");
    }
}

#[test]
fn settings_choose_a_part() {
    let _beside = beside_others();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "two.glb", two_meshes().glb());
    write(
        folder.path(),
        "meta.glb.meta",
        "(meta_format_version: \"1.0\", asset: Load(loader: \"bevy_faceoff::plugin::assets::loader::CollisionMeshLoader\", \
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
