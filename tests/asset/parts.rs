//! Parts of OBJ and glTF files, chosen by name.

use crate::gltf_files::*;
use bevy_faceoff::asset::{ImportError, Imported, MeshPart, Recipe, import_bytes, import_file, import_part, to_obj};
use bevy_faceoff::geometry::{TriMesh, shapes};
use glam::Vec3;
use serde_json::json;

fn object(name: &str) -> MeshPart {
    MeshPart::Object(name.into())
}

fn group(name: &str) -> MeshPart {
    MeshPart::Group(name.into())
}

fn obj(text: &str, part: &MeshPart) -> Result<TriMesh, ImportError> {
    import_part("x.obj", text.as_bytes(), Some(part))
}

/// Four vertices, so that faces can be told apart by their corners.
const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
/// The places of these vertices, in the order of the file.
const PLACES: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];

/// The faces as numbers of the four vertices, counted from 1.
#[track_caller]
fn faces(text: &str, part: &MeshPart) -> Vec<[usize; 3]> {
    let mesh = obj(&format!("{VERTICES}{text}"), part).unwrap();
    let number = |corner: Vec3| 1 + PLACES.iter().position(|place| *place == corner).unwrap();
    (0..mesh.triangles().len())
        .map(|t| mesh.corners(t).map(number))
        .collect()
}

#[test]
fn an_object_has_the_faces_between_its_line_and_the_next_one() {
    let text = "f 1 2 3\no Wheel\ng rim\nf 1 2 4\nf 1 3 2 4\no Car body \nf 2 3 4\no Wheel\nusemtl a\nf 4 3 2\n";
    assert_eq!(
        faces(text, &object("Wheel")),
        [[1, 2, 4], [1, 3, 2], [1, 2, 4], [4, 3, 2]]
    );
    // Spaces belong to a name, but how many there are does not matter.
    assert_eq!(faces(text, &object("Car body")), [[2, 3, 4]]);
    assert_eq!(faces(text, &object(" Car  body ")), [[2, 3, 4]]);
    assert_eq!(
        faces("o Wheel#2 # the second\nf 1 2 3", &object("Wheel#2")),
        [[1, 2, 3]]
    );
    assert_eq!(faces("o Caf\u{e9}\r\nf 1 2 3\r\n", &object("Caf\u{e9}")), [[1, 2, 3]]);
    assert_eq!(faces("o a \\\nb\nf 1 2 3", &object("a b")), [[1, 2, 3]]);
}

#[test]
fn a_face_may_be_in_several_groups_or_in_none() {
    let text = "f 1 2 3\no x\ng rim tyre\nf 1 2 4\no y\nf 1 3 4\ng tyre\nf 2 3 4\ng\nf 4 3 2\ng the tyre\nf 3 2 1\n";
    assert_eq!(faces(text, &group("rim")), [[1, 2, 4], [1, 3, 4]]);
    assert_eq!(
        faces(text, &group("tyre")),
        [[1, 2, 4], [1, 3, 4], [2, 3, 4], [3, 2, 1]]
    );
    assert_eq!(faces(text, &group("the tyre")), [[3, 2, 1]]);
    assert_eq!(faces(text, &group("default")), [[1, 2, 3], [4, 3, 2]]);
    assert_eq!(faces("g default\nf 1 2 3", &group("default")), [[1, 2, 3]]);
}

#[test]
fn a_part_has_its_own_vertices_and_face_ids() {
    let (cube, ball) = (shapes::cube(1.0), shapes::ball(1.0, 1));
    let mut text = format!("o cube\n{}o ball\n", to_obj(&cube));
    // Indices that count back.
    let back = ball.vertices().len() as i64;
    for line in to_obj(&ball).lines() {
        match line.strip_prefix("f ") {
            None => text += &format!("{line}\n"),
            Some(corners) => {
                let corners: Vec<String> = corners
                    .split(' ')
                    .map(|corner| (corner.parse::<i64>().unwrap() - 1 - back).to_string())
                    .collect();
                text += &format!("f {}\n", corners.join(" "));
            }
        }
    }
    assert_eq!(obj(&text, &object("cube")).unwrap(), cube);
    assert_eq!(obj(&text, &object("ball")).unwrap(), ball);
    let both = import_bytes("x.obj", text.as_bytes()).unwrap();
    assert_eq!(both.triangles().len(), 12 + ball.triangles().len());
    // A degenerate face keeps its number in the part.
    let text = format!("{VERTICES}f 1 2 3\no x\nf 1 1 2\nf 1 2 4\n");
    assert_eq!(obj(&text, &object("x")).unwrap().face_ids(), [1]);
}

#[test]
fn errors_name_the_parts_that_there_are() {
    let message = |text: &str, part: MeshPart| obj(text, &part).unwrap_err().to_string();
    let two = format!("{VERTICES}o Wheel\ng rim tyre\nf 1 2 3\no Empty\no Wheel\n");
    assert_eq!(
        message(&two, object("wheel")),
        "the file has no object \"wheel\"; it has \"Wheel\", \"Empty\""
    );
    assert_eq!(
        message(&two, group("x")),
        "the file has no group \"x\"; it has \"rim\", \"tyre\""
    );
    assert!(message(&two, object("Empty")).starts_with("the object \"Empty\" has no faces"));
    assert!(message(VERTICES, object("x")).contains("it has none with a name"));
    // Faces of other parts are checked as well.
    let other = format!("{VERTICES}o a\nf 1 2 3\no b\nf 1 2 9\n");
    assert!(message(&other, object("a")).contains("a face names vertex 9"));
    // However many there are, and however long they are.
    let many: String = (0..100_000).map(|i| format!("o {i}{}\n", "x".repeat(i % 90))).collect();
    let message_of_many = message(&many, object(&"y".repeat(10_000)));
    assert!(message_of_many.len() < 2000 && message_of_many.ends_with("..."));

    let message =
        |name: &str, bytes: &[u8], part: MeshPart| import_part(name, bytes, Some(&part)).unwrap_err().to_string();
    let glb = Gltf::of(&shapes::cube(1.0)).glb();
    assert!(message("x.glb", &glb, object("First")).contains("a glTF file has no object to choose; choose a mesh or"));
    assert!(message("x.obj", two.as_bytes(), "Wheel".into()).contains("an OBJ file has no mesh to choose"));
    assert!(message("x.off", b"OFF\n", object("x")).contains("only glTF and OBJ files have parts"));
}

/// A cube in a node `Arm` that is placed, turned and scaled, and one in a node `Hand` below it.
fn arm() -> Gltf {
    let mut gltf = Gltf::new();
    let primitive = gltf.primitive(&shapes::cube(1.0), U16);
    gltf.mesh("Cube.003", vec![primitive]);
    let finger = gltf.node(json!({"mesh": 0, "translation": [0, 0, 1], "name": "Finger"}));
    let hand = gltf
        .node(json!({"mesh": 0, "translation": [5, 0, 0], "scale": [1, 2, 1], "name": "Hand", "children": [finger]}));
    let arm = json!({"mesh": 0, "name": "Arm", "children": [hand], "translation": [0, 9, 0], "scale": [3, 3, 3],
        "rotation": [0, 0, 0.6, 0.8]});
    let arm = gltf.node(arm);
    gltf.root_node(json!({"name": "Root", "translation": [100, 0, 0], "children": [arm]}));
    gltf.node(json!({"name": "Lamp"}));
    gltf.node(json!({"name": "In no scene", "mesh": 0, "scale": [-1, 1, 1]}));
    gltf
}

#[test]
fn a_node_has_all_nodes_below_it_in_its_own_space() {
    let gltf = arm();
    let bytes = gltf.glb();
    let cube = shapes::cube(1.0);
    let node = |choice| import_part("x.glb", &bytes, Some(&MeshPart::Node(choice)));
    let arm = node("Arm".into()).unwrap();
    assert_eq!(arm.triangles().len(), 36);
    for t in 0..12 {
        let there = cube.corners(t);
        assert_eq!(arm.corners(t), there);
        assert_eq!(
            arm.corners(12 + t),
            there.map(|c| c * Vec3::new(1.0, 2.0, 1.0) + 5.0 * Vec3::X)
        );
        assert_eq!(
            arm.corners(24 + t),
            there.map(|c| (c + Vec3::Z) * Vec3::new(1.0, 2.0, 1.0) + 5.0 * Vec3::X)
        );
    }
    assert_eq!(arm.face_ids(), (0..36).collect::<Vec<u32>>());
    assert_eq!(node("Finger".into()).unwrap(), cube);
    // Its own mirror is not applied, so nothing is turned.
    assert_eq!(node("In no scene".into()).unwrap(), cube);
    assert_eq!(
        node(bevy_faceoff::asset::NameOrIndex::Index(2)).unwrap(),
        arm,
        "by index"
    );
    // Placed as the scene places the node, it is where the scene has it.
    let scene = import_bytes("x.glb", &bytes).unwrap();
    let place = glam::Affine3A::from_scale_rotation_translation(
        Vec3::splat(3.0),
        glam::Quat::from_xyzw(0.0, 0.0, 0.6, 0.8),
        Vec3::new(100.0, 9.0, 0.0),
    );
    for (placed, own) in scene.vertices().iter().zip(arm.vertices()) {
        assert!(placed.distance(place.transform_point3(*own)) < 1e-4);
    }

    let message = |choice| node(choice).unwrap_err().to_string();
    assert!(
        message("Elbow".into())
            .contains("there is no node \"Elbow\"; there are 6: 0 \"Finger\", 1 \"Hand\", 2 \"Arm\""),
        "{}",
        message("Elbow".into())
    );
    assert!(message("Lamp".into()).contains("no triangles in the chosen node"));
    let mut gltf = gltf;
    gltf.json["nodes"][0]["children"] = json!([2]);
    let error = import_part("x.glb", &gltf.glb(), Some(&MeshPart::Node("Hand".into()))).unwrap_err();
    assert!(error.to_string().contains("node 1: it occurs twice"), "{error}");
}

#[test]
fn each_kind_of_part_has_one_text() {
    for (text, part) in [
        ("(mesh: \"Gear\")", MeshPart::from("Gear")),
        ("(mesh: 3)", 3.into()),
        (
            "(mesh: \"Gear\", primitive: 2)",
            MeshPart::Mesh {
                mesh: "Gear".into(),
                primitive: Some(2),
            },
        ),
        ("(node: \"Arm \\\"1\\\"\")", MeshPart::Node("Arm \"1\"".into())),
        ("(node: 7)", MeshPart::Node(bevy_faceoff::asset::NameOrIndex::Index(7))),
        ("(object: \"Wheel\")", object("Wheel")),
        ("(group: \"\u{e9}\\n\")", group("\u{e9}\n")),
    ] {
        assert_eq!(part.to_string(), text);
        let recipe = Recipe::parse(format!("(mesh: \"a\", part: {text})").as_bytes()).unwrap();
        assert_eq!(recipe.part, Some(part.clone()));
        assert_eq!(Recipe::parse(recipe.to_text().as_bytes()).unwrap(), recipe);
        // As in a `.meta` file, where an option is written out.
        let written = ron::to_string(&part).unwrap();
        assert_eq!(ron::from_str::<MeshPart>(&written).unwrap(), part, "{written}");
        let json = serde_json::to_string(&part).unwrap();
        assert_eq!(serde_json::from_str::<MeshPart>(&json).unwrap(), part, "{json}");
    }
    let old: MeshPart = ron::from_str("(mesh: \"Cube\", primitive: Some(0))").unwrap();
    assert_eq!(old.to_string(), "(mesh: \"Cube\", primitive: 0)");
    for (part, expected) in [
        ("()", "a part is one mesh, node, object or group"),
        ("(object: \"a\", group: \"b\")", "a part is one"),
        ("(node: 0, primitive: 1)", "needs the mesh"),
        ("(primitive: 1)", "needs the mesh"),
        ("(nodes: 0)", "nodes"),
        ("(object: 3)", "line 1"),
    ] {
        let error = Recipe::parse(format!("(mesh: \"a\", part: {part})").as_bytes()).unwrap_err();
        assert!(error.to_string().contains(expected), "{part}: {error}");
    }
}

#[test]
fn recipes_choose_parts_and_the_hash_covers_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(
        at("x.obj"),
        format!("{VERTICES}o a\ng b\nf 1 2 3\no b\nf 1 2 4\nf 2 3 4\n"),
    )
    .unwrap();
    let read = |part: &str| {
        std::fs::write(at("x.bake.ron"), format!("(mesh: \"x.obj\"{part})")).unwrap();
        match import_file(at("x.bake.ron")).unwrap() {
            Imported::Mesh { mesh, source_hash, .. } => (mesh.triangles().len(), source_hash),
            Imported::Baked { .. } => panic!("not baked"),
        }
    };
    let all = [
        "",
        ", part: (object: \"a\")",
        ", part: (object: \"b\")",
        ", part: (group: \"b\")",
    ]
    .map(read);
    assert_eq!(all.map(|(triangles, _)| triangles), [3, 1, 2, 3]);
    for (i, (_, hash)) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|(_, other)| other != hash));
    }
    std::fs::write(at("x.bake.ron"), "(mesh: \"x.obj\", part: (object: \"c\"))").unwrap();
    let message = import_file(at("x.bake.ron")).unwrap_err().to_string();
    assert!(message.contains("x.obj: the file has no object \"c\""), "{message}");
}
