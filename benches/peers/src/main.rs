//! Compares the speed of bevy_faceoff, parry3d, rapier3d and avian3d on the scenes of the paper:
//! `cargo run --release --manifest-path benches/peers/Cargo.toml`.
//!
//! With `--queries` it compares queries of one mesh: rays against a large terrain, overlaps and casts.
//!
//! With `--levels` it compares steps of worlds in which nearly everything is static or asleep.
//!
//! With `--crowds` it compares steps of balls and capsules that fall into a bin.
//!
//! With `--physics` it compares the accuracy of the motion instead: in bevy_faceoff, rapier3d and avian3d, the last two
//! also with our contacts.
//!
//! Times of first hits are printed only if the answers agree, or if a slow independent test confirms bevy_faceoff where
//! they disagree. Each disagreement is printed.

mod avian;
mod crowds;
mod engine;
mod judge;
mod levels;
mod manifolds;
mod narrow;
mod ours;
mod parry;
mod physics;
mod queries;
mod rapier;
mod report;
mod scene;
mod steps;
mod timing;

use clap::{Parser, ValueEnum};
use engine::Kind;
use report::{Machine, Report};
use scene::{Choice, Scene, Shape};
use std::error::Error;
use std::path::PathBuf;
use std::time::Duration;

/// Measure bevy_faceoff, parry3d, rapier3d and avian3d, and print tables in Markdown.
#[derive(Parser)]
struct Options {
    /// Compare only with these.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "parry,rapier,avian")]
    only: Vec<Peer>,
    /// Run only these scenes.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "torus,knot")]
    shape: Vec<Shape>,
    /// Number of bodies; the box grows with it.
    #[arg(long, default_value_t = 2200)]
    bodies: usize,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Coefficient of restitution of bodies and walls in whole steps.
    #[arg(long, default_value_t = 1.0)]
    restitution: f32,
    /// Number of rounds of the narrow phase [default: 15, or 3 with --quick].
    #[arg(long)]
    rounds: Option<usize>,
    /// Number of whole steps [default: 64, or 8 with --quick].
    #[arg(long)]
    steps: Option<usize>,
    /// Time limit in seconds for all steps of an engine in a scene [default: 180, or 20 with --quick].
    #[arg(long)]
    limit: Option<u64>,
    /// Run only a few rounds and steps, in about a minute.
    #[arg(long)]
    quick: bool,
    /// Write all times and counts as JSON to this file.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Compare queries of one mesh instead, in ours, parry3d and obvhs.
    #[arg(long)]
    queries: bool,
    /// Compare steps of levels instead: ten bodies that fall beside thousands of static or sleeping ones.
    #[arg(long)]
    levels: bool,
    /// Compare crowds of balls and capsules in a bin instead.
    #[arg(long)]
    crowds: bool,
    #[command(flatten)]
    physics: physics::Options,
    /// Run as the process of an engine.
    #[arg(long, value_enum, hide = true)]
    serve: Option<Kind>,
}

/// The libraries to compare with, by what is compared.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Peer {
    /// Narrow and broad phase.
    Parry,
    /// Whole steps, with its own contacts and those of parry_faceoff.
    Rapier,
    /// Whole steps, with its own contacts and those of avian_faceoff.
    Avian,
}

impl Options {
    fn choice(&self, shape: Shape) -> Choice {
        Choice {
            shape,
            bodies: self.bodies,
            seed: self.seed,
            restitution: self.restitution,
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    if let Some(kind) = options.serve {
        engine::serve(kind, &Scene::new(&options.choice(options.shape[0])));
        return Ok(());
    }
    let default = |long, quick| if options.quick { quick } else { long };
    let rounds = options.rounds.unwrap_or(default(15, 3));
    let steps = options.steps.unwrap_or(default(64, 8));
    let limit = Duration::from_secs(options.limit.unwrap_or(default(180, 20) as u64));
    if options.physics.physics {
        physics::compare(&options.physics, options.quick, limit);
        return Ok(());
    }
    if options.crowds {
        crowds::compare();
        return Ok(());
    }
    if options.levels {
        levels::compare();
        return Ok(());
    }
    if options.queries {
        queries::compare(rounds);
        return Ok(());
    }
    let kinds = [
        (Peer::Rapier, Kind::Rapier),
        (Peer::Rapier, Kind::RapierFaceoff),
        (Peer::Avian, Kind::Avian),
        (Peer::Avian, Kind::AvianFaceoff),
    ];
    let engines: Vec<Kind> = kinds
        .into_iter()
        .filter(|(peer, _)| options.only.contains(peer))
        .map(|(_, kind)| kind)
        .collect();

    let mut report = Report {
        machine: Machine::here(),
        versions: report::versions(),
        bodies: options.bodies,
        seed: options.seed,
        narrow: Vec::new(),
        manifolds: Vec::new(),
        steps: Vec::new(),
    };
    for &shape in &options.shape {
        if options.only.contains(&Peer::Parry) {
            eprintln!("{}: narrow phase ..", shape.name());
            let scene = Scene::new(&options.choice(shape));
            report.narrow.push(narrow::measure(shape, &scene, rounds));
            eprintln!("{}: manifolds ..", shape.name());
            let pairs = narrow::sphere_pairs(&scene);
            report
                .manifolds
                .extend(manifolds::measure(shape, &scene, &pairs, rounds));
        }
        if !engines.is_empty() {
            eprintln!("{}: whole steps ..", shape.name());
            report
                .steps
                .push((shape, steps::measure(&engines, &options.choice(shape), steps, limit)?));
        }
    }
    report.machine.finish();
    report.print();
    if let Some(path) = &options.json {
        std::fs::write(path, serde_json::to_string_pretty(&report)?)?;
    }
    if report.is_our_fault() {
        return Err("bevy_faceoff errs on a pair that a peer gets right: see the disputes above".into());
    }
    Ok(())
}
