//! `faceoff bake` of a library of 200 meshes: one run, shards, processes side by side, and after a kill, all with the
//! same bytes.

use crate::Folder;
use crate::library::{cube, files, json, names, torus};
use bevy_faceoff::asset::{format, to_obj};
use bevy_faceoff::geometry::shapes;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, SystemTime};

const MESHES: usize = 200;
/// With it each mesh takes a few milliseconds.
const TABLE: [&str; 5] = ["--faces", "--degrees", "10", "--image", "64"];

/// The variables from which `--shard auto` reads.
pub const VARIABLES: [&str; 6] = [
    "JOB_COMPLETION_INDEX",
    "SLURM_ARRAY_TASK_COUNT",
    "SLURM_ARRAY_TASK_ID",
    "SLURM_ARRAY_TASK_MAX",
    "SLURM_ARRAY_TASK_MIN",
    "SLURM_ARRAY_TASK_STEP",
];

/// A library of different meshes in ten folders.
fn library() -> Folder {
    let folder = Folder::new();
    for i in 0..MESHES as u32 {
        let torus = shapes::torus(8 + i % 10, 5 + i / 20, 1.0 + f64::from(i), 0.25);
        folder.write(&format!("lib/{:02}/torus_{i:03}.obj", i % 10), to_obj(&torus));
    }
    folder
}

/// The command line for the library.
fn bake<'a>(output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["bake", "lib", "-o", output], &TABLE[..], more].concat()
}

fn spawn(folder: &Folder, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_faceoff"))
        .args(arguments)
        .current_dir(folder.path("."))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The files of one run over the whole library, each of them valid.
fn whole(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    let said = folder.good(&bake("whole", &[]));
    assert!(said.contains("200 meshes: 200 baked, 0 up to date, 0 failed"), "{said}");
    let whole = files(folder, "whole");
    assert_eq!(whole.len(), MESHES);
    for (name, bytes) in &whole {
        format::from_bytes(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    whole
}

#[test]
fn shards_together_are_one_run() {
    let folder = library();
    let whole = whole(&folder);
    let mut baked = 0;
    for (index, shard) in ["1/4", "2/4", "3/4", "4/4"].into_iter().enumerate() {
        folder.good(&bake("shards", &["--shard", shard, "--json", "summary.json"]));
        let summary = json(&folder, "summary.json");
        assert_eq!(summary["shard"]["index"], index + 1);
        assert_eq!(summary["shard"]["count"], 4);
        let part = summary["totals"]["baked"].as_u64().unwrap();
        assert!((20..=80).contains(&part), "shard {shard} bakes {part} of 200");
        assert_eq!(summary["totals"]["meshes"], part, "no shard sees what another baked");
        baked += part;
    }
    assert_eq!(baked, MESHES as u64);
    assert!(files(&folder, "shards") == whole);
}

#[test]
fn a_mesh_stays_in_its_shard_when_others_are_added() {
    let folder = library();
    let first_shard = || -> Vec<String> {
        folder.good(&["bake", "lib", "-o", "out", "--shard", "1/4", "--json", "summary.json"]);
        let summary = json(&folder, "summary.json");
        let meshes = summary["meshes"].as_array().unwrap().iter();
        meshes.map(|mesh| mesh["source"].to_string()).collect()
    };
    let before = first_shard();
    cube(&folder, "lib/00/a_first.obj");
    let mut after = first_shard();
    after.retain(|source| !source.contains("a_first"));
    assert_eq!(before, after);
}

#[test]
fn two_processes_share_one_folder() {
    let folder = library();
    let whole = whole(&folder);
    let summaries = ["a.json", "b.json"];
    let children = summaries.map(|json| spawn(&folder, &bake("shared", &["--threads", "2", "--json", json])));
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    }
    assert!(files(&folder, "shared") == whole);
    let baked: u64 = summaries
        .iter()
        .map(|name| {
            let totals = &json(&folder, name)["totals"];
            assert_eq!((&totals["meshes"], &totals["failed"]), (&MESHES.into(), &0.into()));
            totals["baked"].as_u64().unwrap()
        })
        .sum();
    // Only at its end does a process bake what the other is baking: at most one mesh per thread.
    assert!((200..=204).contains(&baked), "{baked} bakes of 200 meshes");
}

/// Starts a run and kills it in the middle. Returns the files that it has baked.
fn kill_in_the_middle(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    // A busy machine may let the run end before it lets this thread kill it.
    for _ in 0..10 {
        let mut child = spawn(folder, &bake("killed", &[]));
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        assert_eq!(lines.take(10).filter(|line| line.is_ok()).count(), 10);
        child.kill().unwrap();
        child.wait().unwrap();
        let mut baked = files(folder, "killed");
        baked.retain(|name, _| name.ends_with(".faceoff"));
        assert!(baked.len() >= 10, "what was told is there");
        if baked.len() < MESHES {
            return baked;
        }
        std::fs::remove_dir_all(folder.path("killed")).unwrap();
    }
    panic!("every run ended before it was killed");
}

#[test]
fn a_run_that_was_killed_goes_on() {
    let folder = library();
    let whole = whole(&folder);
    let half = kill_in_the_middle(&folder);
    for (name, bytes) in &half {
        assert!(whole[name] == *bytes, "{name} is half written");
    }

    folder.good(&bake("killed", &["--json", "after.json"]));
    let totals = &json(&folder, "after.json")["totals"];
    assert_eq!(totals["up_to_date"], half.len(), "what was baked is kept");
    // What the killed process was writing is hidden, and too young to be known as left.
    for name in names(&folder, "killed") {
        if !whole.contains_key(&name) {
            assert!(name.contains("/.faceoff-"), "{name}");
            age(&folder, &format!("killed/{name}"));
        }
    }
    folder.good(&bake("killed", &[]));
    assert!(files(&folder, "killed") == whole);
}

/// A limit on the size of files kills a process while it writes the first file that is longer.
#[test]
#[cfg(unix)]
fn a_run_that_is_killed_while_it_writes_leaves_no_half_file() {
    let folder = library();
    let whole = whole(&folder);
    let lengths = || whole.values().map(Vec::len);
    // Blocks have 512 or 1024 bytes.
    let blocks = lengths().min().unwrap() / 512 + 1;
    assert!(blocks * 1024 < lengths().max().unwrap(), "some file is longer");
    let output = Command::new("sh")
        .args(["-c", &format!("ulimit -c 0; ulimit -f {blocks}; exec \"$@\""), "sh"])
        .arg(env!("CARGO_BIN_EXE_faceoff"))
        .args(bake("killed", &[]))
        .current_dir(folder.path("."))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), None, "a signal ends it: {output:?}");
    let left = files(&folder, "killed");
    assert!(left.keys().any(|name| name.ends_with(".partial")), "it was writing");
    for (name, bytes) in left.iter().filter(|(name, _)| name.ends_with(".faceoff")) {
        assert!(whole[name] == *bytes, "{name} is half written");
    }
    for name in left.keys().filter(|name| name.contains("/.faceoff-")) {
        age(&folder, &format!("killed/{name}"));
    }
    folder.good(&bake("killed", &[]));
    assert!(files(&folder, "killed") == whole);
}

/// Makes a file look two hours old.
fn age(folder: &Folder, name: &str) {
    let file = File::options().write(true).open(folder.path(name)).unwrap();
    file.set_modified(SystemTime::now() - Duration::from_secs(7200))
        .unwrap();
}

#[test]
fn only_old_leftovers_are_removed() {
    let folder = Folder::new();
    cube(&folder, "lib/cube.obj");
    cube(&folder, "lib/sub/cube.obj");
    let left = [".faceoff-aBcDeF.partial", ".faceoff-ball.claim"];
    let other = [".faceoff-notes", "notes.partial"];
    for name in left {
        folder.write(&format!("out/{name}"), "");
    }
    for name in left.into_iter().chain(other) {
        let name = format!("out/sub/{name}");
        folder.write(&name, "");
        age(&folder, &name);
    }
    folder.good(&["bake", "lib", "-o", "out"]);
    assert_eq!(
        names(&folder, "out"),
        [
            left[0],
            left[1],
            "cube.faceoff",
            "sub/.faceoff-notes",
            "sub/cube.faceoff",
            "sub/notes.partial"
        ]
    );
}

#[test]
fn a_claim_of_a_killed_process_stops_nobody() {
    let folder = Folder::new();
    cube(&folder, "cube.obj");
    torus(&folder, "torus.obj");
    folder.write("out/.faceoff-cube.claim", "");
    let said = folder.good(&["bake", "torus.obj", "cube.obj", "-o", "out"]);
    let sources: Vec<_> = said.lines().map(|line| line.split(' ').next().unwrap()).collect();
    assert_eq!(sources, ["cube.obj", "torus.obj"], "in the order of names");
    assert_eq!(names(&folder, "out"), ["cube.faceoff", "torus.faceoff"]);
}

#[test]
fn tasks_of_slurm_and_kubernetes_know_their_shards() {
    let folder = Folder::new();
    cube(&folder, "lib/cube.obj");
    let run = |more: &[&str], variables: &[(&str, &str)]| {
        let mut command = folder.command(&[&["bake", "lib", "-o", "out", "--json", "-"], more].concat());
        for name in VARIABLES {
            command.env_remove(name);
        }
        command.envs(variables.iter().copied()).output().unwrap()
    };
    let shard = |shard: &str, variables: &[(&str, &str)]| {
        let output = run(&["--shard", shard], variables);
        assert!(output.status.success(), "{output:?}");
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        let number = |name: &str| summary["shard"][name].as_u64().unwrap();
        (number("index"), number("count"))
    };
    let refused = |shard: &str, variables: &[(&str, &str)], words: &str| {
        let output = run(&["--shard", shard], variables);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(stderr.contains(words), "no {words:?} in {stderr}");
    };
    let array = |id, min, max, step, count| {
        [
            ("SLURM_ARRAY_TASK_ID", id),
            ("SLURM_ARRAY_TASK_MIN", min),
            ("SLURM_ARRAY_TASK_MAX", max),
            ("SLURM_ARRAY_TASK_STEP", step),
            ("SLURM_ARRAY_TASK_COUNT", count),
        ]
    };
    let four = array("0", "0", "3", "1", "4");
    assert_eq!(shard("auto", &four), (1, 4));
    assert_eq!(shard("auto", &array("4", "1", "4", "1", "4")), (4, 4));
    assert_eq!(shard("auto/3", &array("14", "10", "14", "2", "3")), (3, 3));
    refused("auto", &four[..2], "SLURM_ARRAY_TASK_COUNT is not set");
    refused("auto", &array("1", "0", "5", "1", "3"), "gaps");
    refused("auto", &array("3", "0", "4", "2", "3"), "gaps");
    refused("auto/4", &array("3", "3", "3", "1", "1"), "not 4");

    let index = |index| [("JOB_COMPLETION_INDEX", index)];
    assert_eq!(shard("auto/4", &index("0")), (1, 4));
    assert_eq!(shard("auto/4", &index("3")), (4, 4));
    refused("auto/4", &index("4"), "less than 4");
    refused("auto", &index("0"), "auto/N");
    refused("auto/4", &index("first"), "not a number");
    refused("auto", &[&index("0")[..], &four].concat(), "both");

    // What the user gives outranks the variables. Without the option they mean nothing: the array may have other work.
    assert_eq!(shard("2/3", &four), (2, 3));
    let summary: Value = serde_json::from_slice(&run(&[], &four).stdout).unwrap();
    assert!(summary["shard"].is_null());
}

#[test]
fn a_mesh_that_may_take_more_than_the_memory_is_baked_alone_and_told() {
    let folder = library();
    let whole = whole(&folder);
    let arguments = bake("alone", &["--memory", "1KiB", "--threads", "4"]);
    let run = folder.run(&arguments);
    assert!(run.success, "{}", run.stderr);
    assert_eq!(run.stderr.matches("so it was baked alone").count(), MESHES);
    assert!(run.stderr.contains("more than --memory 1.0 KiB"), "{}", run.stderr);
    assert!(files(&folder, "alone") == whole);
    // What is up to date takes none.
    folder.good(&arguments);

    // The buffer of a glTF file counts, although it is a file of its own.
    let document = r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "far.bin", "byteLength": 2000000}]}"#;
    folder.write("scene/far.gltf", document);
    let is_told = || {
        let run = folder.run(&["bake", "scene/far.gltf", "-o", "out", "--memory", "10MiB"]);
        run.stderr.contains("baked alone")
    };
    assert!(!is_told());
    folder.write("scene/far.bin", vec![0; 2_000_000]);
    assert!(is_told());
    // Its name may be encoded.
    folder.write("scene/far.gltf", document.replace("far.bin", "far%20off.bin"));
    folder.write("scene/far off.bin", vec![0; 2_000_000]);
    assert!(is_told());
}
