//! Time of whole steps: each engine runs in its own process, and their steps alternate.

use crate::engine::{Kind, Process, Step};
use crate::scene::Choice;
use serde::Serialize;
use std::collections::BTreeSet;
use std::time::Duration;

/// The run of one engine.
#[derive(Serialize)]
pub struct Run {
    /// The engine.
    pub engine: Kind,
    /// Seconds of each step.
    pub seconds: Vec<f64>,
    /// The number of pairs of bodies that touched in each step.
    pub touching: Vec<usize>,
    /// The highest kinetic energy as a multiple of that at the start, if it is looked at.
    pub energy: Option<f64>,
    /// Pairs in the first step, in which all engines have the same poses: those that both it and bevy_faceoff report,
    /// those that only bevy_faceoff reports, and those that only it reports.
    pub first: [usize; 3],
    /// Why it did not complete all steps, if so.
    pub failure: Option<String>,
    #[serde(skip)]
    first_pairs: BTreeSet<[u32; 2]>,
}

/// Runs bevy_faceoff and `peers` for `steps` steps.
pub fn measure(peers: &[Kind], world: &Choice, steps: usize, limit: Duration) -> std::io::Result<Vec<Run>> {
    let mut runs = Vec::new();
    for &engine in [Kind::Ours, Kind::Contacts].iter().chain(peers) {
        let run = Run {
            engine,
            seconds: Vec::new(),
            touching: Vec::new(),
            energy: None,
            first: [0; 3],
            failure: None,
            first_pairs: BTreeSet::new(),
        };
        runs.push((run, Some(Process::start(engine, world, limit)?)));
    }
    for _ in 0..steps {
        for (run, process) in &mut runs {
            let Some(running) = process else { continue };
            match running.step() {
                Ok(step) => run.add(step),
                Err(failure) => {
                    run.failure = Some(failure);
                    *process = None;
                }
            }
        }
    }
    let mut runs: Vec<Run> = runs.into_iter().map(|(run, _)| run).collect();
    let ours = runs[0].first_pairs.clone();
    for run in &mut runs {
        let both = run.first_pairs.intersection(&ours).count();
        run.first = [both, ours.len() - both, run.first_pairs.len() - both];
    }
    Ok(runs)
}

impl Run {
    fn add(&mut self, step: Step) {
        if self.seconds.is_empty() {
            self.first_pairs = step.touching.iter().copied().collect();
        }
        self.seconds.push(step.seconds);
        self.touching.push(step.touching.len());
        self.energy = step.energy.map(|energy| energy.max(self.energy.unwrap_or(0.0)));
    }
}
