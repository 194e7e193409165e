//! The command line with `--backend gpu`, run as a process.

use crate::gpu::Test;
use assert_cmd::Command;
use bevy_faceoff::gpu::device::Gpu;
use serde_json::Value;
use std::fs;
use std::path::Path;

pub const TESTS: &[Test] = &[
    ("simulate_finds_the_same_pairs_on_both", simulate),
    ("check_finds_the_same_faces_on_both", check),
    ("simulate_reads_results_at_once_later_or_never", readbacks),
];

fn run(folder: &Path, arguments: &[&str]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_faceoff"))
        .args(arguments)
        .current_dir(folder)
        .timeout(std::time::Duration::from_secs(300))
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Without response both move the bodies alike; what they find may differ where rounding decides, which in these few
/// steps it does not for pairs of bodies.
fn simulate(_: &Gpu) {
    let folder = tempfile::tempdir().unwrap();
    for shape in ["torus", "knot"] {
        let on = |backend| {
            let scene = ["simulate", "--shape", shape, "--bodies", "150", "--steps", "4"];
            let how = ["--response", "none", "--backend", backend, "--json", "-"];
            run(folder.path(), &[&scene[..], &how].concat())
        };
        let (cpu, gpu) = (on("cpu"), on("gpu"));
        assert_eq!(cpu["meta"]["backend"], "cpu");
        assert_eq!(gpu["meta"]["backend"], "gpu");
        assert!(gpu["meta"]["adapter"].is_string());
        let [cpu, gpu] = [cpu, gpu].map(|record| record["steps"].as_array().unwrap().clone());
        assert_eq!((cpu.len(), gpu.len()), (4, 4));
        for (a, b) in cpu.iter().zip(&gpu) {
            let count = |step: &Value, name: &str| step[name].as_u64().unwrap();
            assert!(count(b, "touching_pairs") > 0);
            assert_eq!(a["touching_pairs"], b["touching_pairs"], "{shape}");
            // The CPU looks for contact points, and farther for them.
            assert!(count(a, "sphere_pairs") >= count(b, "sphere_pairs"), "{shape}");
            assert!(b["stages_ms"]["triangle_test"].is_number());
        }
    }
}

/// Steps have the same results, whenever these are read. The record tells what was asked of the device.
fn readbacks(_: &Gpu) {
    let folder = tempfile::tempdir().unwrap();
    let on = |readback| {
        // The flag has been called so before.
        let flag = if readback == "latent" {
            "--reading"
        } else {
            "--readback"
        };
        let scene = ["simulate", "--bodies", "60", "--steps", "5", "--side", "4"];
        let how = ["--backend", "gpu", flag, readback, "--json", "-"];
        run(folder.path(), &[&scene[..], &how].concat())
    };
    let all = ["lockstep", "latent", "resident"].map(on);
    let [lockstep, latent, resident] = &all;
    for (record, name) in all.iter().zip(["lockstep", "latent", "resident"]) {
        assert_eq!(record["meta"]["readback"], name);
        let steps = record["steps"].as_array().unwrap();
        assert_eq!(steps.len(), 5);
        for (i, step) in steps.iter().enumerate() {
            assert_eq!(step["step"], i as u64 + 1);
            for counted in ["sphere_pairs", "touching_pairs", "face_pairs"] {
                assert_eq!(step[counted], lockstep["steps"][i][counted], "{name}, {counted}");
            }
            let work = &step["gpu"];
            let count = |name: &str| work[name].as_u64().unwrap();
            assert!(count("dispatches") > 10 && count("dispatches") >= count("indirect"));
            assert!(count("submissions") > 0 && count("passes") > 0 && count("copies") > 0);
            assert!(count("uploaded_bytes") > 0 && count("memory_bytes") > 100_000);
            let pairs = &work["lists"]["sphere_pairs"];
            assert_eq!(pairs["length"], step["sphere_pairs"]);
            assert!(pairs["capacity"].as_u64() >= pairs["length"].as_u64());
        }
    }
    let read_back = |record: &Value| record["steps"][4]["gpu"]["read_back_bytes"].as_u64().unwrap();
    assert_eq!(read_back(lockstep), read_back(latent));
    assert!(100 * read_back(resident) < read_back(latent));
    assert!(latent["steps"][4]["kinetic_energy"].is_number());
    assert!(resident["steps"][4]["kinetic_energy"].is_null());
}

fn check(_: &Gpu) {
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    for name in ["torus.obj", "knot.obj", "cube.obj"] {
        fs::copy(assets.join(name), folder.path().join(name)).unwrap();
    }
    let scene = r#"(
        meshes: {"torus": "torus.obj", "knot": "knot.obj", "cube": "cube.obj"},
        bodies: [
            (mesh: "torus"),
            (mesh: "knot", translation: (0.31, 0.17, 0.05), rotation: (0.18, 0.36, 0.0, 0.91)),
            (mesh: "cube", translation: (5.0, 0.0, 0.0), scale: (3.0, 3.0, 3.0)),
            (mesh: "torus", translation: (5.03, 0.02, 0.01), scale: (0.5, -0.5, 0.5)),
            (mesh: "cube", translation: (20.0, 0.0, 0.0)),
        ],
    )"#;
    fs::write(folder.path().join("scene.ron"), scene).unwrap();
    let on = |backend| {
        run(
            folder.path(),
            &["check", "scene.ron", "--faces", "--json", "-", "--backend", backend],
        )
    };
    let cpu = on("cpu");
    assert_eq!(cpu, on("gpu"));
    let pairs = cpu["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 2);
    assert_eq!(pairs[1]["contained"], true, "a torus in a cube");
}
