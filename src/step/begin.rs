//! The beginning of a step: sleeping bodies, the numbers of collision substeps, and speculative margins.

use super::memory::StepMemory;
use super::scratch::StepScratch;
use crate::solver::apply_impulses;
use crate::solver::speeds::Speeds;
use crate::state::crowd::Crowd;
use crate::state::margins::SpeculativeMargins;
use crate::state::{StepInput, StepResults};
use crate::types::settings::Response;
use glam::Vec3;

/// Prepares the first collision substep.
pub(super) fn begin(
    input: &mut StepInput,
    memory: &mut StepMemory,
    results: &mut StepResults,
    scratch: &mut StepScratch,
) {
    scratch.age(results);
    if let Err(met) = scratch.dormant.begin(input, memory, results) {
        scratch.rouse(met, 0, input, memory, results);
    }
    input.bodies.list_movers();
    scratch.schedule.set_all(1);
    results.crowd = Crowd::default();
    results.searches = 0;
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
            let mut speeds = load_bodies(input, memory, scratch);
            if speeds.drift() != Vec3::ZERO && !input.bodies.dormant.flags.is_empty() {
                // Margins of bodies at rest depend on it.
                scratch.dormant.end(&mut input.bodies, memory, results);
                input.bodies.list_movers();
                speeds = load_bodies(input, memory, scratch);
            }
            let drift = speeds.drift();
            let config = input.config;
            let most = speeds.collision_substeps(&config.solver, &scratch.solver_bodies, config.dt);
            if most > 1 {
                divide(input, memory, results, scratch, drift);
            }
            SpeculativeMargins::Moving { drift }
        }
    };
    results.collision_substeps = scratch.schedule.most();
    results.mean_collision_substeps = scratch.schedule.mean(&input.bodies);
    scratch.schedule.begin(0, &input.config, &mut input.bodies);
    scratch.margins.set_speculative_radii(&mut input.bodies, &input.config);
    scratch.dormant.watch(input, &scratch.solver_bodies, &scratch.inactive);
}

/// Gives each body its number of collision substeps. `drift` is the velocity that bodies have in common, m/s.
fn divide(
    input: &mut StepInput,
    memory: &mut StepMemory,
    results: &mut StepResults,
    scratch: &mut StepScratch,
    drift: Vec3,
) {
    loop {
        let StepScratch {
            reach,
            schedule,
            solver_bodies,
            near_in_step,
            dormant,
            ..
        } = scratch;
        let Err(met) = reach.search(input, solver_bodies, drift, near_in_step, dormant) else {
            schedule.set_each(reach.collision_substeps(&input.bodies));
            return;
        };
        scratch.rouse(met, 0, input, memory, results);
    }
}

/// Loads the bodies into the solver, restores their state from the last step, and returns the bounds of their speeds.
fn load_bodies(input: &StepInput, memory: &StepMemory, scratch: &mut StepScratch) -> Speeds {
    let StepScratch {
        keys,
        solver_bodies,
        inactive,
        ..
    } = scratch;
    let known = input
        .bodies
        .same_since(solver_bodies.revision(), solver_bodies.layout());
    input.write_keys(keys, known);
    solver_bodies.read(&input.bodies, &input.planes, keys);
    memory.restore(input, solver_bodies, inactive);
    Speeds::of(solver_bodies, input.config.dt, |_| false)
}
