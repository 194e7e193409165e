//! The table of physics on standard output.

use super::world::Engine;
use super::{Case, Outcome};
use crate::engine::THREADS;
use crate::report::Machine;

/// Prints a row for each case.
pub fn print(rows: &[(Case, Vec<Outcome>)], machine: &Machine, versions: &[(&'static str, String)]) {
    let versions: Vec<String> = versions
        .iter()
        .filter(|(name, _)| ["bevy_faceoff", "parry3d", "rapier3d"].contains(name))
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
    println!(
        "| case | measured | ours | ms a step | rapier3d, meshes | ms a step | rapier3d, other shapes | ms a step |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (case, outcomes) in rows {
        let mut cells = vec![case.name.clone(), case.quantity.into()];
        for k in 0..3 {
            let Some(Outcome {
                engine,
                verdict,
                milliseconds,
            }) = outcomes.get(k)
            else {
                cells.extend([String::new(), String::new()]);
                continue;
            };
            let shapes = match engine {
                Engine::Ours | Engine::Meshes => "",
                Engine::Primitives => "primitives: ",
                Engine::Parts => "convex parts: ",
            };
            let time = if milliseconds.is_nan() {
                String::new()
            } else {
                format!("{milliseconds:.3}")
            };
            cells.extend([format!("{shapes}{verdict}"), time]);
        }
        println!("| {} |", cells.join(" | "));
    }
}
