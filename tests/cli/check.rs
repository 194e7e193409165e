//! `faceoff check`.

use crate::Folder;
use bevy_faceoff::asset::{CollisionMesh, format};
use bevy_faceoff::geometry::shapes;
use serde_json::{Value, json};

/// A folder with a cube, a torus and a scene of these bodies.
fn scene(bodies: &str) -> Folder {
    let folder = Folder::new();
    folder.asset("cube.obj");
    folder.asset("torus.obj");
    folder.write("scene.ron", with_meshes(bodies));
    folder
}

fn with_meshes(bodies: &str) -> String {
    format!("(meshes: {{\"cube\": \"cube.obj\", \"torus\": \"torus.obj\"}}, bodies: [{bodies}])")
}

#[track_caller]
fn pairs(folder: &Folder, options: &[&str]) -> Value {
    let run = folder.run(&[&["check", "scene.ron", "--json", "-"], options].concat());
    assert!(run.success, "{}", run.stderr);
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(report.as_object().unwrap().len(), 1, "only `pairs`");
    report["pairs"].clone()
}

const THREE: &str = r#"
    (mesh: "cube", translation: (5.0, 0.0, 0.0)),
    (mesh: "cube", translation: (0.0, 0.0, 0.0), rotation: (0.0, 0.0, 0.3826834, 0.9238795), scale: (1.0, 1.0, 1.0)),
    (mesh: "cube", translation: (0.9, 0.1, 0.2)),
"#;

#[test]
fn touching_pairs_are_listed_with_the_promised_fields() {
    let pairs = pairs(&scene(THREE), &[]);
    assert_eq!(pairs.as_array().unwrap().len(), 1);
    let pair = pairs[0].as_object().unwrap();
    assert_eq!(pair.len(), 4);
    assert_eq!(
        (&pair["a"], &pair["b"], &pair["contained"]),
        (&json!(1), &json!(2), &json!(false))
    );
    assert!(pair["triangle_pairs"].as_u64().unwrap() > 0);
}

#[test]
fn faces_are_listed_when_asked_and_counted_without() {
    let folder = scene(THREE);
    let (with, without) = (pairs(&folder, &["--faces"]), pairs(&folder, &[]));
    let faces = with[0]["faces"].as_array().unwrap();
    assert_eq!(with[0].as_object().unwrap().len(), 5);
    assert_eq!(with[0]["triangle_pairs"], faces.len());
    assert_eq!(without[0]["triangle_pairs"], faces.len());
    for face in faces {
        let [a, b] = [&face[0], &face[1]].map(|f| f.as_u64().unwrap());
        assert!(a < 12 && b < 12 && face.as_array().unwrap().len() == 2);
    }
    let table = folder.good(&["check", "scene.ron", "--faces"]);
    assert!(table.starts_with("3 bodies, 1 touching pairs"), "{table}");
    assert_eq!(table.lines().count(), 2 + faces.len());
}

#[test]
fn faces_count_fan_triangles_in_file_order_before_any_is_dropped() {
    // Triangle 0 has no area, 1 and 2 are a quad far away, 3 and 4 one that the needle hits in 4 alone.
    let folder = Folder::new();
    folder.write(
        "sheet.obj",
        "v 0 0 0\nv 0 0 0\nv 1 0 0\nf 1 2 3\no far\nv 90 0 0\nv 91 0 0\nv 91 1 0\nv 90 1 0\nf 4 5 6 7\n\
         o near\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 8 9 10 11\n",
    );
    folder.write("needle.obj", "v 0 0 -1\nv 0.1 0 -1\nv 0 0 1\nf 1 2 3\n");
    folder.write(
        "scene.ron",
        r#"(meshes: {"sheet": "sheet.obj", "needle": "needle.obj"},
            bodies: [(mesh: "sheet"), (mesh: "needle", translation: (1.0, 3.0, 0.0))])"#,
    );
    let pairs = pairs(&folder, &["--faces"]);
    assert_eq!(
        pairs,
        json!([{"a": 0, "b": 1, "triangle_pairs": 1, "contained": false, "faces": [[4, 0]]}])
    );
}

#[test]
fn one_body_inside_another_is_contained() {
    let folder =
        scene(r#"(mesh: "torus", scale: (0.5, 0.5, 0.5)), (mesh: "cube"), (mesh: "cube", scale: (3.0, 3.0, 3.0))"#);
    let pairs = pairs(&folder, &["--faces"]);
    let list = pairs.as_array().unwrap();
    assert_eq!(list.len(), 3);
    for pair in list {
        assert!(pair["a"].as_u64() < pair["b"].as_u64());
        assert_eq!(pair["contained"], true);
        assert_eq!((&pair["triangle_pairs"], &pair["faces"]), (&json!(0), &json!([])));
    }
    assert!(folder.good(&["check", "scene.ron"]).contains("one inside the other"));
}

#[test]
fn pose_fields_that_are_left_out_are_the_identity() {
    let short = pairs(
        &scene(r#"(mesh: "cube"), (mesh: "cube", translation: (0.5, 0.2, 0.1))"#),
        &["--faces"],
    );
    let long = pairs(
        &scene(
            r#"(mesh: "cube", translation: (0.0, 0.0, 0.0), rotation: (0.0, 0.0, 0.0, 1.0), scale: (1.0, 1.0, 1.0)),
               (mesh: "cube", translation: (0.5, 0.2, 0.1), rotation: (0.0, 0.0, 0.0, 5.0), scale: (1.0, 1.0, 1.0))"#,
        ),
        &["--faces"],
    );
    assert_eq!(short, long);
    assert!(short[0]["triangle_pairs"].as_u64().unwrap() > 0);
}

#[test]
fn scenes_without_pairs_give_an_empty_list() {
    for bodies in [
        "",
        r#"(mesh: "cube")"#,
        r#"(mesh: "cube"), (mesh: "torus", translation: (9.0, 0.0, 0.0))"#,
    ] {
        let folder = scene(bodies);
        assert_eq!(pairs(&folder, &["--faces"]), json!([]));
        assert!(folder.good(&["check", "scene.ron"]).contains("0 touching pairs"));
    }
    let folder = Folder::new();
    folder.write("scene.ron", "(meshes: {}, bodies: [])");
    assert_eq!(pairs(&folder, &[]), json!([]));
}

#[test]
fn json_goes_to_a_file_and_the_table_to_standard_output() {
    let folder = scene(THREE);
    let table = folder.good(&["check", "scene.ron", "--json", "pairs.json"]);
    assert!(table.contains("1 touching pairs"));
    let report: Value = serde_json::from_slice(&folder.read("pairs.json")).unwrap();
    assert_eq!(report["pairs"], pairs(&folder, &[]));
    folder.bad(
        &["check", "scene.ron", "--json", "none/pairs.json"],
        &["none/pairs.json"],
    );
}

#[test]
fn paths_are_relative_to_the_scene_and_all_kinds_of_meshes_are_read() {
    let folder = Folder::new();
    folder.write(
        "meshes/torus.faceoff",
        format::to_bytes(&CollisionMesh::new(&shapes::torus_240()), [0; 32]),
    );
    folder.write("meshes/recipe.bake.ron", "(mesh: \"raw/cube.obj\")");
    folder.asset("cube.obj");
    folder.write("meshes/raw/cube.obj", folder.read("cube.obj"));
    folder.write(
        "scenes/scene.ron",
        r#"(meshes: {"t": "../meshes/torus.faceoff", "c": "../meshes/recipe.bake.ron"},
            bodies: [(mesh: "t"), (mesh: "c", translation: (0.5, 0.0, 0.0))])"#,
    );
    let table = folder.good(&["check", "scenes/scene.ron"]);
    assert!(table.contains("2 bodies, 1 touching pairs"), "{table}");
}

#[test]
fn bodies_that_cannot_be_placed_are_named_by_number() {
    for (body, reason) in [
        ("translation: (NaN, 0.0, 0.0)", "not finite"),
        ("translation: (0.0, inf, 0.0)", "not finite"),
        ("rotation: (0.0, NaN, 0.0, 1.0)", "not finite"),
        ("rotation: (0.0, 0.0, 0.0, 0.0)", "zero quaternion"),
        ("scale: (1.0, 0.0, 1.0)", "scale"),
        ("scale: (0.0, 0.0, 0.0)", "scale"),
        ("translation: (1e30, 0.0, 0.0)", "from the origin"),
    ] {
        let folder = scene(&format!(r#"(mesh: "cube"), (mesh: "cube", {body})"#));
        folder.bad(&["check", "scene.ron"], &["scene.ron", "body 1", reason]);
    }
}

#[test]
fn scenes_that_cannot_be_read_are_named_with_the_place() {
    let cube = r#"(mesh: "cube", translation: (0.0, 0.0, 0.0))"#;
    let whole = with_meshes(cube);
    let deep = format!("(meshes: {}", "[".repeat(100_000));
    for text in [
        "",
        "}",
        "nonsense",
        "(bodies: [])",
        "(meshes: {})",
        "(meshes: {}, bodies: [], lights: [])",
        &with_meshes(r#"(mesh: "cube", colour: "red")"#),
        &with_meshes("(translation: (0.0, 0.0, 0.0))"),
        &with_meshes(r#"(mesh: "cube", translation: (0.0, 0.0))"#),
        &with_meshes(r#"(mesh: "cube", scale: "large")"#),
        &deep,
        &whole[..whole.len() / 2],
        &whole[..whole.len() - 1],
    ] {
        let folder = scene("");
        folder.write("scene.ron", text);
        folder.bad(&["check", "scene.ron"], &["scene.ron:", "check --help"]);
    }
    let folder = scene("");
    folder.write("scene.ron", b"(meshes: \xff\xfe)");
    folder.bad(&["check", "scene.ron"], &["scene.ron"]);
    folder.bad(&["check", "missing.ron"], &["missing.ron"]);
    folder.bad(&["check", "."], &["cannot read ."]);
}

#[test]
fn meshes_that_are_unknown_missing_or_broken_are_named() {
    let folder = scene(r#"(mesh: "cube"), (mesh: "sphere")"#);
    folder.bad(
        &["check", "scene.ron"],
        &["scene.ron", "body 1", "\"sphere\"", "cube, torus"],
    );
    folder.write("broken.obj", "v 1 2\n");
    for file in ["gone.obj", "broken.obj", "lost.bake.ron", "picture.png"] {
        folder.write("scene.ron", format!("(meshes: {{\"m\": \"{file}\"}}, bodies: [])"));
        folder.bad(&["check", "scene.ron"], &[file]);
    }
}

#[test]
fn a_mesh_name_that_stands_twice_is_refused() {
    let folder = scene("");
    folder.write(
        "scene.ron",
        r#"(meshes: {"a": "cube.obj", "b": "cube.obj", "a": "torus.obj"}, bodies: [(mesh: "a")])"#,
    );
    folder.bad(&["check", "scene.ron"], &["scene.ron:1:", "\"a\" twice"]);
}

/// Torus in torus has 3120 pairs of faces: a check that keeps them all until the end takes 700 MB here.
#[test]
#[cfg(target_os = "linux")]
fn faces_that_nobody_asked_for_are_not_kept() {
    let folder = scene(&r#"(mesh: "torus"), "#.repeat(80));
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_faceoff"))
        .args(["check", "scene.ron"])
        .current_dir(folder.path("."))
        .stdout(std::fs::File::create(folder.path("said")).unwrap())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let peak = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = peak.and_then(|peak| peak.split_whitespace().next()?.parse().ok());
        most = most.max(kib.unwrap_or(0));
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let said = String::from_utf8(folder.read("said")).unwrap();
    assert!(said.starts_with("80 bodies, 3160 touching pairs\n"), "{said}");
    assert!((1..400_000).contains(&most), "{most} KiB");
}

#[test]
fn a_scene_may_begin_with_a_byte_order_mark() {
    let folder = scene(THREE);
    let usual = pairs(&folder, &[]);
    folder.write("scene.ron", format!("\u{feff}{}", with_meshes(THREE)));
    assert_eq!(pairs(&folder, &[]), usual);
}
