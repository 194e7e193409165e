//! glTF files that are wrong, by accident or on purpose: errors that say where, no panic, no absurd allocation.

use crate::gltf_files::*;
use bevy_faceoff::asset::{MeshPart, import_bytes, import_part};
use bevy_faceoff::geometry::shapes;
use proptest::prelude::*;
use serde_json::{Value, json};

fn cube() -> Gltf {
    Gltf::of(&shapes::cube(1.0))
}

fn message(gltf: &Gltf) -> String {
    import_bytes("x.glb", &gltf.glb()).unwrap_err().to_string()
}

#[track_caller]
fn refused(change: impl FnOnce(&mut Value), expected: &str) {
    let mut gltf = cube();
    change(&mut gltf.json);
    let message = message(&gltf);
    assert!(message.contains(expected), "{message}");
    assert!(message.len() < 500, "{message}");
}

#[test]
fn every_field_may_be_wrong() {
    let here = "mesh 0 \"First\", primitive 0";
    refused(|j| j["asset"]["version"] = json!("1.0"), "glTF \"1.0\"");
    refused(|j| j["asset"]["minVersion"] = json!("3.0"), "glTF \"3.0\"");
    refused(|j| j["asset"] = json!({}), "missing field `version`");
    refused(|j| j["scene"] = json!(7), "scene 7: it does not exist");
    refused(|j| j["scenes"][0]["nodes"] = json!([7]), "node 7: it does not exist");
    refused(|j| j["scenes"][0]["nodes"] = json!([0, 0]), "node 0: it occurs twice");
    refused(|j| j["scenes"][0]["nodes"] = json!([]), "no triangles in the scene");
    refused(|j| j["nodes"][0]["children"] = json!([0]), "node 0: it occurs twice");
    refused(|j| j["nodes"][0]["mesh"] = json!(1), "node 0: its mesh does not exist");
    refused(|j| j["nodes"][0]["mesh"] = json!(-1), "invalid value: integer `-1`");
    refused(
        |j| j["nodes"][0]["mesh"] = json!(1u64 << 32),
        "node 0: its mesh does not exist",
    );
    refused(
        |j| j["nodes"][0]["rotation"] = json!([0, 0, 0, 0]),
        "node 0: its rotation",
    );
    refused(|j| j["nodes"][0]["rotation"] = json!([1, 0, 0]), "line 1");
    refused(
        |j| j["nodes"][0]["scale"] = json!([1e300, 1, 1]),
        "node 0: its transform",
    );
    refused(|j| j["nodes"][0]["scale"] = json!([1e20, 1, 1]), "larger unit");
    refused(|j| j["nodes"][0]["scale"] = json!([0, 0, 0]), "degenerate");
    refused(
        |j| j["meshes"][0]["primitives"][0]["mode"] = json!(7),
        &format!("{here}: its mode"),
    );
    refused(
        |j| j["meshes"][0]["primitives"][0]["attributes"] = json!({}),
        &format!("{here}: it has no POSITION"),
    );
    refused(
        |j| j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(99),
        &format!("{here}, accessor 99: it does not exist, there are 2"),
    );
    refused(
        |j| j["meshes"][0]["primitives"][0]["indices"] = json!(0),
        &format!("{here}, accessor 0: indices must be"),
    );
    refused(
        |j| j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(1),
        &format!("{here}, accessor 1: positions must be"),
    );
    refused(
        |j| j["accessors"][0]["componentType"] = json!(5124),
        &format!("{here}, accessor 0: there is no component"),
    );
    refused(
        |j| j["accessors"][0]["componentType"] = json!(U32),
        "accessor 0: positions must be",
    );
    refused(
        |j| j["accessors"][0]["bufferView"] = json!(9),
        "accessor 0: its buffer view 9 does not exist",
    );
    refused(
        |j| j["accessors"][0]["bufferView"] = json!(null),
        "neither a buffer view nor sparse values",
    );
    refused(
        |j| j["accessors"][0]["byteOffset"] = json!(4),
        "do not fit the 96 bytes of buffer view 0",
    );
    refused(
        |j| j["accessors"][0]["count"] = json!(7),
        "is 7, but there are 7 positions",
    );
    refused(
        |j| j["accessors"][1]["count"] = json!(35),
        "its 35 corners do not make whole triangles",
    );
    refused(|j| j["accessors"][1]["count"] = json!(0), "no triangles");
    refused(|j| j["accessors"][0]["count"] = json!(0), "there are 0 positions");
    refused(
        |j| j["bufferViews"][0]["buffer"] = json!(3),
        "is in buffer 3, but there are 1",
    );
    refused(
        |j| j["bufferViews"][0]["byteOffset"] = json!(u64::MAX),
        "buffer view 0 has 96 bytes from",
    );
    refused(
        |j| j["bufferViews"][0]["byteLength"] = json!(u64::MAX),
        "buffer view 0 has",
    );
    refused(
        |j| j["bufferViews"][0]["byteStride"] = json!(3),
        "12 bytes, but its stride is 3 bytes",
    );
    refused(|j| j["bufferViews"][0]["byteStride"] = json!(u64::MAX), "do not fit");
    refused(|j| j["buffers"] = json!([]), "there are 0");
    refused(
        |j| j["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
        "\"KHR_draco_mesh_compression\"",
    );
    refused(
        |j| j["extensionsRequired"] = json!(["EXT_meshopt_compression"]),
        "\"EXT_meshopt_compression\"",
    );
    refused(
        |j| j["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]),
        "\"EXT_mesh_gpu_instancing\"",
    );
    refused(
        |j| {
            j["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {"bufferView": 0}});
            j["accessors"][0]["bufferView"] = json!(null);
        },
        &format!("{here}: it is compressed with Draco"),
    );
    refused(
        |j| {
            j["buffers"].as_array_mut().unwrap().push(json!({"byteLength": 1000}));
            j["bufferViews"][1]["buffer"] = json!(1);
        },
        "accessor 1: buffer view 1 is in buffer 1, which has no data",
    );
    refused(|j| j["nodes"] = json!({}), "line 1");
    refused(|j| *j = json!(7), "line 1");
}

#[test]
fn positions_that_are_not_finite() {
    for wrong in [f32::NAN, f32::INFINITY] {
        let mut gltf = cube();
        gltf.bin[40..44].copy_from_slice(&wrong.to_le_bytes());
        assert!(
            message(&gltf).contains("accessor 0: position 3 is not finite"),
            "{}",
            message(&gltf)
        );
    }
}

#[test]
fn huge_counts_allocate_nothing() {
    for count in [1u64 << 20, 1 << 40, u64::MAX] {
        for accessor in [0, 1] {
            refused(|j| j["accessors"][accessor]["count"] = json!(count), "do not fit");
            refused(
                |j| {
                    j["accessors"][accessor]["count"] = json!(count);
                    j["accessors"][accessor]["bufferView"] = json!(null);
                },
                "but no buffer view",
            );
            refused(
                |j| {
                    j["accessors"][accessor]["sparse"] = json!({
                        "count": count,
                        "indices": {"bufferView": 1, "componentType": U16},
                        "values": {"bufferView": 0},
                    });
                },
                "sparse values",
            );
        }
    }
    refused(
        |j| {
            j["accessors"][0]["sparse"] = json!({
                "count": 1, "indices": {"bufferView": 0, "componentType": U8, "byteOffset": 3}, "values": {"bufferView": 0},
            });
        },
        "a sparse value has index",
    );
}

#[test]
fn instances_do_not_multiply_without_end() {
    // A kilobyte of nodes that would double at every level.
    let mut gltf = cube();
    gltf.json["nodes"] = (0..64).map(|i| json!({"children": [i + 1, i + 1]})).collect();
    gltf.node(json!({"mesh": 0}));
    assert!(message(&gltf).contains("it occurs twice"));
    // Nodes in a ring.
    gltf.json["nodes"] = (0..64).map(|i| json!({"children": [(i + 1) % 64]})).collect();
    assert!(message(&gltf).contains("node 0: it occurs twice"));
    // A hundred thousand nodes below each other are no trouble.
    let mut gltf = cube();
    gltf.json["nodes"] = (0..100_000).map(|i| json!({"children": [i + 1]})).collect();
    gltf.node(json!({"mesh": 0}));
    assert_eq!(import_bytes("x.glb", &gltf.glb()).unwrap().triangles().len(), 12);
    // A large mesh in many nodes, and in many primitives.
    let mesh = shapes::torus(200, 100, 1.0, 0.3);
    let mut gltf = Gltf::of(&mesh);
    for _ in 0..1000 {
        gltf.root_node(json!({"mesh": 0}));
    }
    assert!(
        message(&gltf).contains("repeats its meshes to more than"),
        "{}",
        message(&gltf)
    );
    let mut gltf = Gltf::of(&mesh);
    let primitive = gltf.json["meshes"][0]["primitives"][0].clone();
    gltf.json["meshes"][0]["primitives"] = vec![primitive; 1000].into();
    assert!(message(&gltf).contains("repeats its meshes to more than"));
    // A few are allowed.
    let mut gltf = Gltf::of(&mesh);
    gltf.root_node(json!({"mesh": 0}));
    assert_eq!(import_bytes("x.glb", &gltf.glb()).unwrap().triangles().len(), 80_000);
}

#[test]
fn containers_are_checked() {
    let glb = cube().glb();
    let message = |bytes: &[u8]| import_bytes("x.glb", bytes).unwrap_err().to_string();
    for (at, word, expected) in [
        (4, 1u32, "glTF \"1\""),
        (8, 0, "first chunk is not JSON"),
        (8, u32::MAX, "cut off"),
        (12, u32::MAX, "longer than the file"),
        (12, 0, "longer than the file"),
        (16, 0, "first chunk is not JSON"),
    ] {
        let mut bytes = glb.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        assert!(message(&bytes).contains(expected), "{at}: {}", message(&bytes));
    }
    assert!(message(b"").contains("EOF"));
    assert!(message(b"{\n\"asset\": 7}").contains("line 2, column"));
    assert!(message(&b"[".repeat(100_000)).contains("line 1"));
    let deep = format!("{{\"extras\": {}", "{\"a\":".repeat(100_000));
    assert!(message(deep.as_bytes()).contains("line 1"));
    assert!(message(&glb_without_chunk()).contains("which has no data"));
}

fn glb_without_chunk() -> Vec<u8> {
    glb(cube().json.to_string().as_bytes(), None)
}

#[test]
fn every_truncation_is_an_error() {
    let gltf = cube();
    for whole in [gltf.glb(), gltf.with_data_uri()] {
        for length in 0..whole.len() {
            assert!(
                import_bytes("x.glb", &whole[..length]).is_err(),
                "{length} of {}",
                whole.len()
            );
        }
        assert!(import_bytes("x.glb", &whole).is_ok());
    }
}

#[test]
fn changed_bits_do_not_panic() {
    let mut gltf = cube();
    gltf.json["accessors"][0]["sparse"] = json!({
        "count": 2, "indices": {"bufferView": 1, "componentType": U16}, "values": {"bufferView": 0},
    });
    let part: MeshPart = "First".into();
    for whole in [gltf.glb(), gltf.with_data_uri()] {
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.clone();
                bytes[at] ^= 1 << bit;
                let _ = import_bytes("x", &bytes);
                let _ = import_part("x.glb", &bytes, Some(&part));
            }
        }
    }
}

/// Numbers that are likely to hurt.
fn number() -> impl Strategy<Value = Value> {
    prop_oneof![
        (0u64..10).prop_map(|n| json!(n)),
        prop_oneof![
            Just(u64::MAX),
            Just(1 << 63),
            Just(1 << 32),
            Just(u64::from(u32::MAX)),
            Just(95),
            Just(97)
        ]
        .prop_map(|n| json!(n)),
        (5119u32..5128).prop_map(|n| json!(n)),
        Just(json!(-1)),
        Just(json!(1e308)),
        Just(json!(null)),
        Just(json!([])),
        Just(json!([0, 0])),
        Just(json!({})),
    ]
}

/// Some value of a document by its place in it.
fn value_at(json: &mut Value, place: usize) -> Option<&mut Value> {
    fn walk<'a>(json: &'a mut Value, left: &mut usize) -> Option<&'a mut Value> {
        if *left == 0 {
            return Some(json);
        }
        *left -= 1;
        match json {
            Value::Array(items) => items.iter_mut().find_map(|v| walk(v, left)),
            Value::Object(items) => items.values_mut().find_map(|v| walk(v, left)),
            _ => None,
        }
    }
    walk(json, &mut { place })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 2000, ..Default::default() })]

    #[test]
    fn no_document_panics(changes in proptest::collection::vec((0usize..110, number()), 1..4)) {
        let mut gltf = cube();
        gltf.json["accessors"][0]["sparse"] = json!({
            "count": 1, "indices": {"bufferView": 1, "componentType": U16}, "values": {"bufferView": 0},
        });
        gltf.fit();
        for (place, number) in changes {
            if let Some(value) = value_at(&mut gltf.json, place) {
                *value = number;
            }
        }
        let json = gltf.json.to_string();
        let _ = import_bytes("x.glb", &glb(json.as_bytes(), Some(&gltf.bin)));
        let _ = import_part("x.glb", &glb(json.as_bytes(), Some(&gltf.bin)), Some(&0.into()));
    }

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = import_bytes("x.glb", &bytes);
        let _ = import_bytes("x.glb", &[b"glTF\x02\0\0\0".as_slice(), &bytes].concat());
    }
}
