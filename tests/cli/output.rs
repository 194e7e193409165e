//! What a command gives out reaches its reader, or the command fails.

use crate::Folder;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn command(folder: &Folder, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_faceoff"));
    command
        .args(arguments)
        .current_dir(folder.path("."))
        // A Vulkan driver may complain on standard error if there is none.
        .env("XDG_RUNTIME_DIR", folder.path("."));
    command
}

/// A folder with a mesh and a scene of two bodies.
fn scene() -> Folder {
    let folder = Folder::new();
    folder.asset("cube.obj");
    folder.write(
        "scene.ron",
        r#"(meshes: {"cube": "cube.obj"}, bodies: [(mesh: "cube"), (mesh: "cube", translation: (0.5, 0.1, 0.2))])"#,
    );
    folder
}

/// All that print to standard output.
const PRINT: [&[&str]; 12] = [
    &["simulate", "--bodies", "2", "--steps", "1"],
    &["simulate", "--bodies", "2", "--steps", "1", "--json", "-"],
    &["check", "scene.ron"],
    &["check", "scene.ron", "--json", "-"],
    &["bake", "cube.obj", "-o", "out"],
    &["inspect", "cube.obj"],
    &["inspect", "cube.obj", "--json"],
    &["image", "cube.obj", "--image", "16", "-o", "-"],
    &["repair", "cube.obj", "-o", "new.obj"],
    &["repair", "cube.obj", "-o", "-"],
    &["repair", "cube.obj", "-o", "new.obj", "--json", "-"],
    &["simulate", "--help"],
];

#[test]
#[cfg(target_os = "linux")]
fn output_that_is_lost_is_an_error() {
    let folder = scene();
    let full = || File::options().write(true).open("/dev/full").unwrap();
    for arguments in PRINT {
        let output = command(&folder, arguments).stdout(full()).output().unwrap();
        assert!(!output.status.success(), "{arguments:?}");
        let stderr = String::from_utf8_lossy(&output.stderr);
        // The parser of arguments prints its help itself.
        if arguments[1] != "--help" {
            assert!(
                stderr.contains("error: cannot write to standard output"),
                "{arguments:?}: {stderr}"
            );
        }
    }
    assert!(folder.path("out/cube.faceoff").exists(), "what was baked is kept");
    // The table goes to standard error where the JSON takes standard output.
    let run = command(&folder, PRINT[3]).stderr(full()).output().unwrap();
    assert_eq!(run.status.code(), Some(1));
    for arguments in [
        ["check", "scene.ron", "--json", "/dev/full"],
        ["image", "cube.obj", "-o", "/dev/full"],
    ] {
        folder.bad(&arguments, &["cannot write /dev/full"]);
    }
}

/// A limit on the size of files fails like a full disk: in the middle of a file.
#[test]
#[cfg(unix)]
fn a_full_disk_is_an_error_and_leaves_nothing_half_written() {
    let folder = Folder::new();
    folder.asset("torus.obj");
    folder.good(&["bake", "torus.obj", "-o", "out"]);
    let before = folder.read("out/torus.faceoff");
    for (arguments, file) in [
        (&["bake", "torus.obj", "--force", "-o", "out"][..], "torus.faceoff"),
        (&["image", "torus.obj", "-o", "image.png"], "image.png"),
        (&["repair", "torus.obj", "-o", "new.obj"], "new.obj"),
        (
            &["simulate", "--bodies", "2", "--steps", "100", "--json", "steps.json"],
            "steps.json",
        ),
        (
            &[
                "simulate", "--bodies", "2", "--steps", "1", "--frames", "frames", "--every", "1",
            ],
            "frames/frame_",
        ),
    ] {
        let output = Command::new("sh")
            // One block of 512 or 1024 bytes. Without its signal the limit is an error like any other.
            .args([
                "-c",
                "trap '' XFSZ; ulimit -f 1; exec \"$@\"",
                "sh",
                env!("CARGO_BIN_EXE_faceoff"),
            ])
            .args(arguments)
            .current_dir(folder.path("."))
            .env("XDG_RUNTIME_DIR", folder.path("."))
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {stderr}");
        assert!(
            stderr.contains("error: cannot write") && stderr.contains(file),
            "{arguments:?}: {stderr}"
        );
    }
    assert_eq!(folder.read("out/torus.faceoff"), before, "the old file is kept");
    let names = |of: &str| -> Vec<_> {
        let files = std::fs::read_dir(folder.path(of)).unwrap();
        files.map(|file| file.unwrap().file_name()).collect()
    };
    assert_eq!(names("out"), ["torus.faceoff"]);
    assert!(names("frames").is_empty());
    assert!(!folder.path("image.png").exists() && !folder.path("steps.json").exists());
    assert_eq!(names(".").len(), 3, "{:?}", names("."));
}

#[test]
fn a_reader_that_has_enough_is_no_error() {
    let folder = scene();
    for arguments in PRINT {
        let mut child = command(&folder, arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success() && !stderr.contains("error"),
            "{arguments:?}: {stderr}"
        );
    }
    let mut child = command(&folder, PRINT[3])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap();
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort_unstable();
    names
}

#[test]
fn an_interrupted_run_leaves_the_old_json() {
    let folder = Folder::new();
    folder.write("out.json", "old");
    folder.write("frames/other", "");
    let mut child = command(
        &folder,
        &[
            "simulate",
            "--bodies",
            "2",
            "--steps",
            "100000000",
            "--json",
            "out.json",
            "--frames",
            "frames",
            "--every",
            "4",
        ],
    )
    .stdout(Stdio::null())
    .stderr(Stdio::null())
    .spawn()
    .unwrap();
    let start = Instant::now();
    // The first picture tells that it runs.
    while files(&folder.path("frames")).len() < 2 {
        assert!(start.elapsed() < Duration::from_secs(120), "it never begins");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(folder.read("out.json"), b"old");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(folder.read("out.json"), b"old");
    assert_eq!(files(&folder.path(".")), ["frames", "out.json"]);
}

#[test]
fn a_file_is_replaced_as_if_it_were_written() {
    let folder = scene();
    let check = ["check", "scene.ron", "--json", "out/pairs.json"];
    folder.write("out/pairs.json", "old");
    folder.good(&check);
    let written = folder.read("out/pairs.json");
    assert!(written.starts_with(b"{"));
    assert_eq!(files(&folder.path("out")), ["pairs.json"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let mode = |name: &str| folder.path(name).metadata().unwrap().permissions().mode() & 0o777;
        std::fs::set_permissions(folder.path("out/pairs.json"), PermissionsExt::from_mode(0o640)).unwrap();
        folder.good(&check);
        assert_eq!(mode("out/pairs.json"), 0o640);
        // A new file is like any other that the user makes.
        folder.write("usual", "");
        folder.good(&["check", "scene.ron", "--json", "new.json"]);
        assert_eq!(mode("new.json"), mode("usual"));
        // A link stays one, and a device stays where it is.
        symlink("pairs.json", folder.path("out/link.json")).unwrap();
        folder.write("out/pairs.json", "old");
        folder.good(&["check", "scene.ron", "--json", "out/link.json"]);
        assert_eq!(folder.read("out/pairs.json"), written);
        assert!(folder.path("out/link.json").is_symlink());
        folder.good(&["check", "scene.ron", "--json", "/dev/null"]);
        assert!(!Path::new("/dev/null").is_file());
    }
}

/// A folder with files that commands read.
fn inputs() -> Folder {
    let folder = scene();
    folder.write("cube.bake.ron", r#"(mesh: "cube.obj")"#);
    folder.write(
        "gm/mesh.gltf",
        r#"{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 3, "uri": "b.bin"}]}"#,
    );
    folder.write("gm/b.bin", "abc");
    folder.write("noext", folder.read("cube.obj"));
    folder
}

#[test]
fn no_output_is_written_over_what_the_command_reads_or_writes() {
    for (arguments, file) in [
        (&["bake", "cube.obj", "-o", "out", "--json", "cube.obj"][..], "cube.obj"),
        (
            &["bake", "cube.bake.ron", "-o", "out", "--json", "./cube.obj"],
            "cube.obj",
        ),
        (&["bake", "gm", "-o", "out", "--json", "gm/b.bin"], "gm/b.bin"),
        (
            &["bake", "cube.obj", "-o", "out", "--json", "out/cube.faceoff"],
            "out/cube.faceoff",
        ),
        (&["simulate", "--shape", "cube.obj", "--json", "cube.obj"], "cube.obj"),
        (
            &["simulate", "--shape", "cube.bake.ron", "--json", "cube.bake.ron"],
            "cube.bake.ron",
        ),
        (&["check", "scene.ron", "--json", "scene.ron"], "scene.ron"),
        (&["check", "scene.ron", "--json", "gm/../cube.obj"], "cube.obj"),
        (
            &["repair", "cube.obj", "-o", "same.obj", "--json", "same.obj"],
            "same.obj",
        ),
        (&["repair", "cube.obj", "--in-place", "--json", "cube.obj"], "cube.obj"),
        (
            &["repair", "gm/mesh.gltf", "-o", "o.obj", "--json", "gm/b.bin"],
            "gm/b.bin",
        ),
        (&["image", "noext", "-o", "noext"], "noext"),
    ] {
        let folder = inputs();
        let before = crate::library::files(&folder, ".");
        folder.bad(arguments, &[file, "give another name"]);
        assert_eq!(crate::library::files(&folder, "."), before, "{arguments:?}");
        folder.command(arguments).assert().code(2);
    }
}
