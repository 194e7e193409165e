//! The step on the CPU.
//!
//! Large stages run on a thread pool. Small ones run on the calling thread, because waking others would take longer.

use super::StepState;
use super::begin::begin;
use super::cost::is_small;
use super::crowds;
use super::hooks::{NoHooks, StepHooks, filter_pairs, modify_contacts};
use super::memory::StepMemory;
use super::order::{Part, SubstepPosition, parts_of};
use super::scratch::StepScratch;
use crate::manifolds::report::report_points;
use crate::state::crowd::Crowd;
use crate::state::{NearPair, Plane, StepInput, StepResults};
use crate::types::body::RigidBody;
use crate::types::settings::Response;
use crate::types::stage::Stage;
use crate::{angles, broad_phase, force_scan, integrate, manifolds, triangle_test};
use rayon::ThreadPool;
use web_time::Instant;

/// Runs a whole step.
pub fn run_all(step: &mut StepState) {
    for stage in Stage::ALL {
        run(stage, step);
    }
}

/// Runs a stage of the first collision substep on rayon's current thread pool, or the global one, and records its time.
///
/// The last stage also runs all stages of the other collision substeps, if there are any. So a step is complete when
/// all stages have run once, in order.
pub fn run(stage: Stage, step: &mut StepState) {
    run_with(stage, step, &mut NoHooks);
}

/// [`run`] with hooks.
pub fn run_with(stage: Stage, step: &mut StepState, hooks: &mut dyn StepHooks) {
    in_pool(stage, step, |step| run_here(stage, step, hooks));
}

/// Calls `f` in rayon's current thread pool, or in the global one if `stage` is not small.
fn in_pool<R: Send>(stage: Stage, step: &mut StepState, f: impl FnOnce(&mut StepState) -> R + Send) -> R {
    if rayon::current_thread_index().is_some() || is_small(stage, step) {
        f(step)
    } else {
        rayon::scope(|_| f(step))
    }
}

/// [`run_with`] on `pool`, or on this thread if there is none. Returns whether the stage needed the pool.
pub fn run_on(pool: Option<&ThreadPool>, stage: Stage, step: &mut StepState, hooks: &mut dyn StepHooks) -> bool {
    let pool = pool.filter(|_| !is_small(stage, step));
    match pool {
        Some(pool) => pool.install(|| run_here(stage, step, hooks)),
        None => run_here(stage, step, hooks),
    }
    pool.is_some()
}

fn run_here(stage: Stage, step: &mut StepState, hooks: &mut dyn StepHooks) {
    step.results.times[stage as usize] = Default::default();
    step.results.gpu = None;
    run_stage(stage, 0, step, hooks);
    if stage == Stage::Integrate {
        for number in 1..step.results.collision_substeps {
            for stage in Stage::ALL {
                run_stage(stage, number, step, hooks);
            }
        }
    }
}

/// Returns which near pairs touch, without faces and contacts: the test of a pair ends at its first hit. It replaces
/// the triangle test and runs after the stages before it.
pub fn touching(step: &mut StepState) -> Vec<[u32; 2]> {
    in_pool(Stage::TriangleTest, step, |step| {
        let StepState {
            input,
            results,
            scratch,
            ..
        } = step;
        triangle_test::cpu::touching(
            &input.bodies,
            &input.meshes,
            &results.near_pairs,
            &mut scratch.triangle_test,
        )
    })
}

/// Runs the parts of a stage in collision substep `number` and adds their time.
fn run_stage(stage: Stage, number: u32, step: &mut StepState, hooks: &mut dyn StepHooks) {
    let start = Instant::now();
    // The number of collision substeps is known after the first part. Only the last stage needs it.
    let position = SubstepPosition::of(number, step.results.collision_substeps);
    for part in parts_of(stage, step.input.config.response, position) {
        match part {
            Part::FilterPairs => filter_pairs(step, number, hooks),
            Part::ModifyContacts => modify_contacts(step, number, hooks),
            _ => run_part(part, number, step),
        }
    }
    step.results.times[stage as usize] += start.elapsed();
}

/// Tests the near pairs. If their faces exceed the limit, some pairs are left out of this and the next stages.
fn test_triangles(input: &StepInput, results: &mut StepResults, scratch: &mut StepScratch) {
    let StepResults {
        near_pairs,
        manifolds,
        contacts,
        crowd,
        ..
    } = results;
    contacts.lists_faces = input.config.face_lists;
    let solves = input.config.response == Response::Contacts;
    let mut test = |planes: &[Plane], near_pairs: &[NearPair], limit| {
        triangle_test::cpu::run(
            &input.bodies,
            &input.meshes,
            planes,
            near_pairs,
            manifolds,
            &scratch.inactive,
            |pair| !scratch.left_out.contains_plane_pair(pair),
            |pair| {
                if input.bodies.are_rounded(pair) {
                    // Their contact points tell whether they touch.
                    solves && input.bodies.push_each_other(pair)
                } else {
                    scratch.manifolds.is_apart(&input.bodies, &input.meshes, pair)
                }
            },
            limit,
            &mut scratch.triangle_test,
            contacts,
        )
    };
    let limit = input.config.limits.face_pairs;
    if test(&input.planes, near_pairs, limit).is_err() {
        let mut left = limit;
        *crowd = crowd.or(crowds::cut(near_pairs, &input.bodies, |portion| {
            test(&[], portion, left).is_ok_and(|faces| {
                left -= faces;
                true
            })
        }));
        scratch.most_near_pairs = Some(near_pairs.len());
        // All pairs fit, or there is only one.
        let _ = test(&input.planes, near_pairs, usize::MAX);
    }
    contacts.face_pairs = contacts.faces.len();
}

/// Finds the pairs of bodies whose spheres overlap. Dormant bodies among them are roused first.
fn find_sphere_pairs(
    number: u32,
    input: &mut StepInput,
    memory: &mut StepMemory,
    results: &mut StepResults,
    scratch: &mut StepScratch,
) {
    let config = input.config;
    loop {
        let (bodies, pairs) = (&input.bodies, &mut results.sphere_pairs);
        let mut crowd = Crowd::default();
        if !scratch.near_in_step.find(bodies, pairs) {
            crowd = broad_phase::cpu::run(bodies, config.limits.body_pairs, &mut scratch.broad_phase, pairs);
        }
        let Err(met) = scratch.dormant.meet(bodies, pairs, crowd.bodies > 0) else {
            results.crowd = results.crowd.or(crowd);
            return;
        };
        let first_plane = bodies.len() as u32;
        let contacts = (number > 0).then(|| scratch.dormant.contacts_of(&met, first_plane));
        let roused = scratch.rouse(met, number, input, memory, results);
        let places = roused.iter().filter_map(|i| input.bodies.moving.binary_search(i).ok());
        scratch.schedule.add_roused(places, &input.bodies);
        scratch.schedule.begin(number, &config, &mut input.bodies);
        scratch.margins.set_speculative_radii(&mut input.bodies, &config);
        scratch.near_in_step.clear();
        if let Some(contacts) = contacts {
            // These contacts are the ones that the first collision substep would have found.
            scratch.touches.put_back(&contacts, first_plane);
            results.contacts = results.contacts.merged(&contacts.tested());
        }
    }
}

fn run_part(part: Part, number: u32, step: &mut StepState) {
    let StepState {
        input,
        results,
        memory,
        scratch,
    } = step;
    let config = input.config;
    let first_plane = input.bodies.len() as u32;
    match part {
        Part::Begin => begin(input, memory, results, scratch),
        Part::FindSpherePairs => {
            find_sphere_pairs(number, input, memory, results, scratch);
            scratch.dormant.note(number, &input.bodies, &results.sphere_pairs);
            if number > 0 {
                let still_moves = |&body: &u32| input.bodies.travel_time_of(body as usize) > 0.0;
                results.sphere_pairs.retain(|pair| pair.iter().any(still_moves));
            }
        }
        // These parts need the hooks.
        Part::FilterPairs | Part::ModifyContacts => {}
        Part::FindNearPairs => {
            results.approximate_pairs = angles::cpu::run(
                &config,
                &input.bodies,
                &input.meshes,
                scratch.margins,
                &results.sphere_pairs,
                &mut scratch.angles,
                &mut results.near_pairs,
            );
            if let Some(most) = scratch.most_near_pairs {
                crowds::keep_at_most(most, &mut results.near_pairs, &input.bodies);
            }
        }
        Part::TestTriangles => test_triangles(input, results, scratch),
        Part::FindContactPoints => {
            manifolds::step::find(
                number,
                &config,
                &input.bodies,
                &input.meshes,
                &input.planes,
                &results.near_pairs,
                &scratch.inactive,
                |pair| !scratch.left_out.contains_plane_pair(pair),
                |pair| {
                    let touching = &results.contacts.pairs;
                    touching.binary_search_by_key(&pair, |touching| touching.bodies).is_ok()
                },
                &mut scratch.manifolds,
                &mut results.manifolds,
            );
            results.searches += scratch.manifolds.searches();
            scratch.first_contacts.add(
                &config,
                &input.bodies,
                &input.meshes,
                scratch.manifolds.dropped(),
                &mut results.manifolds,
            );
        }
        Part::ReuseContactPoints => {
            manifolds::step::reuse(
                &scratch.inactive,
                first_plane,
                &mut scratch.manifolds,
                &mut results.manifolds,
            );
        }
        Part::ReportContactPoints => {
            let center_of = |i: u32| input.bodies.frame[i as usize].body_center.as_vec3();
            report_points(&results.manifolds, first_plane, &mut results.contacts, center_of);
        }
        Part::SumImpulses => force_scan::cpu::sum_impulses(
            &config,
            &input.bodies,
            &input.planes,
            &results.contacts,
            &mut scratch.force_scan,
            &mut results.impulses,
        ),
        Part::ApplyImpulses => {
            integrate::cpu::apply_impulses(&config, &input.meshes, &results.impulses, &mut input.bodies);
        }
        Part::Wake => force_scan::cpu::wake(
            &config,
            &input.bodies,
            &results.manifolds,
            &scratch.inactive,
            &mut scratch.sleeper,
            &mut scratch.solver_bodies,
        ),
        Part::Solve => force_scan::cpu::solve(
            &config,
            |i| scratch.schedule.pace(i, &config, &input.bodies),
            &results.manifolds,
            &mut scratch.solver,
            &mut memory.warm,
            &mut scratch.solver_bodies,
        ),
        Part::RecordTouches => scratch.touches.record(
            &input.bodies,
            &scratch.solver_bodies,
            &results.manifolds,
            &config.solver,
            &scratch.solver,
        ),
        Part::FallAsleep => force_scan::cpu::fall_asleep(
            &config.solver,
            &input.bodies,
            &results.manifolds,
            &mut scratch.sleeper,
            &mut scratch.solver_bodies,
            &mut scratch.inactive,
        ),
        Part::StopFastBodies => integrate::cpu::stop_fast_bodies(
            &config,
            &input.bodies,
            &input.meshes,
            &input.planes,
            &results.sphere_pairs,
            &results.manifolds,
            |pair| scratch.left_out.has_dropped(pair),
            &mut scratch.ccd,
            &mut scratch.solver_bodies,
            &mut scratch.touches,
        ),
        Part::MoveBodies => {
            integrate::cpu::move_bodies(&scratch.solver_bodies, &input.meshes, &mut input.bodies);
            scratch.schedule.begin(number + 1, &config, &mut input.bodies);
            let bodies = &input.bodies;
            scratch.inactive.advance(
                bodies.movers(),
                |i| bodies.travel_time_of(i) == 0.0,
                |i| bodies.kind.get(i).is_none_or(|&kind| kind == RigidBody::Static),
            );
            scratch.margins.set_speculative_radii(&mut input.bodies, &config);
        }
        Part::ReportTouches => {
            let (bodies, sleep) = (&input.bodies, &scratch.solver_bodies.sleep);
            if bodies.dormant.count == 0 {
                results.asleep.clear();
            }
            results.asleep.resize(bodies.len(), false);
            bodies.movers().for_each(|i| results.asleep[i] = sleep[i].asleep);
            scratch.touches.report(first_plane, &mut results.contacts);
        }
        Part::Remember if config.response == Response::Contacts => {
            memory.save(input, &scratch.solver_bodies, &scratch.ccd);
            scratch.settle(input, memory, results);
        }
        Part::Remember => {
            memory.forget();
            scratch.solver_bodies.clear();
        }
    }
}
