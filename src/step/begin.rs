//! The beginning of a step: who sleeps, how many collision substeps there are, how far bodies look for each other.

use super::memory::StepMemory;
use super::scratch::StepScratch;
use crate::solver::speeds::Speeds;
use crate::state::margins::SpeculativeMargins;
use crate::state::{StepInput, StepResults};
use crate::types::settings::Response;

/// Prepares the first interval.
pub(super) fn begin(input: &mut StepInput, memory: &StepMemory, results: &mut StepResults, scratch: &mut StepScratch) {
    results.collision_substeps = 1;
    results.asleep.clear();
    scratch.inactive.clear();
    scratch.touches.clear();
    scratch.stops.forget();
    scratch.margins = match input.config.response {
        Response::Impulse => {
            results.manifolds.clear();
            SpeculativeMargins::None
        }
        Response::None => SpeculativeMargins::AtRest,
        Response::Contacts => {
            let speeds = take_in(input, memory, scratch);
            let config = &input.config;
            results.collision_substeps = speeds.collision_substeps(&config.solver, &scratch.solver_bodies, config.dt);
            SpeculativeMargins::Moving {
                dt: config.per_collision_substep(results.collision_substeps).dt,
                drift: speeds.drift(),
            }
        }
    };
    scratch.margins.set_speculative_radii(&mut input.bodies, &input.config);
}

/// Gives the solver the bodies, with what is remembered of them, and tells how fast they are.
fn take_in(input: &StepInput, memory: &StepMemory, scratch: &mut StepScratch) -> Speeds {
    let StepScratch {
        keys,
        solver_bodies,
        inactive,
        ..
    } = scratch;
    input.write_keys(keys);
    solver_bodies.read(&input.bodies, &input.planes, keys);
    memory.recall(input, solver_bodies, inactive);
    Speeds::of(solver_bodies, |_| false)
}
