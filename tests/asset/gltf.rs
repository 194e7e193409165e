//! glTF files that are right: what is read of them, from wherever.

use crate::gltf_files::*;
use bevy_faceoff::asset::{
    GltfError, ImportError, Imported, MeshPart, NameOrIndex, import_bytes, import_file, import_part,
};
use bevy_faceoff::geometry::{Orientation, TriMesh, shapes};
use glam::Vec3;
use serde_json::json;
use std::path::Path;

fn read(gltf: &Gltf) -> TriMesh {
    import_bytes("x.glb", &gltf.glb()).unwrap()
}

fn corners(mesh: &TriMesh) -> Vec<[Vec3; 3]> {
    (0..mesh.triangles().len()).map(|t| mesh.corners(t)).collect()
}

#[test]
fn indices_of_every_size_and_none() {
    let mesh = shapes::torus_240();
    for component in [U8, U16, U32] {
        let mut gltf = Gltf::new();
        let primitive = gltf.primitive(&mesh, component);
        let index = gltf.mesh("m", vec![primitive]);
        gltf.root_node(json!({"mesh": index}));
        assert_eq!(read(&gltf), mesh);
    }
    let mut gltf = Gltf::new();
    let soup: Vec<[f32; 3]> = corners(&mesh).as_flattened().iter().map(|c| c.to_array()).collect();
    let position = gltf.positions(&soup);
    gltf.mesh("m", vec![json!({"attributes": {"POSITION": position}})]);
    gltf.root_node(json!({"mesh": 0}));
    let without = read(&gltf);
    assert_eq!(corners(&without), corners(&mesh));
    assert_eq!(without.orientation(), Orientation::Outward);
}

/// A copy of the `.glb` file whose document is `extra` bytes longer than a multiple of four.
fn not_padded(glb: &[u8], extra: usize) -> Vec<u8> {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let (document, binary) = glb[20..].split_at(length);
    let word = |n: usize| (n as u32).to_le_bytes();
    let parts: [&[u8]; 7] = [
        &glb[..8],
        &word(glb.len() + extra),
        &word(length + extra),
        b"JSON",
        document,
        &b"   "[..extra],
        binary,
    ];
    parts.concat()
}

#[test]
fn all_containers() {
    let mesh = shapes::knot_1120();
    let gltf = Gltf::of(&mesh);
    for bytes in [gltf.glb(), gltf.with_data_uri()] {
        for name in ["x.glb", "x.gltf", "no_extension", "wrong.bin"] {
            assert_eq!(import_bytes(name, &bytes).unwrap(), mesh);
        }
    }
    assert!(
        import_bytes("x.obj", &gltf.glb()).is_ok(),
        "the magic outranks the name"
    );
    for extra in 1..4 {
        assert_eq!(import_bytes("x.glb", &not_padded(&gltf.glb(), extra)).unwrap(), mesh);
    }
    let mut marked = b"\xef\xbb\xbf".to_vec();
    marked.extend(gltf.with_data_uri());
    assert_eq!(import_bytes("x.gltf", &marked).unwrap(), mesh);
    let unpadded = String::from_utf8(gltf.with_data_uri()).unwrap().replace('=', "");
    assert_eq!(import_bytes("x.gltf", unpadded.as_bytes()).unwrap(), mesh);
    assert!(matches!(
        import_bytes("x.gltf", &gltf.with_uri("a.bin")),
        Err(ImportError::Gltf(GltfError::OtherFiles(file))) if file == "a.bin"
    ));
}

#[test]
fn strips_and_fans_keep_their_winding() {
    // A box whose sides are one strip, its bottom a fan, its top two triangles.
    let at = |x: u32, y: u32, z: u32| [x as f32, y as f32, z as f32];
    let vertices: Vec<[f32; 3]> = (0..8).map(|i: u32| at(i & 1, i >> 1 & 1, i >> 2)).collect();
    let mut gltf = Gltf::new();
    let position = gltf.positions(&vertices);
    let sides = gltf.indices(&[4, 0, 5, 1, 7, 3, 6, 2, 4, 0], U8);
    let bottom = gltf.indices(&[0, 2, 3, 1], U16);
    let top = gltf.indices(&[4, 5, 7, 4, 7, 6], U32);
    let primitive =
        |indices: usize, mode: u32| json!({"attributes": {"POSITION": position}, "indices": indices, "mode": mode});
    gltf.mesh(
        "box",
        vec![primitive(sides, 5), primitive(bottom, 6), primitive(top, 4)],
    );
    gltf.root_node(json!({"mesh": 0}));
    let mesh = read(&gltf);
    assert_eq!(mesh.triangles().len(), 12);
    assert_eq!(mesh.orientation(), Orientation::Outward);
    // The strip's second triangle is turned, the fan turns about its first corner.
    assert_eq!(mesh.corners(0), [4, 0, 5].map(|i: usize| vertices[i].into()));
    assert_eq!(mesh.corners(1), [0, 1, 5].map(|i: usize| vertices[i].into()));
    assert_eq!(mesh.corners(8), [2, 3, 0].map(|i: usize| vertices[i].into()));
}

#[test]
fn nodes_place_and_repeat_meshes() {
    let cube = shapes::cube(1.0);
    let mut gltf = Gltf::new();
    let primitive = gltf.primitive(&cube, U16);
    gltf.mesh("cube", vec![primitive]);
    // Turned by a quarter about z, by a quaternion of length 2.
    let turned = gltf.node(json!({"mesh": 0, "translation": [5, 0, 0], "scale": [1, 2, 3]}));
    let parent = json!({"children": [turned], "rotation": [0, 0, 2f64.sqrt(), 2f64.sqrt()], "translation": [0, 0, 10]});
    gltf.root_node(parent);
    #[rustfmt::skip]
    let mirrored = [-1.0, 0.0, 0.0, 0.0,  0.0, 1.0, 0.0, 0.0,  0.0, 0.0, 1.0, 0.0,  -20.0, 0.0, 0.0, 1.0];
    gltf.root_node(json!({"mesh": 0, "matrix": mirrored}));
    gltf.node(json!({"mesh": 0, "translation": [1e6, 0, 0], "name": "in no scene"}));
    let mesh = read(&gltf);
    assert_eq!(mesh.triangles().len(), 24);
    assert_eq!(
        mesh.orientation(),
        Orientation::Outward,
        "the mirrored cube is turned outside again"
    );
    for (t, corners) in corners(&cube).into_iter().enumerate() {
        for (found, c) in mesh.corners(t).into_iter().zip(corners) {
            let expected = Vec3::new(-2.0 * c.y, 5.0 + c.x, 10.0 + 3.0 * c.z);
            assert!(found.distance(expected) < 1e-5, "{found} {expected}");
        }
        let [a, b, c] = corners.map(|c| Vec3::new(-20.0 - c.x, c.y, c.z));
        assert_eq!(mesh.corners(12 + t), [a, c, b]);
    }
}

#[test]
fn parts() {
    let (cube, ball) = (shapes::cube(1.0), shapes::ball(1.0, 1));
    let mut gltf = Gltf::new();
    let primitives = vec![gltf.primitive(&cube, U16), gltf.primitive(&ball, U16)];
    gltf.mesh("Both", primitives);
    let primitive = gltf.primitive(&ball, U16);
    gltf.mesh("Ball", vec![primitive]);
    gltf.root_node(json!({"mesh": 1, "translation": [3, 0, 0]}));
    let bytes = gltf.glb();
    let part = |part: MeshPart| import_part("x.glb", &bytes, Some(&part));
    assert_eq!(part("Ball".into()).unwrap(), ball);
    assert_eq!(part(1.into()).unwrap(), ball);
    assert_eq!(
        part("Both".into()).unwrap().triangles().len(),
        12 + ball.triangles().len()
    );
    let primitive = |i| MeshPart::Mesh {
        mesh: NameOrIndex::Index(0),
        primitive: Some(i),
    };
    assert_eq!(part(primitive(0)).unwrap(), cube);
    assert_eq!(part(primitive(1)).unwrap(), ball);
    let message = |p: MeshPart| part(p).unwrap_err().to_string();
    assert!(message(primitive(2)).contains("mesh 0 \"Both\" has no primitive 2; it has 2"));
    assert!(message("ball".into()).contains("no mesh \"ball\"; there are 2: 0 \"Both\", 1 \"Ball\""));
    assert!(message(2.into()).contains("no mesh 2; there are 2"));
    assert!(matches!(
        import_part("x.stl", b"solid\nendsolid", Some(&0.into())),
        Err(ImportError::NoParts)
    ));
    // Without scenes nothing is shown, but parts can be had.
    gltf.json["scenes"] = json!([]);
    gltf.json.as_object_mut().unwrap().remove("scene");
    let bytes = gltf.glb();
    assert!(
        import_bytes("x.glb", &bytes)
            .unwrap_err()
            .to_string()
            .contains("no scene; choose one of its 2 meshes")
    );
    assert_eq!(import_part("x.glb", &bytes, Some(&1.into())).unwrap(), ball);
}

#[test]
fn sparse_accessors() {
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut gltf = Gltf::new();
    let places = gltf.view(&integers(&[1, 2], U16));
    let values = gltf.view(&floats(&[[4.0, 0.0, 0.0], [0.0, 5.0, 0.0]]));
    let sparse = json!({
        "count": 2,
        "indices": {"bufferView": places, "componentType": U16},
        "values": {"bufferView": values},
    });
    let base = gltf.view(&floats(&triangle));
    for view in [json!(base), json!(null)] {
        let mut gltf = gltf.clone();
        let position = json!({"bufferView": view, "componentType": F32, "count": 3, "type": "VEC3", "sparse": sparse});
        let position = gltf.accessor(position);
        gltf.mesh("m", vec![json!({"attributes": {"POSITION": position}})]);
        gltf.root_node(json!({"mesh": 0}));
        assert_eq!(read(&gltf).corners(0), [Vec3::ZERO, 4.0 * Vec3::X, 5.0 * Vec3::Y]);
    }
}

#[test]
fn quantised_and_interleaved_positions() {
    let expected = [Vec3::ZERO, Vec3::X, Vec3::NEG_Y];
    for (component, size, one, minus) in [
        (I8, 1, 127, -127i32),
        (I16, 2, 32767, -32768),
        (U8, 1, 255, 0),
        (U16, 2, 65535, 0),
    ] {
        for normalized in [true, false] {
            let mut gltf = Gltf::new();
            let mut bytes = Vec::new();
            for position in [[0, 0, 0], [one, 0, 0], [0, minus, 0i32]] {
                let numbers = position.map(|x| x as u32);
                bytes.extend(integers(&numbers, component));
                // Quantised elements are padded to four bytes, and here there is something else between them.
                bytes.resize(bytes.len().next_multiple_of(4 * size), 0xaa);
            }
            // The last element need not be padded.
            let view = gltf.view(&bytes[..bytes.len() - size]);
            gltf.json["bufferViews"][view]["byteStride"] = json!(4 * size);
            let position = gltf.accessor(json!({
                "bufferView": view, "componentType": component, "normalized": normalized, "count": 3, "type": "VEC3",
            }));
            gltf.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            gltf.mesh("m", vec![json!({"attributes": {"POSITION": position}})]);
            gltf.root_node(json!({"mesh": 0}));
            if minus == 0 {
                // Without sign there are two corners at one place; enough to see that it is read.
                let error = import_bytes("x.glb", &gltf.glb()).unwrap_err().to_string();
                assert!(error.contains("degenerate"), "{error}");
                continue;
            }
            let scale = if normalized {
                [1.0, 1.0]
            } else {
                [one as f32, -minus as f32]
            };
            let found = read(&gltf).corners(0);
            assert_eq!(found, [expected[0], expected[1] * scale[0], expected[2] * scale[1]]);
        }
    }
}

#[test]
fn what_is_not_triangles_is_passed_over() {
    let cube = shapes::cube(1.0);
    let mut gltf = Gltf::of(&cube);
    let lines: Vec<_> = (0..4).map(|mode| json!({"attributes": {}, "mode": mode})).collect();
    let lines = gltf.mesh("lines", lines);
    gltf.root_node(json!({"mesh": lines}));
    gltf.root_node(json!({"camera": 4, "skin": 9}));
    gltf.json["extensionsRequired"] = json!(["KHR_materials_unlit", "KHR_texture_basisu", "KHR_lights_punctual"]);
    assert_eq!(read(&gltf), cube);
    let error = import_part("x.glb", &gltf.glb(), Some(&"lines".into())).unwrap_err();
    assert!(error.to_string().contains("no triangles in the chosen part"), "{error}");
    // Compressed data beside plain data.
    gltf.json["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {"bufferView": 0}});
    assert_eq!(read(&gltf), cube);
}

#[test]
fn a_million_triangles() {
    let mesh = shapes::torus(1000, 500, 1.0, 0.3);
    let mut gltf = Gltf::new();
    let primitive = gltf.primitive(&mesh, U32);
    gltf.mesh("m", vec![primitive]);
    gltf.root_node(json!({"mesh": 0}));
    for bytes in [gltf.glb(), gltf.with_data_uri()] {
        let start = std::time::Instant::now();
        assert_eq!(import_bytes("x", &bytes).unwrap().triangles().len(), 1_000_000);
        eprintln!(
            "1000000 triangles, {} MB read in {:?}",
            bytes.len() >> 20,
            start.elapsed()
        );
    }
}

fn write(folder: &Path, name: &str, bytes: &[u8]) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn buffers_in_other_files() {
    let mesh = shapes::cube(1.0);
    let gltf = Gltf::of(&mesh);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["plain.bin", "sub/deep.bin", "a b\u{e9}.bin"] {
        write(folder.path(), name, &gltf.bin);
    }
    for uri in [
        "plain.bin",
        "./plain.bin",
        "sub/deep.bin",
        "sub/../plain.bin",
        "a%20b%C3%a9.bin",
        "a b\u{e9}.bin",
        "sub/a/../.././plain.bin",
    ] {
        write(folder.path(), "x.gltf", &gltf.with_uri(uri));
        let Imported::Mesh { mesh: read, .. } = import_file(at("x.gltf")).unwrap() else {
            panic!("{uri}")
        };
        assert_eq!(read, mesh);
    }
    for (uri, expected) in [
        ("missing.bin", "missing.bin"),
        ("sub", "it is a folder"),
        ("", "is not the path of a file"),
        ("..", "is not the path of a file"),
        ("/etc/passwd", "is not a relative path"),
        ("%2fetc/passwd", "is not a relative path"),
        ("file:///etc/passwd", "is not a relative path"),
        ("https://example.com/a.bin", "is not a relative path"),
        ("c:\\a.bin", "is not a relative path"),
        ("a%zz.bin", "is not a URI"),
        ("a%", "is not a URI"),
        ("a%ff", "is not a URI"),
        ("data:,abc", "not in base64"),
        ("data:;base64", "no comma"),
        ("data:;base64,!!!", "damaged base64"),
        ("DATA:;base64,AAAA", "buffer 0: it has 3 of its"),
    ] {
        write(folder.path(), "x.gltf", &gltf.with_uri(uri));
        let message = import_file(at("x.gltf")).unwrap_err().to_string();
        assert!(
            message.contains("x.gltf") && message.contains(expected),
            "{uri}: {message}"
        );
    }
    write(folder.path(), "x.gltf", &gltf.with_uri("plain.bin"));
    write(folder.path(), "plain.bin", &gltf.bin[..40]);
    let message = import_file(at("x.gltf")).unwrap_err().to_string();
    assert!(message.contains("x.gltf: buffer 0: it has 40 of its"), "{message}");
}

#[test]
fn the_hash_covers_files_and_part() {
    let gltf = Gltf::of(&shapes::cube(1.0));
    let folder = tempfile::tempdir().unwrap();
    let hash = |uri: &str, recipe: &str| {
        write(folder.path(), "x.gltf", &gltf.with_uri(uri));
        write(folder.path(), "x.bake.ron", recipe.as_bytes());
        match import_file(folder.path().join("x.bake.ron")).unwrap() {
            Imported::Mesh { source_hash, .. } => source_hash,
            Imported::Baked { .. } => panic!("not baked"),
        }
    };
    write(folder.path(), "a.bin", &gltf.bin);
    let plain = "(mesh: \"x.gltf\")";
    let first = hash("a.bin", plain);
    assert_eq!(hash("a.bin", plain), first);
    assert_ne!(hash("a.bin", "(mesh: \"x.gltf\", part: (mesh: 0))"), first);
    let mut changed = gltf.bin.clone();
    changed[0] ^= 1;
    write(folder.path(), "a.bin", &changed);
    assert_ne!(hash("a.bin", plain), first);
}
