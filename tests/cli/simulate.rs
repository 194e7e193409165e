//! `faceoff simulate`.

use crate::Folder;
use bevy_faceoff::asset::{CollisionMesh, format};
use bevy_faceoff::geometry::shapes;
use serde_json::Value;
use std::path::Path;

const STAGES: [&str; 6] = [
    "broad_phase",
    "angles",
    "triangle_test",
    "manifolds",
    "force_scan",
    "integrate",
];
/// What is counted of contacts and bodies, and measured.
const MECHANICS: [&str; 9] = [
    "contact_points",
    "collision_substeps",
    "mean_collision_substeps",
    "sleeping",
    "crowded_bodies",
    "kinetic_energy",
    "momentum",
    "deepest_penetration",
    "mean_penetration",
];
const COUNTS: [&str; 4] = ["sphere_pairs", "touching_pairs", "triangle_tests", "face_pairs"];

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<_> = value
        .as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect();
    keys.sort_unstable();
    keys
}

fn sorted<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut names: Vec<_> = names.into_iter().collect();
    names.sort_unstable();
    names
}

/// Runs with `--json` to a file and checks the shape of what is written.
#[track_caller]
fn simulate(folder: &Folder, options: &[&str]) -> Value {
    let mut arguments = vec!["simulate", "--json", "out.json"];
    arguments.extend(options);
    let table = folder.good(&arguments);
    assert!(
        table.contains("TriangleTest") && table.contains("touching pairs"),
        "{table}"
    );
    let json: Value = serde_json::from_slice(&folder.read("out.json")).unwrap();
    check_shape(&json);
    json
}

fn check_shape(json: &Value) {
    assert_eq!(keys(json), ["meta", "steps"]);
    assert!(json["meta"].is_object());
    for (i, step) in json["steps"].as_array().unwrap().iter().enumerate() {
        let of_a_gpu = (json["meta"]["backend"] == "gpu").then_some("gpu");
        assert_eq!(
            keys(step),
            sorted(
                ["step", "step_ms", "stages_ms"]
                    .into_iter()
                    .chain(of_a_gpu)
                    .chain(COUNTS)
                    .chain(MECHANICS)
            )
        );
        assert_eq!(step["step"], i as u64 + 1);
        assert!(step["step_ms"].as_f64().unwrap() >= 0.0);
        assert_eq!(keys(&step["stages_ms"]), sorted(STAGES));
        assert!(STAGES.iter().all(|s| step["stages_ms"][s].as_f64().unwrap() >= 0.0));
        assert!(COUNTS.iter().all(|c| step[c].is_u64()));
    }
}

/// The counts of all steps.
fn counts(json: &Value) -> Vec<[u64; 4]> {
    let steps = json["steps"].as_array().unwrap();
    steps.iter().map(|s| COUNTS.map(|c| s[c].as_u64().unwrap())).collect()
}

fn faces(json: &Value) -> u64 {
    counts(json).iter().map(|c| c[3]).sum()
}

#[test]
fn a_small_scene_of_tori_has_the_promised_json() {
    let folder = Folder::new();
    let json = simulate(&folder, &["--bodies", "60", "--steps", "12", "--side", "4"]);
    assert_eq!(json["steps"].as_array().unwrap().len(), 12);
    assert_eq!(json["meta"]["bodies"], 60);
    assert_eq!(json["meta"]["triangles"], 240);
    assert_eq!(json["meta"]["shape"], "torus");
    assert!(faces(&json) > 0, "such a crowd collides");
    for [spheres, touching, tests, faces] in counts(&json) {
        assert!(touching <= spheres && faces <= tests);
    }
}

#[test]
fn standard_output_carries_the_json_alone_when_asked() {
    let folder = Folder::new();
    let run = folder.run(&["simulate", "--bodies", "10", "--steps", "3", "--json", "-"]);
    assert!(run.success);
    let json: Value = serde_json::from_str(&run.stdout).unwrap();
    check_shape(&json);
    assert_eq!(json["steps"].as_array().unwrap().len(), 3);
    assert!(
        run.stderr.contains("TriangleTest"),
        "people read the table on standard error"
    );
    assert!(
        !run.stderr.contains('\u{1b}') && !run.stderr.contains('\r'),
        "no progress bar in a pipe"
    );
}

#[test]
fn the_same_seed_gives_the_same_counts_with_one_thread_and_two() {
    let folder = Folder::new();
    let scene = ["--bodies", "80", "--steps", "20", "--side", "4"];
    let with = |more: &[&str]| simulate(&folder, &[&scene, more].concat());
    let first = with(&["--seed", "5", "--threads", "1"]);
    assert_eq!(first["meta"]["threads"], 1);
    assert!(faces(&first) > 0);
    let two = with(&["--seed", "5", "--threads", "2"]);
    assert_eq!(two["meta"]["threads"], 2);
    assert_eq!(counts(&two), counts(&first));
    assert_eq!(counts(&with(&["--seed", "5", "--threads", "2"])), counts(&two));
    assert_ne!(counts(&with(&["--seed", "6", "--threads", "2"])), counts(&two));
}

#[test]
fn without_response_bodies_are_counted_and_not_pushed() {
    let folder = Folder::new();
    let scene = ["--bodies", "60", "--steps", "30", "--side", "4", "--speed", "3"];
    let none = simulate(&folder, &[&scene[..], &["--response", "none"]].concat());
    let impulse = simulate(&folder, &[&scene[..], &["--response", "impulse"]].concat());
    assert_eq!(none["meta"]["response"], "none");
    assert!(faces(&none) > 0);
    // Spheres are larger by the margin within which points are looked for.
    assert_eq!(
        counts(&none)[0][1..],
        counts(&impulse)[0][1..],
        "the first step starts alike"
    );
    assert_ne!(counts(&none), counts(&impulse));
}

#[test]
fn knots_and_files_of_every_kind_are_shapes() {
    let folder = Folder::new();
    folder.asset("torus.obj");
    folder.write("plain.bake.ron", "(mesh: \"torus.obj\")");
    let baked = format::to_bytes(&CollisionMesh::new(&shapes::torus_240()), [0; 32]);
    folder.write("torus.faceoff", baked);
    let scene = ["--bodies", "40", "--steps", "5", "--side", "3", "--speed", "1"];
    let with = |shape: &str| simulate(&folder, &[&scene[..], &["--shape", shape]].concat());
    let torus = with("torus");
    assert!(faces(&torus) > 0);
    for file in ["torus.obj", "plain.bake.ron", "torus.faceoff"] {
        let json = with(file);
        assert_eq!(json["meta"]["shape"], file);
        assert_eq!(counts(&json), counts(&torus), "{file}");
    }
    assert_eq!(with("knot")["meta"]["triangles"], 1120);
}

#[test]
fn the_help_lists_every_kind_of_shape() {
    let help = Folder::new().good(&["simulate", "--help"]);
    for kind in [".glb", ".gltf", ".obj", ".stl", ".faceoff", ".bake.ron"] {
        assert!(help.contains(kind), "no {kind} in {help}");
    }
}

#[test]
fn no_bodies_one_body_and_no_steps_are_scenes_too() {
    let folder = Folder::new();
    for bodies in ["0", "1"] {
        let json = simulate(&folder, &["--bodies", bodies, "--steps", "4"]);
        assert_eq!(counts(&json), [[0; 4]; 4]);
    }
    let json = simulate(&folder, &["--bodies", "5", "--steps", "0"]);
    assert_eq!(json["steps"], Value::Array(Vec::new()));
    assert_eq!(json["meta"]["bodies"], 5);
    let table = folder.good(&["simulate", "--bodies", "5", "--steps", "0"]);
    assert!(table.starts_with("5 bodies of 240"), "{table}");
    let json = simulate(
        &folder,
        &["--bodies", "5", "--steps", "1", "--side", "0", "--speed", "0"],
    );
    assert_eq!(json["steps"][0]["sphere_pairs"], 10, "all at the origin");
}

#[test]
fn scenes_rest_hang_slide_pour_and_screw() {
    let folder = Folder::new();
    for (scene, bodies, more) in [
        ("chain", 4, &["--bodies", "4"][..]),
        ("stack", 3, &["--bodies", "3"]),
        ("pour", 8, &["--bodies", "8", "--shape", "torus"]),
        ("incline", 6, &[]),
        ("nut", 1, &[]),
    ] {
        let json = simulate(&folder, &[&["--scene", scene, "--steps", "64"], more].concat());
        let (meta, steps) = (&json["meta"], json["steps"].as_array().unwrap());
        assert_eq!((&meta["scene"], &meta["bodies"]), (&scene.into(), &bodies.into()));
        assert_eq!(meta["response"], "contacts");
        assert!(meta["side"].is_null() && meta["speed"].is_null());
        let of = |name: &str| steps.iter().map(|s| s[name].as_f64().unwrap()).collect::<Vec<_>>();
        let (energy, deepest) = (of("kinetic_energy"), of("deepest_penetration"));
        assert!(of("contact_points").iter().sum::<f64>() > 64.0, "{scene}");
        assert!(energy.iter().all(|e| e.is_finite() && *e >= 0.0), "{scene}");
        // The smallest body of all is a ring of diameter 1.
        assert!(deepest.iter().all(|d| (0.0..0.05).contains(d)), "{scene}: {deepest:?}");
        for (mean, deepest) in of("mean_penetration").iter().zip(&deepest) {
            assert!((0.0..=*deepest).contains(mean));
        }
        match scene {
            "stack" => assert!(energy[63] < 1e-3, "it stands: {energy:?}"),
            "incline" => assert!(energy[63] > energy[31] && energy[31] > 0.1, "some slide: {energy:?}"),
            _ => {}
        }
    }
}

#[test]
fn a_scene_refuses_options_that_mean_nothing_to_it() {
    let folder = Folder::new();
    folder.bad(
        &["simulate", "--scene", "stack", "--shape", "knot"],
        &["--shape", "stack"],
    );
    folder.bad(&["simulate", "--scene", "nut", "--bodies", "3"], &["--bodies", "nut"]);
    folder.bad(&["simulate", "--scene", "pour", "--speed", "3"], &["--speed", "pour"]);
    folder.bad(&["simulate", "--scene", "chain", "--side", "3"], &["--side", "chain"]);
    folder.bad(&["simulate", "--scene", "hole"], &["hole", "incline"]);
    folder.bad(
        &["simulate", "--frames", "frames", "--readback", "resident"],
        &["--frames", "resident", "latent"],
    );
}

#[test]
fn the_box_counts_penetration_only_where_points_are_looked_for() {
    let folder = Folder::new();
    let scene = ["--bodies", "30", "--steps", "5", "--side", "3"];
    for (response, counted) in [("impulse", false), ("none", true), ("contacts", true)] {
        let json = simulate(&folder, &[&scene[..], &["--response", response]].concat());
        let last = &json["steps"][4];
        assert_eq!(last["deepest_penetration"].is_number(), counted, "{response}");
        assert_eq!(last["contact_points"].as_u64().unwrap() > 0, counted, "{response}");
    }
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    let folder = Folder::new();
    for option in ["--side", "--speed"] {
        for value in ["-1", "NaN", "inf", "-inf", "1e30"] {
            let given = format!("{option}={value}");
            folder.bad(&["simulate", "--bodies", "2", "--steps", "1", &given], &[option]);
        }
        folder.bad(&["simulate", option, "wide"], &[option, "wide"]);
    }
    for option in ["--bodies", "--steps", "--seed", "--threads"] {
        folder.bad(&["simulate", &format!("{option}=-1")], &[option]);
        folder.bad(&["simulate", option, "1.5"], &[option, "1.5"]);
    }
    folder.bad(&["simulate", "--threads", "100000"], &["--threads", "1024"]);
    folder.bad(&["simulate", "--response", "hug"], &["hug", "impulse", "none"]);
}

#[test]
fn files_that_cannot_be_used_are_named() {
    let folder = Folder::new();
    folder.write("text.obj", "no mesh at all\n");
    folder.write(
        "cut.faceoff",
        &format::to_bytes(&CollisionMesh::new(&shapes::cube(1.0)), [0; 32])[..90],
    );
    folder.write("lost.bake.ron", "(mesh: \"gone.obj\")");
    for (shape, named) in [
        ("missing.obj", "missing.obj"),
        ("ball", "ball"),
        ("text.obj", "text.obj"),
        ("cut.faceoff", "cut.faceoff"),
        ("lost.bake.ron", "gone.obj"),
        (".", "."),
    ] {
        folder.bad(
            &["simulate", "--bodies", "2", "--steps", "1", "--shape", shape],
            &[named],
        );
    }
    let small = ["simulate", "--bodies", "2", "--steps", "1", "--json"];
    folder.bad(
        &[&small[..], &["no/such/folder/out.json"]].concat(),
        &["no/such/folder/out.json"],
    );
}

#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_a_gpu_is_an_error_and_the_default_a_run_on_the_cpu() {
    let folder = Folder::new();
    let run = |backend: &str| {
        folder
            .command(&["simulate", "--bodies", "2", "--steps", "1", "--backend", backend])
            .env("VK_DRIVER_FILES", "/nowhere")
            .env("VK_ICD_FILENAMES", "/nowhere")
            .output()
            .unwrap()
    };
    let refused = run("gpu");
    let reason = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success());
    assert!(reason.contains("no GPU adapter is found: install a"), "{reason}");
    assert!(run("auto").status.success());
}

/// Mesa complains that XDG_RUNTIME_DIR is missing whenever it is asked for adapters, so that nobody may ask for
/// nothing.
#[cfg(target_os = "linux")]
#[test]
fn without_a_gpu_and_a_desktop_standard_error_stays_empty() {
    if Path::new("/dev/dri").exists() || Path::new("/dev/nvidiactl").exists() {
        return;
    }
    let folder = Folder::new();
    let output = folder
        .command(&["simulate", "--bodies", "2", "--steps", "1"])
        .env_remove("XDG_RUNTIME_DIR")
        .output()
        .unwrap();
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

/// Some leave the range of coordinates.
#[test]
fn bodies_that_take_no_part_are_told() {
    let folder = Folder::new();
    let far = [
        "--side",
        "1e9",
        "--speed",
        "1e9",
        "--response",
        "none",
        "--steps",
        "200",
    ];
    let run = folder.run(&[&["simulate", "--bodies", "20", "--backend", "cpu"], &far[..]].concat());
    assert!(run.success, "{}", run.stderr);
    assert!(
        run.stderr.contains("takes no part: it reaches beyond"),
        "{}",
        run.stderr
    );
}
