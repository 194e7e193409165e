//! How well bodies of meshes behave, in bevy_faceoff and in rapier3d: errors and times side by side.
//!
//! Both move the same bodies of the same masses, frictions and restitutions through the same steps, and neither lets them
//! sleep. What is judged is where bodies are and how they move, by code that knows no engine.

mod avian;
mod bounce;
mod chain;
mod cloud;
mod incline;
mod mass;
mod motion;
mod ours;
mod overlap;
mod pour;
mod rapier;
mod rest;
mod spin;
mod table;
mod world;

use crate::report::{Machine, versions};
use bevy_faceoff::testing::scenes::Scene;
use clap::Args;
use std::time::Duration;
use world::{Engine, Run};

/// Steps per second.
const HZ: usize = 64;

/// Sizes of the comparison of physics.
#[derive(Args)]
pub struct Options {
    /// Compare how well bodies behave, in ours and in rapier3d, instead of times on the paper's scenes; a few minutes,
    /// or half a minute with --quick. Of the other options --limit and --quick hold: --limit is for each case and engine.
    #[arg(long)]
    pub physics: bool,
    /// Only cases whose names contain this.
    #[arg(long, default_value = "", hide_default_value = true)]
    case: String,
    /// Only these engines. rapier3d's primitives or convex parts run in the cases that have them.
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        default_value = "ours,meshes,primitives,parts"
    )]
    engines: Vec<Engine>,
    /// How balls are turned at random, so many times each, before they bounce [default: 12, or 3 with --quick].
    #[arg(long)]
    turns: Option<usize>,
    /// Knots in flight [default: 60, or 20 with --quick].
    #[arg(long)]
    flying: Option<usize>,
    /// Rings of each chain [default: 10,50, or 10 with --quick].
    #[arg(long, value_delimiter = ',')]
    rings: Option<Vec<usize>>,
    /// Knots poured into each bin [default: 40,100, or 12 with --quick].
    #[arg(long, value_delimiter = ',')]
    poured: Option<Vec<usize>>,
}

/// A row of the table.
struct Case {
    name: String,
    /// What is measured.
    quantity: &'static str,
    /// Steps of each scene.
    steps: usize,
    /// rapier's other shapes, if there are any.
    other: Option<Engine>,
    /// The scenes, in which bodies at rest begin so far apart, as a part of their diameter.
    scenes: Box<dyn Fn(f32) -> Vec<Scene>>,
    /// What is wrong with what became of them. None of the runs is empty, and if one is complete, all are.
    judge: Box<dyn Fn(&[Run]) -> String>,
}

/// What an engine made of a case.
struct Outcome {
    engine: Engine,
    verdict: String,
    /// Mean over all steps; NaN if there was none.
    milliseconds: f64,
}

/// Runs all cases and prints the table.
pub fn compare(options: &Options, quick: bool, limit: Duration) {
    let default = |long, short| if quick { short } else { long };
    let turns = options.turns.unwrap_or(default(12, 3)).max(1);
    let flying = options.flying.unwrap_or(default(60, 20)).max(2);
    let list = |given: &Option<Vec<usize>>, long: &[usize], short: usize| match given {
        Some(given) => given.clone(),
        None if quick => vec![short],
        None => long.to_vec(),
    };
    let mut cases = bounce::cases(turns);
    cases.extend(cloud::cases(flying));
    cases.extend(rest::cases());
    cases.extend(incline::cases(turns.div_ceil(2)));
    cases.extend(spin::cases());
    cases.extend(list(&options.rings, &[10, 50], 10).into_iter().map(chain::case));
    cases.extend(list(&options.poured, &[40, 100], 12).into_iter().map(pour::case));
    cases.retain(|case| case.name.contains(&options.case));

    let mut machine = Machine::here();
    let mut rows = Vec::new();
    for case in cases {
        eprintln!("{} ..", case.name);
        let outcomes = case.run(&options.engines, limit);
        for outcome in &outcomes {
            let Outcome { engine, verdict, .. } = outcome;
            eprintln!("    {engine:?}: {verdict} ({:.3} ms a step)", outcome.milliseconds);
        }
        rows.push((case, outcomes));
    }
    machine.finish();
    table::print(&options.engines, &rows, &machine, &versions());
}

impl Case {
    fn run(&self, engines: &[Engine], limit: Duration) -> Vec<Outcome> {
        let others = [Engine::Primitives, Engine::Parts];
        let takes_part = |engine: &Engine| !others.contains(engine) || self.other == Some(*engine);
        let engines: Vec<Engine> = engines.iter().copied().filter(takes_part).collect();
        let mut limits = vec![limit; engines.len()];
        let mut runs: Vec<Vec<Run>> = engines.iter().map(|_| Vec::new()).collect();
        let scenes: Vec<Vec<Scene>> = engines.iter().map(|e| (self.scenes)(e.gap())).collect();
        for k in 0..scenes[0].len() {
            let contest = engines.iter().zip(&scenes).map(|(&e, scenes)| (e, scenes[k].clone()));
            for (run, all) in world::run(contest.collect(), self.steps, &mut limits)
                .into_iter()
                .zip(&mut runs)
            {
                all.push(run);
            }
        }
        engines
            .into_iter()
            .zip(runs)
            .map(|(engine, runs)| self.outcome(engine, runs))
            .collect()
    }

    fn outcome(&self, engine: Engine, mut runs: Vec<Run>) -> Outcome {
        let seconds: Vec<f64> = runs.iter().flat_map(|run| run.seconds.iter().copied()).collect();
        let failures: Vec<String> = runs.iter().filter_map(|run| run.failure.clone()).collect();
        let count = runs.len();
        // If some runs are complete, they alone are judged: they tell more, and the scenes are alike.
        if failures.len() < count {
            runs.retain(|run| run.failure.is_none());
        }
        runs.retain(|run| !run.seconds.is_empty());
        let mut verdict = match runs.is_empty() {
            true => String::new(),
            false => (self.judge)(&runs),
        };
        if let Some(failure) = failures.first() {
            let which = if count > 1 {
                format!("{} of {count} scenes: ", failures.len())
            } else {
                String::new()
            };
            let comma = if verdict.is_empty() { "" } else { "; " };
            verdict = format!("{verdict}{comma}**{which}{failure}**");
        }
        Outcome {
            engine,
            verdict,
            milliseconds: 1e3 * seconds.iter().sum::<f64>() / seconds.len() as f64,
        }
    }
}

fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value;
        count += 1.0;
    }
    sum / count
}
