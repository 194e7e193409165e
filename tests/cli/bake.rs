//! `faceoff bake`.

use crate::Folder;
use bevy_faceoff::asset::{format, to_obj};
use bevy_faceoff::geometry::shapes;
use std::process::{Command, Stdio};

/// A folder with a torus of 240 triangles.
fn torus() -> Folder {
    let folder = Folder::new();
    folder.asset("torus.obj");
    folder
}

const COARSE: [&str; 5] = ["--faces", "--degrees", "45", "--image", "16"];

fn header(folder: &Folder, name: &str) -> (usize, format::Header, bool) {
    let (mesh, header) = format::from_bytes(&folder.read(name)).unwrap();
    (mesh.mesh.triangles().len(), header, mesh.faces.is_some())
}

#[test]
fn a_mesh_is_baked_into_a_folder_that_is_made_for_it() {
    let folder = torus();
    let said = folder.good(&["bake", "torus.obj", "-o", "deep/out"]);
    assert!(
        said.contains("torus.obj -> ") && said.contains("240 triangles"),
        "{said}"
    );
    let (triangles, header, faces) = header(&folder, "deep/out/torus.faceoff");
    assert_eq!((triangles, faces), (240, false));
    assert_eq!(header.source_hash, format::source_hash(&folder.read("torus.obj")));
    let files: Vec<_> = std::fs::read_dir(folder.path("deep/out")).unwrap().collect();
    assert_eq!(files.len(), 1, "no half files are left");
}

#[test]
fn what_is_up_to_date_is_skipped_unless_forced() {
    let folder = torus();
    folder.good(&["bake", "torus.obj", "-o", "out"]);
    let first = folder.read("out/torus.faceoff");
    let said = folder.good(&["bake", "torus.obj", "-o", "out"]);
    assert!(said.contains("up to date") && !said.contains("->"), "{said}");
    let said = folder.good(&["bake", "torus.obj", "-o", "out", "--force"]);
    assert!(said.contains("->"), "{said}");
    assert_eq!(folder.read("out/torus.faceoff"), first, "the same bytes twice");
}

#[test]
fn a_changed_mesh_or_a_damaged_output_is_baked_again() {
    let folder = torus();
    folder.good(&["bake", "torus.obj", "-o", "out"]);
    let good = folder.read("out/torus.faceoff");
    let mut flipped = good.clone();
    *flipped.last_mut().unwrap() ^= 0xff;
    for damaged in [&good[..good.len() / 2], &flipped, b"", b"something else"] {
        folder.write("out/torus.faceoff", damaged);
        let said = folder.good(&["bake", "torus.obj", "-o", "out"]);
        assert!(said.contains("->"), "{said}");
        assert_eq!(folder.read("out/torus.faceoff"), good);
    }
    folder.write("torus.obj", to_obj(&shapes::cube(1.0)));
    folder.good(&["bake", "torus.obj", "-o", "out"]);
    assert_eq!(header(&folder, "out/torus.faceoff").0, 12);
}

#[test]
fn options_choose_what_is_baked_and_other_options_bake_again() {
    let folder = torus();
    let arguments = [&["bake", "torus.obj", "-o", "out"], &COARSE[..]].concat();
    folder.good(&arguments);
    let (_, header_of, faces) = header(&folder, "out/torus.faceoff");
    assert!(faces);
    assert_eq!((header_of.settings.degrees, header_of.settings.image), (45, 16));
    let first = folder.read("out/torus.faceoff");
    assert!(folder.good(&arguments).contains("up to date"));
    folder.good(&[&arguments[..], &["--force"]].concat());
    assert_eq!(folder.read("out/torus.faceoff"), first, "the same bytes twice");
    assert!(folder.good(&["bake", "torus.obj", "-o", "out"]).contains("->"));
    assert!(!header(&folder, "out/torus.faceoff").2);
}

#[test]
fn a_recipe_and_a_baked_file_keep_their_settings() {
    let folder = torus();
    folder.write(
        "coarse.bake.ron",
        "(mesh: \"torus.obj\", settings: (faces: true, degrees: 90, image: 16))",
    );
    folder.good(&["bake", "coarse.bake.ron", "-o", "out"]);
    folder.good(&["bake", "out/coarse.faceoff", "-o", "again"]);
    for file in ["out/coarse.faceoff", "again/coarse.faceoff"] {
        let (triangles, header, faces) = header(&folder, file);
        assert_eq!((triangles, header.settings.degrees, faces), (240, 90, true), "{file}");
    }
    folder.good(&["bake", "coarse.bake.ron", "-o", "out", "--degrees", "45"]);
    assert_eq!(
        header(&folder, "out/coarse.faceoff").1.settings.degrees,
        45,
        "an option outranks the recipe"
    );
}

#[test]
fn a_room_is_told_and_may_be_made_a_solid() {
    let folder = torus();
    let cube = shapes::cube(1.0);
    folder.write("room.obj", to_obj(&cube.flipped()));
    let inspected =
        |file: &str| -> serde_json::Value { serde_json::from_str(&folder.good(&["inspect", file, "--json"])).unwrap() };
    let run = folder.run(&["bake", "room.obj", "-o", "out"]);
    assert!(
        run.stderr.starts_with("warning: room.obj: ") && run.stderr.contains("it is a room"),
        "{}",
        run.stderr
    );
    let room = inspected("out/room.faceoff");
    assert_eq!((&room["orientation"], &room["volume"]), (&"Inward".into(), &1.0.into()));
    assert!(room["warnings"][0].as_str().unwrap().contains("it is a room"), "{room}");
    folder.good(&[
        "bake",
        "room.obj",
        "-o",
        "out",
        "--inward",
        "solid",
        "--weld-tolerance",
        "0",
    ]);
    let solid = inspected("out/room.faceoff");
    assert_eq!(
        (&solid["orientation"], &solid["mass_is_approximate"]),
        (&"Outward".into(), &false.into())
    );
    assert_eq!(
        (&solid["settings"]["inward"], &solid["settings"]["weld_tolerance"]),
        (&"Solid".into(), &0.0.into())
    );
    assert!(solid["warnings"].as_array().unwrap().is_empty(), "{solid}");
    assert!(folder.good(&["inspect", "out/room.faceoff"]).contains("solid"));
    folder.bad(
        &["bake", "room.obj", "-o", "out", "--weld-tolerance", "0.02"],
        &["weld_tolerance is 0.02"],
    );
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let folder = torus();
    for (option, value) in [
        ("--degrees", "0"),
        ("--degrees", "7"),
        ("--degrees", "91"),
        ("--image", "15"),
        ("--image", "4097"),
        ("--image", "0"),
    ] {
        let arguments = ["bake", "torus.obj", "-o", "out", "--faces", option, value];
        folder.bad(&arguments, &[&option[2..], value]);
        assert!(!folder.path("out/torus.faceoff").exists());
    }
    folder.bad(
        &["bake", "torus.obj", "-o", "out", "--degrees", "many"],
        &["--degrees", "many"],
    );
    folder.bad(&["bake", "torus.obj", "-o", "out", "--image=-5"], &["--image"]);
}

#[test]
fn a_broken_mesh_among_good_ones_is_named_and_the_good_ones_are_baked() {
    let folder = torus();
    folder.asset("cube.obj");
    folder.write("broken.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
    let inputs = ["bake", "torus.obj", "broken.obj", "gone.obj", "cube.obj", "-o", "out"];
    let run = folder.bad(&inputs, &["broken.obj", "line 3", "gone.obj", "2 of 4 meshes"]);
    assert!(
        !run.stderr.contains("torus") && !run.stderr.contains("cube"),
        "{}",
        run.stderr
    );
    assert_eq!(header(&folder, "out/torus.faceoff").0, 240);
    assert_eq!(header(&folder, "out/cube.faceoff").0, 12);
    assert!(!folder.path("out/broken.faceoff").exists());
}

#[test]
fn a_mesh_that_is_open_is_baked_with_a_warning_that_names_it() {
    let folder = Folder::new();
    folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let run = folder.run(&["bake", "open.obj", "-o", "out"]);
    assert!(run.success);
    assert!(run.stderr.starts_with("warning: open.obj: "), "{}", run.stderr);
    assert_eq!(header(&folder, "out/open.faceoff").0, 1);
}

#[test]
fn a_file_with_a_fault_is_read_with_a_warning_that_names_it() {
    let folder = torus();
    let text = String::from_utf8(folder.read("torus.obj")).unwrap();
    folder.write("faulty.obj", format!("{text}f 1 2\n"));
    folder.write("faulty.bake.ron", "(mesh: \"faulty.obj\")");
    for file in ["faulty.obj", "faulty.bake.ron"] {
        let run = folder.run(&["bake", file, "-o", "out", "--force"]);
        let warning = format!("warning: {file}: faces with fewer than three corners, 1 in all, are left out\n");
        assert_eq!((run.success, run.stderr), (true, warning));
        let report: serde_json::Value = serde_json::from_str(&folder.good(&["inspect", file, "--json"])).unwrap();
        assert!(
            report["warnings"][0].as_str().unwrap().starts_with("faces with fewer"),
            "{report}"
        );
    }
}

#[test]
fn a_part_of_a_file_is_baked_and_told_if_it_is_not_there() {
    let folder = torus();
    let torus = String::from_utf8(folder.read("torus.obj")).unwrap();
    folder.write("two.obj", format!("o first\n{torus}o second\nf 1 2 3\n"));
    folder.write("part.bake.ron", "(mesh: \"two.obj\", part: (object: \"first\"))");
    folder.good(&["bake", "part.bake.ron", "-o", "out"]);
    assert_eq!(header(&folder, "out/part.faceoff").0, 240);
    folder.write("part.bake.ron", "(mesh: \"two.obj\", part: (object: \"third\"))");
    folder.bad(
        &["bake", "part.bake.ron", "-o", "out"],
        &["two.obj", "no object \"third\"", "\"first\", \"second\""],
    );
}

#[test]
fn a_file_that_a_mesh_names_elsewhere_is_read_only_if_the_recipe_says_so() {
    let folder = Folder::new();
    folder.asset("pentominoes.gltf");
    let mut gltf: serde_json::Value = serde_json::from_slice(&folder.read("pentominoes.gltf")).unwrap();
    let uri = gltf["buffers"][0]["uri"].take();
    let data = uri.as_str().unwrap().split_once(',').unwrap().1;
    let data = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, data).unwrap();
    folder.write("data/shared.bin", data);
    gltf["buffers"][0]["uri"] = "../data/shared.bin".into();
    folder.write("meshes/x.gltf", gltf.to_string());
    folder.write("x.bake.ron", "(mesh: \"meshes/x.gltf\")");
    for file in ["meshes/x.gltf", "x.bake.ron"] {
        folder.bad(
            &["bake", file, "-o", "out"],
            &["meshes/x.gltf", "\"../data/shared.bin\"", "read_outside: true"],
        );
    }
    folder.write("x.bake.ron", "(mesh: \"meshes/x.gltf\", read_outside: true)");
    folder.good(&["bake", "x.bake.ron", "-o", "out"]);
    assert!(header(&folder, "out/x.faceoff").0 > 0);
}

#[test]
fn meshes_of_one_name_are_all_told_and_the_rest_is_baked() {
    let folder = torus();
    folder.asset("cube.obj");
    folder.write("other/torus.obj", folder.read("torus.obj"));
    folder.write("torus.bake.ron", "(mesh: \"torus.obj\")");
    folder.asset("knot.obj");
    folder.write("other/KNOT.obj", folder.read("knot.obj"));
    let run = folder.bad(
        &[
            "bake",
            "torus.obj",
            "other/torus.obj",
            "knot.obj",
            "torus.bake.ron",
            "cube.obj",
            "other/KNOT.obj",
            "-o",
            "out",
        ],
        &[
            "torus.obj and other/torus.obj and torus.bake.ron would",
            "out/torus.faceoff",
            "knot.obj and other/KNOT.obj would",
            "out/knot.faceoff",
            "5 of 6 meshes",
        ],
    );
    assert!(!run.stderr.contains("cube"), "{}", run.stderr);
    let files: Vec<_> = std::fs::read_dir(folder.path("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(files, ["cube.faceoff"]);
}

#[test]
fn a_mesh_that_is_given_twice_is_baked_once() {
    let folder = torus();
    let whole = folder.path("torus.obj");
    let said = folder.good(&["bake", "torus.obj", "./torus.obj", whole.to_str().unwrap(), "-o", "out"]);
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(header(&folder, "out/torus.faceoff").0, 240);
}

#[test]
fn many_bakes_into_one_folder_do_not_disturb_each_other() {
    let folder = torus();
    let bake = || {
        Command::new(env!("CARGO_BIN_EXE_faceoff"))
            .args(["bake", "torus.obj", "-o", "out", "--force"])
            .current_dir(folder.path("."))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    };
    for _ in 0..10 {
        let children: Vec<_> = (0..8).map(|_| bake()).collect();
        for child in children {
            let output = child.wait_with_output().unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
    }
    assert_eq!(header(&folder, "out/torus.faceoff").0, 240);
    assert_eq!(std::fs::read_dir(folder.path("out")).unwrap().count(), 1);
}

#[test]
fn a_recipe_names_its_mesh_relative_to_itself() {
    let folder = torus();
    folder.write("sub/torus.bake.ron", "(mesh: \"../torus.obj\")");
    folder.good(&["bake", "sub/torus.bake.ron", "-o", "out"]);
    let whole = folder.path("torus.obj");
    for mesh in [
        whole.to_str().unwrap(),
        "/torus.obj",
        "C:/torus.obj",
        "sub\\\\torus.obj",
    ] {
        folder.write("bad.bake.ron", format!("(mesh: \"{mesh}\")"));
        folder.bad(
            &["bake", "bad.bake.ron", "-o", "out"],
            &["bad.bake.ron", "relative to the recipe"],
        );
    }
    // Only an app knows what this is.
    folder.write("bad.bake.ron", "(mesh: \"embedded://torus.obj\")");
    folder.bad(
        &["bake", "bad.bake.ron", "-o", "out"],
        &["embedded://torus.obj", "asset source"],
    );
}

#[test]
#[cfg(target_os = "linux")]
fn what_is_no_file_is_refused_and_not_waited_for() {
    let folder = torus();
    let pipe = folder.path("pipe.obj");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", folder.path("endless.obj")).unwrap();
    folder.write("pipe.bake.ron", "(mesh: \"pipe.obj\")");
    folder.write("endless.bake.ron", "(mesh: \"endless.obj\")");
    folder.write("scene.ron", "(meshes: {\"a\": \"endless.obj\"}, bodies: [])");
    for arguments in [
        &["bake", "pipe.bake.ron", "-o", "out"][..],
        &["bake", "endless.bake.ron", "-o", "out"],
        &["bake", "pipe.obj", "-o", "out"],
        &["inspect", "endless.obj"],
        &["check", "scene.ron"],
        &["simulate", "--shape", "pipe.obj"],
    ] {
        folder.bad(arguments, &[".obj", "give the path of a mesh file"]);
    }
    folder.bad(&["check", "/dev/zero"], &["/dev/zero", "not a scene"]);
}

#[test]
fn an_output_that_cannot_be_made_or_written_is_named() {
    let folder = torus();
    folder.write("file", "not a folder");
    folder.bad(&["bake", "torus.obj", "-o", "file"], &["file"]);
    folder.bad(&["bake", "torus.obj", "-o", "file/under"], &["file/under"]);
    folder.write("out/torus.faceoff/in_the_way", "");
    folder.bad(&["bake", "torus.obj", "-o", "out"], &["torus.faceoff"]);
    let left: Vec<_> = std::fs::read_dir(folder.path("out")).unwrap().collect();
    assert_eq!(left.len(), 1, "no half file is left: {left:?}");
}

#[test]
fn a_reader_that_closes_the_pipe_does_not_stop_the_bake() {
    let folder = torus();
    let mut child = Command::new(env!("CARGO_BIN_EXE_faceoff"))
        .args(["bake", "torus.obj", "-o", "out"])
        .current_dir(folder.path("."))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    assert_eq!(header(&folder, "out/torus.faceoff").0, 240);
}
