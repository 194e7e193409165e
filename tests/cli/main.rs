//! The command line, run as a process.

mod bake;
mod check;
mod inspect;
mod library;
mod output;
mod picture;
mod repair;
mod reproduce;
mod shards;
mod simulate;

use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder for one test, in which the command runs.
struct Folder(TempDir);

/// What a run left behind.
struct Run {
    stdout: String,
    stderr: String,
    success: bool,
}

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// Copies one of the project's assets.
    fn asset(&self, name: &str) {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
        self.write(name, fs::read(assets.join(name)).unwrap());
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_faceoff"));
        command.args(arguments).current_dir(self.0.path());
        command
    }

    fn run(&self, arguments: &[&str]) -> Run {
        let output = self
            .command(arguments)
            // With a GPU, a layer of Mesa's complains on standard error if there is none.
            .env("XDG_RUNTIME_DIR", self.0.path())
            .timeout(std::time::Duration::from_secs(300))
            .output()
            .unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Run {
            stdout: text(output.stdout),
            stderr: text(output.stderr),
            success: output.status.success(),
        }
    }

    /// A run that succeeds in silence on standard error.
    #[track_caller]
    fn good(&self, arguments: &[&str]) -> String {
        let run = self.run(arguments);
        assert!(run.success, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stderr, "", "{arguments:?}");
        run.stdout
    }

    /// A run that fails with an error that has all these words, and nothing a user need not see.
    #[track_caller]
    fn bad(&self, arguments: &[&str], words: &[&str]) -> Run {
        let run = self.run(arguments);
        assert!(!run.success, "{arguments:?} succeeds: {}", run.stdout);
        assert!(run.stderr.starts_with("error: "), "{}", run.stderr);
        for word in words {
            assert!(
                run.stderr.contains(word),
                "{arguments:?}: no {word:?} in {}",
                run.stderr
            );
        }
        for noise in ["panicked", "backtrace", "RUST_", "thread '"] {
            assert!(!run.stderr.contains(noise), "{}", run.stderr);
        }
        run
    }
}

#[test]
fn every_command_explains_itself() {
    let folder = Folder::new();
    for (arguments, words) in [
        (vec!["--help"], vec!["simulate", "check", "bake"]),
        (
            vec!["simulate", "--help"],
            vec![
                "--shape",
                "--bodies",
                "--steps",
                "--seed",
                "--threads",
                "--response",
                "--json",
            ],
        ),
        (vec!["check", "--help"], vec!["SCENE", "meshes:", "--faces", "--json"]),
        (
            vec!["bake", "--help"],
            vec![
                "--output",
                "--faces",
                "--degrees",
                "--image",
                "--force",
                "--shard",
                "--memory",
                "--threads",
                "--json",
            ],
        ),
        (
            vec!["repair", "--help"],
            vec![
                "--output",
                "--in-place",
                "--weld",
                "--drop",
                "--split",
                "--orient",
                "--close-holes",
                "--json",
            ],
        ),
        (vec!["--version"], vec![env!("CARGO_PKG_VERSION")]),
    ] {
        let help = folder.good(&arguments);
        for word in words {
            assert!(help.contains(word), "{arguments:?}: no {word} in {help}");
        }
    }
}

#[test]
fn unknown_commands_and_options_are_refused() {
    let folder = Folder::new();
    folder.bad(&["dance"], &["dance"]);
    folder.bad(&["simulate", "--colour", "red"], &["--colour"]);
    folder.bad(&["simulate", "--culling", "psychic"], &["psychic", "exact"]);
    folder.bad(&["simulate", "--backend", "abacus"], &["abacus", "cpu"]);
    folder.bad(&["check"], &["SCENE"]);
    folder.bad(&["bake", "--output", "out"], &["MESHES"]);
    folder.bad(&["bake", "torus.obj"], &["--output"]);
    folder.bad(&["repair", "torus.obj"], &["--output"]);
    folder.bad(&["repair", "torus.obj", "-o", "a.obj", "--in-place"], &["--in-place"]);
    folder.bad(&["repair", "torus.obj", "-o", "a.obj", "--close-holes", "-1"], &["-1"]);
    assert!(!folder.run(&[]).success);
}

#[test]
fn a_wrong_command_line_has_an_exit_code_of_its_own() {
    let folder = Folder::new();
    folder.asset("torus.obj");
    for (arguments, code) in [
        (&["bake", "torus.obj", "-o", "out", "--degrees", "7"][..], 2),
        (&["bake", "torus.obj", "-o", "out", "--weld-tolerance", "5"], 2),
        (&["image", "torus.obj", "--image", "0", "-o", "o.png"], 2),
        (&["image", "torus.obj", "-o", "o.jpg"], 2),
        (&["repair", "torus.obj", "-o", "o.txt"], 2),
        (&["repair", "torus.obj", "-o", "o.obj", "--weld=5"], 2),
        (&["repair", "torus.obj", "-o", "torus.obj"], 2),
        (&["simulate", "--bodies", "99999999999"], 2),
        (&["simulate", "--scene", "stack", "--side", "3"], 2),
        (&["simulate", "--speed=-1"], 2),
        (&["dance"], 2),
        (&["bake", "none.obj", "-o", "out"], 1),
        (&["repair", "none.obj", "-o", "o.obj"], 1),
    ] {
        folder.command(arguments).assert().code(code);
    }
}
