//! The step on the CPU.

use super::dynamics;
use crate::state::StepState;
use crate::types::settings::Response;
use crate::types::stage::Stage;
use crate::{angles, broad_phase, force_scan, integrate, manifolds, triangle_test};
use std::time::{Duration, Instant};

/// Runs a stage on rayon's current thread pool, and notes how long it took.
///
/// A step begins with the first stage and ends with the last one, which goes on with all stages for the other detection
/// intervals, if there are any.
pub fn run(stage: Stage, state: &mut StepState) {
    if stage == Stage::BroadPhase {
        dynamics::begin(state);
    }
    state.times[stage as usize] = run_once(stage, state);
    if stage == Stage::Integrate {
        for _ in 1..state.dynamics.intervals() {
            // What the triangle test reports is meant for the beginning of the step.
            for stage in Stage::ALL.into_iter().filter(|&stage| stage != Stage::TriangleTest) {
                let time = run_once(stage, state);
                state.times[stage as usize] += time;
            }
        }
        dynamics::end(state);
    }
}

fn run_once(stage: Stage, state: &mut StepState) -> Duration {
    let start = Instant::now();
    match stage {
        Stage::BroadPhase => broad_phase::cpu::run(state),
        Stage::Angles => angles::cpu::run(state),
        Stage::TriangleTest => triangle_test::cpu::run(state),
        Stage::Manifolds => manifolds::step::run(state),
        Stage::ForceScan if state.config.response == Response::Contacts => dynamics::solve(state),
        Stage::ForceScan => force_scan::cpu::run(state),
        Stage::Integrate if state.config.response == Response::Contacts => dynamics::move_bodies(state),
        Stage::Integrate => integrate::cpu::run(state),
    }
    start.elapsed()
}
