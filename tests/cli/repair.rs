//! `faceoff repair`.

use crate::Folder;
use bevy_faceoff::asset::{to_obj, to_stl};
use bevy_faceoff::geometry::{TriMesh, shapes};
use serde_json::Value;

/// A ball without some of its faces, the others wound in turn one way and the other.
fn broken_ball() -> TriMesh {
    let ball = shapes::ball(1.0, 3);
    let faces = ball.triangles().iter().enumerate().filter(|(t, _)| t % 20 != 7);
    let turned = faces.map(|(t, &[a, b, c])| if t % 3 == 0 { [a, c, b] } else { [a, b, c] });
    TriMesh::new(ball.vertices().to_vec(), turned.collect()).unwrap()
}

fn inspect(folder: &Folder, file: &str) -> Value {
    serde_json::from_str(&folder.good(&["inspect", file, "--json"])).unwrap()
}

/// The number of defects of a kind, in a part of the report.
fn count(state: &Value, kind: &str) -> u64 {
    let defects = state["defects"].as_array().unwrap().iter();
    let found = defects.clone().find(|defects| defects["kind"] == kind);
    found.map_or(0, |defects| defects["count"].as_u64().unwrap())
}

#[test]
fn the_json_tells_what_was_done_and_the_file_holds_it() {
    let folder = Folder::new();
    folder.write("ball.stl", to_stl(&broken_ball()));
    for output in ["new.obj", "new.stl", "new.PLY", "new.off"] {
        let table = folder.good(&[
            "repair",
            "ball.stl",
            "-o",
            output,
            "--close-holes",
            "12",
            "--json",
            "done.json",
        ]);
        let report: Value = serde_json::from_slice(&folder.read("done.json")).unwrap();
        let (before, after, done) = (&report["before"], &report["after"], &report["done"]);
        assert_eq!(
            (before["faces"].as_u64(), after["faces"].as_u64()),
            (Some(1216), Some(1280))
        );
        assert_eq!((&before["closed"], &after["closed"]), (&false.into(), &true.into()));
        assert_eq!(after["orientation"], "Outward");
        assert_eq!(
            (&before["volume"], &after["defects"]),
            (&Value::Null, &Value::Array(vec![]))
        );
        assert_eq!(
            (count(before, "BoundaryEdge"), count(before, "Opening") > 0),
            (192, true)
        );
        assert!(count(before, "Disagreement") > 100);
        assert_eq!(
            (&done["added_faces"], &done["left_holes"]),
            (&64.into(), &Value::Array(vec![]))
        );
        assert_eq!(report["steps"]["close_holes"], 12);
        for words in [
            "closed, outward",
            "boundary edges",
            "edges whose faces disagree",
            "64 faces",
        ] {
            assert!(table.contains(words), "{words:?} is not in {table}");
        }
        let read = inspect(&folder, output);
        assert_eq!((&read["closed"], &read["triangles"]), (&true.into(), &1280.into()));
        assert_eq!(
            (&read["defects"], &read["warnings"]),
            (&after["defects"], &Value::Array(vec![]))
        );
        let volume = read["volume"].as_f64().unwrap();
        assert!(
            (volume / 4.0 * 3.0 / std::f64::consts::PI - 1.0).abs() < 0.02,
            "{volume}"
        );
    }
}

#[test]
fn a_sound_mesh_keeps_its_bytes() {
    let folder = Folder::new();
    for mesh in ["torus.obj", "knot.obj", "cube.obj"] {
        folder.asset(mesh);
        folder.good(&["repair", mesh, "-o", "new.obj", "--close-holes", "99"]);
        assert_eq!(folder.read("new.obj"), folder.read(mesh), "{mesh}");
    }
    folder.write("ball.obj", to_obj(&broken_ball()));
    folder.good(&["repair", "ball.obj", "-o", "once.obj"]);
    folder.good(&["repair", "once.obj", "-o", "twice.obj"]);
    assert_ne!(folder.read("once.obj"), folder.read("ball.obj"));
    assert_eq!(folder.read("twice.obj"), folder.read("once.obj"));
}

#[test]
fn only_the_named_steps_run_and_what_is_left_is_told() {
    let folder = Folder::new();
    folder.write("ball.obj", to_obj(&broken_ball()));
    let steps = |arguments: &[&str]| -> Value {
        let all = [
            &["repair", "ball.obj", "-o", "new.obj", "--json", "done.json"],
            arguments,
        ]
        .concat();
        let table = folder.good(&all);
        assert!(table.contains("defects"), "{table}");
        serde_json::from_slice(&folder.read("done.json")).unwrap()
    };
    let safe = steps(&[]);
    for step in ["weld", "drop", "split", "orient"] {
        assert_eq!(safe["steps"][step], true, "{step}");
        let flag = format!("--{step}");
        let report = steps(&[&flag]);
        for other in ["weld", "drop", "split", "orient"] {
            assert_eq!(report["steps"][other], step == other, "{step}: {other}");
        }
    }
    assert_eq!(count(&safe["after"], "Disagreement"), 0);
    assert!(count(&steps(&["--drop"])["after"], "Disagreement") > 100);
    let long = steps(&["--close-holes", "2"]);
    assert_eq!(long["done"]["left_holes"][0]["why"], "too_long");
    let many = u64::MAX.to_string();
    assert_eq!(
        steps(&["--weld=0.001", "--close-holes", &many])["steps"]["close_holes"],
        u64::MAX
    );
    let tolerance = steps(&["--weld=0.001"])["steps"]["tolerance"].as_f64().unwrap();
    assert!((tolerance - 0.001).abs() < 1e-8);
}

#[test]
fn the_mesh_itself_is_overwritten_only_if_asked_for() {
    let folder = Folder::new();
    let broken = to_obj(&broken_ball());
    folder.write("ball.obj", &broken);
    folder.write(
        "ball.bake.ron",
        r#"(mesh: "ball.obj", settings: (weld_tolerance: 0.001))"#,
    );
    folder.write("deep/none", "");
    for output in ["ball.obj", "./ball.obj", "deep/../ball.obj"] {
        folder.bad(&["repair", "ball.obj", "-o", output], &[output, "--in-place"]);
        folder.bad(&["repair", "ball.bake.ron", "-o", output], &[output, "another name"]);
        folder.bad(
            &["repair", "ball.obj", "-o", "new.obj", "--json", output],
            &[output, "another name"],
        );
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("ball.obj", folder.path("link.obj")).unwrap();
        folder.bad(&["repair", "ball.obj", "-o", "link.obj"], &["link.obj", "--in-place"]);
        folder.bad(&["repair", "link.obj", "-o", "ball.obj"], &["ball.obj", "--in-place"]);
    }
    assert_eq!(folder.read("ball.obj"), broken.as_bytes());
    assert!(!folder.path("new.obj").exists());
    folder.bad(
        &["repair", "ball.bake.ron", "--in-place"],
        &["ball.bake.ron", "--output"],
    );

    // A recipe gives the mesh and its tolerance. Another file that is there is replaced.
    folder.write("new.obj", "something else");
    folder.good(&["repair", "ball.bake.ron", "-o", "new.obj", "--json", "done.json"]);
    let report: Value = serde_json::from_slice(&folder.read("done.json")).unwrap();
    assert!((report["steps"]["tolerance"].as_f64().unwrap() - 0.001).abs() < 1e-8);
    folder.good(&["repair", "ball.obj", "--in-place"]);
    assert_eq!(folder.read("ball.obj"), folder.read("new.obj"));
}

#[test]
fn a_baked_file_is_repaired_as_its_source() {
    let folder = Folder::new();
    folder.write("ball.obj", to_obj(&broken_ball()));
    let bake = folder.run(&["bake", "ball.obj", "-o", "."]);
    assert!(bake.success, "{}", bake.stderr);
    for step in ["--drop", "--orient"] {
        folder.good(&["repair", "ball.obj", "-o", "a.obj", step]);
        folder.good(&["repair", "ball.faceoff", "-o", "b.obj", step]);
        assert_eq!(folder.read("a.obj"), folder.read("b.obj"), "{step}");
    }
}

#[test]
fn the_mesh_goes_to_standard_output_as_obj() {
    let folder = Folder::new();
    folder.asset("torus.obj");
    let run = folder.run(&["repair", "torus.obj", "-o", "-"]);
    assert!(run.success);
    assert_eq!(run.stdout.as_bytes(), folder.read("torus.obj"));
    assert!(run.stderr.contains("torus.obj -> -"), "{}", run.stderr);
    folder.bad(&["repair", "torus.obj", "-o", "-", "--json", "-"], &["standard output"]);
    let run = folder.run(&["repair", "torus.obj", "-o", "new.obj", "--json", "-"]);
    assert!(run.success && run.stderr.contains("vertices"), "{}", run.stderr);
    assert_eq!(serde_json::from_str::<Value>(&run.stdout).unwrap()["output"], "new.obj");
}

#[test]
fn what_cannot_be_read_or_written_is_refused() {
    let folder = Folder::new();
    folder.asset("torus.obj");
    folder.write("bad.obj", "f 1 2 3");
    for (arguments, words) in [
        (["none.obj", "-o", "new.obj"], ["none.obj", ""]),
        (["bad.obj", "-o", "new.obj"], ["bad.obj", "line 1"]),
        (["torus.obj", "-o", "new.glb"], ["new.glb", ".ply"]),
        (["torus.obj", "-o", "new"], ["new", ".obj"]),
        (["torus.obj", "-o", "no/new.obj"], ["no/new.obj", ""]),
    ] {
        folder.bad(&[&["repair"], &arguments[..]].concat(), &words);
    }
    for tolerance in ["1", "-1", "NaN"] {
        let weld = format!("--weld={tolerance}");
        folder.bad(&["repair", "torus.obj", "-o", "new.obj", &weld], &["--weld"]);
    }
    assert!(!folder.path("new.obj").exists());
}

#[test]
fn what_is_not_kept_of_a_file_is_told() {
    let folder = Folder::new();
    let extras = "vt 0 0\nvt 1 0\nvn 0 0 1\no part\nusemtl red\n";
    let sound = format!("{extras}{}", to_obj(&shapes::cube(1.0)));
    folder.write("sound.obj", &sound);
    folder.write("broken.obj", format!("{extras}{}", to_obj(&broken_ball())));
    // Nothing is wrong with it, so it stays as it is.
    folder.good(&["repair", "sound.obj", "--in-place"]);
    assert_eq!(folder.read("sound.obj"), sound.as_bytes());
    for arguments in [["sound.obj", "-o", "new.obj"], ["broken.obj", "--in-place", "--weld"]] {
        let run = folder.run(&[&["repair"], &arguments[..]].concat());
        assert!(run.success, "{}", run.stderr);
        for words in ["2 vt lines", "1 vn lines", "1 o lines", "1 usemtl lines"] {
            assert_eq!(
                run.stderr.contains(words),
                arguments[0] == "sound.obj",
                "{}",
                run.stderr
            );
        }
    }
    let run = folder.run(&["repair", "broken.obj", "--in-place"]);
    assert!(
        run.stderr.contains("broken.obj: only positions and faces"),
        "{}",
        run.stderr
    );
    folder.write(
        "x.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n",
    );
    let run = folder.run(&["repair", "x.ply", "-o", "y.ply"]);
    assert!(
        run.stderr.contains("not kept: the property red of vertex\n"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_recipe_of_a_baked_file_is_repaired_as_its_source() {
    let folder = Folder::new();
    folder.write("ball.obj", to_obj(&broken_ball()));
    assert!(folder.run(&["bake", "ball.obj", "-o", "."]).success);
    folder.write("recipe.bake.ron", r#"(mesh: "ball.faceoff")"#);
    folder.good(&["repair", "ball.obj", "-o", "a.obj", "--drop"]);
    folder.good(&["repair", "recipe.bake.ron", "-o", "b.obj", "--drop", "--json", "b.json"]);
    assert_eq!(folder.read("a.obj"), folder.read("b.obj"));
}
