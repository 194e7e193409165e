//! The table of physics on standard output.

use super::world::Engine;
use super::{Case, Outcome};
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
    let compared = |(name, _): &&(&'static str, String)| library(name) || *name == "parry3d" && library("rapier3d");
    let heading = machine.heading(versions.iter().filter(compared));
    println!("{heading}; steps of 1/64 s, ms are means\n");
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
