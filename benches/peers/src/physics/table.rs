//! The table of physics on standard output.

use super::world::Engine;
use super::{Case, Outcome};
use crate::engine::THREADS;
use crate::report::Machine;

/// Prints a row for each case.
pub fn print(
    engines: &[Engine],
    rows: &[(Case, Vec<Outcome>)],
    machine: &Machine,
    versions: &[(&'static str, String)],
) {
    let mut columns: Vec<&str> = Vec::new();
    for &engine in engines {
        if !columns.contains(&column(engine)) {
            columns.push(column(engine));
        }
    }
    let library = |name: &str| name == "bevy_faceoff" || columns.iter().any(|column| column.starts_with(name));
    let versions: Vec<String> = versions
        .iter()
        .filter(|(name, _)| library(name) || *name == "parry3d" && library("rapier3d"))
        .map(|(name, version)| format!("{name} {version}"))
        .collect();
    println!(
        "{}; {}, {} cores, load {} before and {} after; {THREADS} threads for each engine; steps of 1/64 s, ms are means\n",
        versions.join(", "),
        machine.cpu,
        machine.cores,
        machine.load[0],
        machine.load[1],
    );
    println!("| case | measured | {} | ms a step |", columns.join(" | ms a step | "));
    println!("|---|---|{}", "---|---|".repeat(columns.len()));
    for (case, outcomes) in rows {
        let mut cells = vec![case.name.clone(), case.quantity.into()];
        for name in &columns {
            let outcome = outcomes.iter().find(|outcome| column(outcome.engine) == *name);
            cells.extend(outcome.map_or([String::new(), String::new()], Outcome::cells));
        }
        println!("| {} |", cells.join(" | "));
    }
}

/// The heading of an engine's column.
fn column(engine: Engine) -> &'static str {
    match engine {
        Engine::Ours => "ours",
        Engine::Meshes => "rapier3d, meshes",
        Engine::Primitives | Engine::Parts => "rapier3d, other shapes",
        Engine::RapierFaceoff => "rapier3d, parry_faceoff",
        Engine::RapierFaceoffFresh => "the same, contacts not recycled",
        Engine::Avian => "avian3d, meshes",
        Engine::AvianFaceoff => "avian3d, avian_faceoff",
    }
}

impl Outcome {
    /// What is measured, and the time.
    fn cells(&self) -> [String; 2] {
        let shapes = match self.engine {
            Engine::Primitives => "primitives: ",
            Engine::Parts => "convex parts: ",
            _ => "",
        };
        let time = if self.milliseconds.is_nan() {
            String::new()
        } else {
            format!("{:.3}", self.milliseconds)
        };
        [format!("{shapes}{}", self.verdict), time]
    }
}
