//! Every reader, and pairs of random meshes, under mutated input: see [`targets`]. The seeds of the random numbers are
//! fixed. `fuzz/run` runs the same targets guided by coverage.

#[path = "../common/gltf_files.rs"]
mod gltf_files;
mod mutate;
#[path = "../common/oracle/mod.rs"]
mod oracle;
mod pairs;
#[path = "../common/ply_files.rs"]
mod ply_files;
mod seeds;
#[path = "../common/stl_files.rs"]
mod stl_files;
mod targets;

use mutate::Mutator;

/// Runs a target on its seeds and on so many mutations of them.
fn fuzz(name: &str, times: usize) {
    let target = targets::named(name);
    let seeds = seeds::of(name);
    assert!(!seeds.is_empty(), "{name} has no seeds");
    seeds.iter().for_each(|seed| target(seed));
    let mut mutator = Mutator::new(1);
    for _ in 0..times {
        target(&mutator.mutated(&seeds));
    }
}

/// At least every tenth input must have led to something that touches, else the target would have proved nothing.
fn require_touches(name: &str, times: u64) {
    let touches = pairs::TOUCHES.take();
    println!("{name}: {touches} touches of {times} inputs");
    assert!(touches > times / 10, "{name}: {touches} touches of {times} inputs");
}

#[test]
fn readers() {
    for name in targets::READERS {
        fuzz(name, 5000);
    }
}

#[test]
fn seeds_of_readers_are_valid() {
    for name in targets::READERS {
        assert!(seeds::of(name).iter().all(|seed| targets::reads(name, seed)), "{name}");
    }
}

#[test]
fn faces_of_random_meshes() {
    fuzz("faces", 20_000);
    require_touches("faces", 20_000);
}

#[test]
fn contacts_of_random_meshes() {
    fuzz("contacts", 5000);
    require_touches("contacts", 5000);
}

#[test]
fn steps_of_random_bodies() {
    fuzz("step", 5000);
    require_touches("step", 5000);
}
