//! Files that break a rule of their format in a way that leaves no doubt: they are read, with a warning.

use crate::gltf_files::Gltf;
use crate::stl_files::binary;
use bevy_faceoff::asset::{Imported, import_bytes, import_file};
use bevy_faceoff::geometry::{TriMesh, shapes};
use serde_json::json;

/// Reads a file of this name and content from disk.
#[track_caller]
fn read(name: &str, bytes: impl AsRef<[u8]>) -> (TriMesh, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let imported = import_file(&path).unwrap();
    // A recipe hands the warnings on.
    let recipe = folder.path().join("x.bake.ron");
    std::fs::write(&recipe, format!("(mesh: {name:?})")).unwrap();
    assert_eq!(import_file(&recipe).unwrap().warnings(), imported.warnings());
    let warnings = imported.warnings().to_vec();
    match imported {
        Imported::Mesh { mesh, .. } => (mesh, warnings),
        Imported::Baked { .. } => panic!("not baked"),
    }
}

/// Reads a file that gives the cube and one warning that has these words.
#[track_caller]
fn warned(name: &str, bytes: &[u8], words: &[&str]) {
    let (mesh, warnings) = read(name, bytes);
    assert_eq!(mesh.triangles().len(), 12);
    assert!(
        warnings.len() == 1 && words.iter().all(|word| warnings[0].contains(word)),
        "{warnings:?}"
    );
}

/// A `.glb` file whose document has this text, without padding.
fn glb_of(document: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, content) in [(b"JSON", document), (b"BIN\0", bin)] {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
    }
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

#[test]
fn files_without_fault_have_no_warnings() {
    let cube = shapes::cube(1.0);
    for (name, bytes) in [
        ("x.glb", Gltf::of(&cube).glb()),
        ("x.gltf", Gltf::of(&cube).with_data_uri()),
        ("x.stl", binary("solid", &cube)),
        ("x.obj", bevy_faceoff::asset::to_obj(&cube).into_bytes()),
        ("x.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n# end\n\n".to_vec()),
    ] {
        assert_eq!(read(name, bytes).1, [""; 0], "{name}");
    }
}

#[test]
fn containers_of_gltf() {
    let mut gltf = Gltf::of(&shapes::cube(1.0));
    gltf.fit();
    let document = gltf.json.to_string();
    // The document is not padded. A text of a right length would be.
    let extra = " ".repeat(document.len().next_multiple_of(4) + 1 - document.len());
    let document = document + &extra;
    let unpadded = glb_of(document.as_bytes(), &gltf.bin);
    warned("x.glb", &unpadded, &["not padded to four bytes"]);
    // It is padded with zeros.
    let padded = format!("{document}\0\0\0");
    warned("x.glb", &glb_of(padded.as_bytes(), &gltf.bin), &["zeros"]);
    assert!(import_bytes("x.glb", &glb_of(b"\0\0\0\0", &gltf.bin)).is_err());
    // The header tells a length without the binary chunk.
    let whole = gltf.glb();
    let mut short = whole.clone();
    let length = 20 + u32::from_le_bytes(whole[12..16].try_into().unwrap());
    short[8..12].copy_from_slice(&length.to_le_bytes());
    let said = [
        &format!("ends after {length} bytes"),
        &*format!("end after {}", whole.len()),
    ];
    warned("x.glb", &short, &said);
    // What is cut off is still refused, also if the header tells the length that is left.
    for length in 12..whole.len() {
        let mut cut = whole[..length].to_vec();
        cut[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        assert!(import_bytes("x.glb", &cut).is_err(), "{length} of {}", whole.len());
    }
    // Bytes after the end that are no chunk do not matter, whatever they are.
    for rest in [&b"x"[..], &[0; 8], &[0xff; 40]] {
        let (mesh, warnings) = read("x.glb", [&whole, rest].concat());
        assert_eq!((mesh.triangles().len(), warnings.len()), (12, 0));
    }
    // A document that is complete in itself may be all there is.
    let mut alone = gltf.clone();
    alone.json["buffers"] =
        serde_json::from_slice::<serde_json::Value>(&gltf.with_data_uri()).unwrap()["buffers"].clone();
    alone.json["asset"] = json!({"version": "2.0"});
    let glb = crate::gltf_files::glb(alone.json.to_string().as_bytes(), None);
    assert_eq!(read("x.glb", &glb).1, [""; 0]);
    assert_eq!(read("x.glb", [&glb, &b"junk"[..]].concat()).1, [""; 0]);
}

#[test]
fn what_follows_the_last_face() {
    let cube = shapes::cube(1.0);
    let mut bytes = binary("a", &cube);
    bytes.extend(b"comment");
    warned("x.stl", &bytes, &["7 bytes after the last of its 12 triangles"]);
    // A header that tells too few triangles.
    let ball = shapes::ball(1.0, 1);
    let mut few = binary("a", &ball);
    few[80..84].copy_from_slice(&12u32.to_le_bytes());
    let rest = (ball.triangles().len() - 12) * 50;
    warned("x.stl", &few, &[&format!("{rest} bytes after")]);
    let (mesh, warnings) = read("x.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n3 0 2 1\n");
    assert_eq!(mesh.triangles().len(), 1);
    assert!(
        warnings.len() == 1 && warnings[0].starts_with("line 8 and what follows is not read"),
        "{warnings:?}"
    );
}

#[test]
fn faces_with_too_few_corners() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\nf 3\nl 1 2\n";
    let (mesh, warnings) = read("x.obj", text);
    assert_eq!(mesh.triangles().len(), 1);
    assert!(
        warnings.len() == 1 && warnings[0].starts_with("faces with fewer than three corners, 2 in all"),
        "{warnings:?}"
    );
}

#[test]
fn packages_of_3mf_are_told_what_to_do() {
    let package = b"PK\x03\x04\x14\0\0\0\x08\0....................3D/3dmodel.model";
    for (name, bytes) in [
        ("x.3mf", &package[..]),
        ("x.3MF", b""),
        ("x", package),
        ("x.zip", package),
    ] {
        let message = import_bytes(name, bytes).unwrap_err().to_string();
        assert!(
            message.starts_with("3MF files are not supported; export"),
            "{name}: {message}"
        );
        assert!(message.contains("OBJ, STL, PLY"), "{message}");
    }
}

#[test]
fn what_follows_the_last_element_of_a_ply_file() {
    let cube = shapes::cube(1.0);
    for bytes in crate::ply_files::all_kinds(&cube) {
        assert_eq!(read("x.ply", &bytes).1, [""; 0]);
        assert_eq!(read("x.ply", [&bytes[..], b"\n\n"].concat()).1, [""; 0]);
        warned(
            "x.ply",
            &[&bytes[..], b"3 0 1 2"].concat(),
            &["7 bytes after the last element"],
        );
    }
}

#[test]
fn what_is_not_read_of_a_gltf_file_is_told() {
    let cube = shapes::cube(1.0);
    let instances = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}});
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    for (key, value, word) in [
        ("extensions", instances, "EXT_mesh_gpu_instancing"),
        ("extensions", hidden, "KHR_node_visibility"),
        ("skin", json!(0), "skins"),
    ] {
        let mut gltf = Gltf::of(&cube);
        gltf.json["nodes"][0][key] = value;
        warned("x.glb", &gltf.glb(), &["1 nodes", word]);
    }
    let mut gltf = Gltf::of(&cube);
    gltf.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    warned("x.glb", &gltf.glb(), &["1 primitives", "morph targets"]);
    // What changes nothing is not told.
    let mut gltf = Gltf::of(&cube);
    gltf.json["nodes"][0]["extensions"] = json!({"KHR_node_visibility": {"visible": true}, "other": 1});
    gltf.json["skins"] = json!([{"joints": [0]}]);
    assert_eq!(read("x.glb", gltf.glb()).1, [""; 0]);
}

/// By the specification only its joints place it.
#[test]
fn the_node_of_a_mesh_with_a_skin_does_not_place_it() {
    let cube = shapes::cube(1.0);
    let mut gltf = Gltf::of(&cube);
    gltf.json["nodes"][0]["translation"] = json!([5.0, 0.0, 0.0]);
    let moved = read("x.glb", gltf.glb()).0;
    assert_eq!(moved.vertices()[0].x, cube.vertices()[0].x + 5.0);
    gltf.json["nodes"][0]["skin"] = json!(0);
    assert_eq!(read("x.glb", gltf.glb()).0.vertices(), cube.vertices());
}
