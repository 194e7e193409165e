//! The beginning of a step: sleeping bodies, the numbers of collision substeps, and speculative margins.

use super::memory::StepMemory;
use super::scratch::StepScratch;
use crate::solver::apply_impulses;
use crate::solver::speeds::Speeds;
use crate::state::crowd::Crowd;
use crate::state::margins::SpeculativeMargins;
use crate::state::{StepInput, StepResults};
use crate::types::settings::Response;

/// Prepares the first collision substep.
pub(super) fn begin(input: &mut StepInput, memory: &StepMemory, results: &mut StepResults, scratch: &mut StepScratch) {
    scratch.age(results);
    input.bodies.list_movers();
    scratch.schedule.set_all(1);
    results.crowd = Crowd::default();
    scratch.most_near_pairs = None;
    scratch.near_in_step.clear();
    if input.config.response != Response::Contacts {
        scratch.inactive.clear();
        results.asleep.clear();
    }
    scratch.touches.clear();
    scratch.ccd.clear();
    scratch.margins = match input.config.response {
        Response::Impulse => {
            results.manifolds.clear();
            SpeculativeMargins::None
        }
        Response::None => SpeculativeMargins::AtRest,
        Response::Contacts => {
            apply_impulses(&mut input.bodies);
            let speeds = load_bodies(input, memory, scratch);
            let drift = speeds.drift();
            let config = input.config;
            let most = speeds.collision_substeps(&config.solver, &scratch.solver_bodies, config.dt);
            if most > 1 {
                let StepScratch {
                    reach,
                    schedule,
                    solver_bodies,
                    near_in_step,
                    ..
                } = scratch;
                schedule.set_each(reach.collision_substeps(input, solver_bodies, drift, near_in_step));
            }
            SpeculativeMargins::Moving { drift }
        }
    };
    results.collision_substeps = scratch.schedule.most();
    results.mean_collision_substeps = scratch.schedule.mean();
    scratch.schedule.begin(0, &input.config, &mut input.bodies);
    scratch.margins.set_speculative_radii(&mut input.bodies, &input.config);
}

/// Loads the bodies into the solver, restores their state from the last step, and returns the bounds of their speeds.
fn load_bodies(input: &StepInput, memory: &StepMemory, scratch: &mut StepScratch) -> Speeds {
    let StepScratch {
        keys,
        solver_bodies,
        inactive,
        ..
    } = scratch;
    let is_known = solver_bodies.revision().is(input.bodies.revision);
    input.write_keys(keys, if is_known { input.bodies.static_count } else { 0 });
    solver_bodies.read(&input.bodies, &input.planes, keys);
    memory.restore(input, solver_bodies, inactive);
    Speeds::of(solver_bodies, input.config.dt, |_| false)
}
