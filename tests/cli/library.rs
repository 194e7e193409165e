//! `faceoff bake` of a folder: what is baked, and what is told of it.

use crate::Folder;
use crate::shards::VARIABLES;
use bevy_faceoff::asset::{format, to_obj};
use bevy_faceoff::geometry::shapes;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Writes a mesh of twelve triangles.
pub fn cube(folder: &Folder, name: &str) {
    folder.write(name, to_obj(&shapes::cube(1.0)));
}

/// Writes a mesh of 240 triangles.
pub fn torus(folder: &Folder, name: &str) {
    folder.write(name, to_obj(&shapes::torus_240()));
}

/// All files below a folder, also hidden ones, by their paths.
pub fn files(folder: &Folder, name: &str) -> BTreeMap<String, Vec<u8>> {
    fn collect(root: &Path, folder: &Path, files: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(root, &path, files);
            } else {
                let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
                files.insert(name, fs::read(path).unwrap());
            }
        }
    }
    let mut files = BTreeMap::new();
    collect(&folder.path(name), &folder.path(name), &mut files);
    files
}

/// The paths of [`files`].
pub fn names(folder: &Folder, name: &str) -> Vec<String> {
    files(folder, name).into_keys().collect()
}

/// What a run wrote with `--json`.
pub fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.read(name)).unwrap()
}

/// A summary without its times.
fn without_times(mut summary: Value) -> Value {
    for mesh in summary["meshes"].as_array_mut().unwrap() {
        assert!(mesh["seconds"].take().is_f64());
    }
    assert!(summary["totals"]["seconds"].take().is_f64());
    summary
}

#[test]
fn a_folder_is_read_with_its_sub_folders_but_not_what_is_hidden_or_baked() {
    let folder = Folder::new();
    for name in [
        "lib/cube.obj",
        "lib/sub/deep/CUBE.OBJ",
        "lib/.hidden.obj",
        "lib/.git/cube.obj",
    ] {
        cube(&folder, name);
    }
    folder.write("lib/readme.txt", "not a mesh");
    folder.write("lib/scene.ron", "not a recipe");
    let said = folder.good(&["bake", "lib", "-o", "lib/baked"]);
    assert!(said.contains("2 meshes: 2 baked"), "{said}");
    assert_eq!(names(&folder, "lib/baked"), ["cube.faceoff", "sub/deep/CUBE.faceoff"]);
    // The output is in the library now.
    let said = folder.good(&["bake", "lib/", "-o", "lib/baked"]);
    assert!(said.contains("2 meshes: 0 baked, 2 up to date"), "{said}");
    // A file that is also given by name is baked once.
    let said = folder.good(&["bake", "lib", "lib/cube.obj", "-o", "out"]);
    assert!(said.contains("2 meshes: 2 baked"), "{said}");
    // A folder may be its own output.
    folder.good(&["bake", "lib/sub", "-o", "lib/sub"]);
    assert_eq!(names(&folder, "lib/sub"), ["deep/CUBE.OBJ", "deep/CUBE.faceoff"]);
}

#[test]
fn a_mesh_that_a_recipe_of_the_folder_names_is_baked_by_the_recipe_alone() {
    let folder = Folder::new();
    torus(&folder, "lib/torus.obj");
    cube(&folder, "lib/sub/cube.obj");
    let recipe =
        |mesh: &str, degrees| format!("(mesh: {mesh:?}, settings: (faces: true, degrees: {degrees}, image: 16))");
    folder.write("lib/torus.bake.ron", recipe("torus.obj", 90));
    folder.write("lib/sub/fine.Bake.Ron", recipe("../torus.obj", 45));
    folder.good(&["bake", "lib", "-o", "out"]);
    assert_eq!(
        names(&folder, "out"),
        ["sub/cube.faceoff", "sub/fine.faceoff", "torus.faceoff"]
    );
    let degrees = |name: &str| format::read_header(&folder.read(name)).unwrap().settings.degrees;
    assert_eq!(degrees("out/torus.faceoff"), 90);
    assert_eq!(degrees("out/sub/fine.faceoff"), 45);
    // Given by name it is wanted, and its file would be that of the recipe.
    folder.bad(
        &["bake", "lib", "lib/torus.obj", "-o", "out"],
        &["into the same file", "out/torus.faceoff"],
    );
}

#[test]
#[cfg(unix)]
fn links_neither_loop_nor_hide_a_mesh() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new();
    cube(&folder, "store/cube.obj");
    fs::create_dir(folder.path("lib")).unwrap();
    for (to, link) in [
        ("../store/cube.obj", "lib/linked.obj"),
        ("..", "lib/loop"),
        ("gone", "lib/gone.obj"),
        ("lib", "link"),
    ] {
        symlink(to, folder.path(link)).unwrap();
    }
    let run = folder.run(&["bake", "link", "-o", "out"]);
    assert!(!run.success);
    for words in [
        "link/loop: links to folders are not followed",
        "gone.obj",
        "1 of 2 meshes",
    ] {
        assert!(run.stderr.contains(words), "no {words:?} in {}", run.stderr);
    }
    assert_eq!(names(&folder, "out"), ["linked.faceoff"]);
}

#[test]
fn a_folder_without_meshes_is_told_but_an_empty_shard_is_no_error() {
    let folder = Folder::new();
    folder.write("lib/notes.txt", "");
    let told = ["lib: no mesh in this folder", ".obj"];
    folder.bad(&["bake", "lib", "-o", "out"], &told);
    folder.bad(&["bake", "lib", "-o", "out", "--shard", "2/3"], &told);
    cube(&folder, "lib/cube.obj");
    let said: String = ["1/3", "2/3", "3/3"]
        .map(|shard| folder.good(&["bake", "lib", "-o", "out", "--shard", shard]))
        .concat();
    assert_eq!(said.matches("0 meshes: 0 baked").count(), 2, "{said}");
    assert_eq!(said.matches("1 mesh: 1 baked").count(), 1, "{said}");
}

#[test]
fn the_summary_tells_each_mesh_and_no_run_depends_on_its_threads() {
    let folder = Folder::new();
    torus(&folder, "lib/torus.obj");
    cube(&folder, "lib/a/cube.obj");
    folder.write("lib/a/broken.obj", "v 0 0 0\nf 1 2 3\n");
    folder.write("lib/a/open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("lib/twice.obj", "");
    folder.write("lib/twice.off", "");
    let arguments = |threads, json| vec!["bake", "lib", "-o", "out", "--threads", threads, "--json", json];
    let first = folder.run(&arguments("1", "one.json"));
    let one = without_times(json(&folder, "one.json"));
    let meshes = one["meshes"].as_array().unwrap();
    let told: Vec<_> = meshes
        .iter()
        .map(|mesh| (mesh["source"].as_str().unwrap(), mesh["status"].as_str().unwrap()))
        .collect();
    assert_eq!(
        told,
        [
            ("lib/a/broken.obj", "failed"),
            ("lib/a/cube.obj", "baked"),
            ("lib/a/open.obj", "baked"),
            ("lib/torus.obj", "baked"),
            ("lib/twice.obj", "failed"),
            ("lib/twice.off", "failed"),
        ]
    );
    let [broken, cube, open, ..] = meshes.as_slice() else {
        unreachable!("there are six");
    };
    assert_eq!(cube["triangles"], 12);
    assert_eq!(cube["target"], "out/a/cube.faceoff");
    assert_eq!(cube["bytes"], folder.read("out/a/cube.faceoff").len());
    assert!(cube["error"].is_null() && broken["triangles"].is_null());
    assert!(broken["error"].as_str().unwrap().contains("broken.obj"));
    assert!(open["warnings"][0].as_str().unwrap().contains("the mesh is open"));
    assert_eq!(one["totals"]["triangles"], 12 + 1 + 240);
    assert!(one["shard"].is_null());
    assert!(
        first.stderr.contains("warning: lib/a/open.obj: ") && first.stderr.contains("3 of 6 meshes"),
        "{}",
        first.stderr
    );

    fs::remove_dir_all(folder.path("out")).unwrap();
    let second = folder.run(&arguments("7", "seven.json"));
    assert_eq!(without_times(json(&folder, "seven.json")), one);
    assert_eq!(first.stderr, second.stderr);

    // On standard output the summary stands alone. It has the counts of what is up to date, too.
    let third = folder.run(&arguments("2", "-"));
    let again = without_times(serde_json::from_str(&third.stdout).unwrap());
    assert_eq!(again["totals"]["up_to_date"], 3);
    for count in ["triangles", "bytes"] {
        assert_eq!(again["totals"][count], one["totals"][count]);
    }
    assert!(
        third.stderr.contains("out/a/cube.faceoff is up to date"),
        "{}",
        third.stderr
    );
}

#[test]
fn exit_codes_tell_a_failed_mesh_from_a_wrong_command_line() {
    let folder = Folder::new();
    cube(&folder, "lib/cube.obj");
    let run = |more: &[&str]| {
        let mut command = folder.command(&[&["bake", "lib", "-o", "out"], more].concat());
        for name in VARIABLES {
            command.env_remove(name);
        }
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(run(&[]).0, Some(0));
    assert_eq!(run(&[]).0, Some(0), "up to date");
    for wrong in ["0/4", "5/4", "1/0", "1", "x/4", "1/x", "-1/4", "auto", "auto/2"] {
        let (code, stderr) = run(&[&format!("--shard={wrong}")]);
        assert_eq!(code, Some(2), "{wrong}");
        assert!(
            stderr.contains("--shard") && stderr.contains("I/N"),
            "{wrong}: {stderr}"
        );
    }
    for wrong in ["much", "-1", "2 apples"] {
        let (code, stderr) = run(&[&format!("--memory={wrong}")]);
        assert_eq!(code, Some(2), "{wrong}");
        assert!(stderr.contains("--memory"), "{wrong}: {stderr}");
    }
    folder.write("lib/broken.obj", "");
    assert_eq!(run(&[]).0, Some(1));
    folder.write("in_the_way", "");
    assert_eq!(run(&["--json", "in_the_way/summary.json"]).0, Some(1));
}

#[test]
fn a_recipe_is_not_baked_over_the_baked_file_that_it_names() {
    let folder = Folder::new();
    cube(&folder, "knot.obj");
    folder.good(&["bake", "knot.obj", "-o", "lib"]);
    folder.write("lib/knot.bake.ron", r#"(mesh: "knot.faceoff", settings: (image: 128))"#);
    let before = files(&folder, "lib");
    folder.bad(
        &["bake", "lib", "-o", "lib"],
        &["lib/knot.bake.ron", "lib/knot.faceoff", "another folder"],
    );
    assert_eq!(files(&folder, "lib"), before);
    folder.good(&["bake", "lib", "-o", "out"]);
    assert!(folder.good(&["bake", "lib", "-o", "out"]).contains("1 up to date"));
}

#[test]
fn a_faulty_recipe_beside_its_mesh_is_told() {
    let folder = Folder::new();
    cube(&folder, "lib/knot.obj");
    for (recipe, word) in [
        (r#"(mesh: "knot.obj", setings: ())"#, "line 1, column"),
        (r#"(mesh: "knto.obj")"#, "knto.obj"),
    ] {
        folder.write("lib/knot.bake.ron", recipe);
        let run = folder.bad(
            &["bake", "lib", "-o", "out"],
            &["lib/knot.bake.ron", "this recipe cannot be used", word],
        );
        assert!(!run.stderr.contains("into the same file"), "{}", run.stderr);
    }
}
