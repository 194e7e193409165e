//! The origin of a mesh file without its triangles is that of an import.

use bevy_faceoff::asset::{CollisionMesh, Imported, Origin, format, import_file, to_obj};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::projection::BakeSettings;
use std::fs;
use std::path::Path;

#[test]
fn an_origin_is_that_of_the_import() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let cube = shapes::cube(1.0);
    let settings = BakeSettings {
        weld_tolerance: 0.001,
        ..BakeSettings::default()
    };
    let baked = format::to_bytes(&CollisionMesh::without_faces(&cube, settings), [7; 32]);
    let document = include_str!("../../assets/pentominoes.gltf");
    let recipe = |mesh: &str, more: &str| format!("(mesh: {mesh:?}, {more} settings: (degrees: 5))").into_bytes();
    let files = [
        write("cube.obj", to_obj(&cube).as_bytes()),
        write("cube.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        write("pentominoes.gltf", document.as_bytes()),
        write("baked.faceoff", &baked),
        write("recipe.bake.ron", &recipe("cube.obj", "")),
        write("of_baked.bake.ron", &recipe("baked.faceoff", "")),
        write("in_place.bake.ron", &baked),
        write("scene.bake.ron", &recipe("pentominoes.gltf", "")),
        write("part.bake.ron", &recipe("pentominoes.gltf", &first_part(document))),
        write("far.gltf", &far(folder.path())),
    ];
    for file in files {
        let expected = match import_file(&file).unwrap() {
            Imported::Mesh {
                settings, source_hash, ..
            } => Origin { source_hash, settings },
            Imported::Baked { header, .. } => Origin {
                source_hash: header.source_hash,
                settings: header.settings,
            },
        };
        assert_eq!(Origin::read(&file).unwrap(), expected, "{}", file.display());
    }
}

/// The choice of the first mesh of a document.
fn first_part(document: &str) -> String {
    let document: serde_json::Value = serde_json::from_str(document).unwrap();
    format!("part: (mesh: {}),", document["meshes"][0]["name"])
}

/// A glTF document of one triangle, whose buffer is another file.
fn far(folder: &Path) -> Vec<u8> {
    let points = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    fs::write(folder.join("far.bin"), points.map(f32::to_le_bytes).concat()).unwrap();
    br#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "far.bin", "byteLength": 36}]}"#
        .to_vec()
}

#[test]
fn what_is_missing_or_damaged_has_no_origin() {
    let folder = tempfile::tempdir().unwrap();
    let gltf = folder.path().join("far.gltf");
    fs::write(&gltf, far(folder.path())).unwrap();
    Origin::read(&gltf).unwrap();
    fs::remove_file(folder.path().join("far.bin")).unwrap();
    let error = Origin::read(&gltf).unwrap_err().to_string();
    assert!(error.contains("far.gltf") && error.contains("far.bin"), "{error}");
    assert!(Origin::read(folder.path().join("gone.obj")).is_err());
    let mesh = CollisionMesh::new(&shapes::cube(1.0));
    let mut baked = format::to_bytes(&mesh, [7; 32]);
    assert_eq!(format::verify(&baked).unwrap().1, 12);
    *baked.last_mut().unwrap() ^= 1;
    let file = folder.path().join("damaged.faceoff");
    fs::write(&file, &baked).unwrap();
    assert!(Origin::read(&file).is_err());
    assert!(format::verify(&baked).is_err() && format::verify(&baked[..50]).is_err());
}
