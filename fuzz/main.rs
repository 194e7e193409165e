//! The targets of `tests/fuzz`, guided by coverage. `run` builds and starts it.

#![no_main]

#[path = "../tests/common/gltf_files.rs"]
mod gltf_files;
#[path = "../tests/common/oracle/mod.rs"]
mod oracle;
#[path = "../tests/fuzz/pairs.rs"]
mod pairs;
#[path = "../tests/common/ply_files.rs"]
mod ply_files;
#[path = "../tests/fuzz/seeds.rs"]
mod seeds;
#[path = "../tests/common/stl_files.rs"]
mod stl_files;
#[path = "../tests/fuzz/targets.rs"]
mod targets;

use std::env::var;

thread_local! {
    static TARGET: Box<dyn Fn(&[u8])> = targets::named(&var("FACEOFF_FUZZ").expect("FACEOFF_FUZZ names the target"));
}

/// Writes the seeds of the target into its corpus.
fn write_seeds() {
    let (Ok(name), Ok(folder)) = (var("FACEOFF_FUZZ"), var("FACEOFF_FUZZ_CORPUS")) else {
        return;
    };
    for (i, seed) in seeds::of(&name).iter().enumerate() {
        std::fs::write(format!("{folder}/seed{i}"), seed).expect("the corpus can be written");
    }
}

libfuzzer_sys::fuzz_target!(init: write_seeds(), |bytes: &[u8]| TARGET.with(|target| target(bytes)));
