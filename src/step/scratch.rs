//! Scratch memory of the CPU's stages. It is reused, so that a step like the last one allocates nothing. Results depend
//! only on its manifolds of sleeping pairs and on what it keeps for dormant bodies.

use super::dormant::Dormant;
use super::hooks::LeftOut;
use super::reach::Reach;
use super::schedule::Schedule;
use crate::ccd::first_contact::FirstContacts;
use crate::ccd::stage::Ccd;
use crate::force_scan::touches::Touches;
use crate::sleep::cpu::Sleeper;
use crate::solver::{Solver, SolverBodies};
use crate::state::StepResults;
use crate::state::inactive::InactiveBodies;
use crate::state::margins::SpeculativeMargins;
use crate::{angles, broad_phase, force_scan, manifolds, triangle_test};

/// Steps after which scratch memory is allocated anew: a minute of a game. It grows to what the largest pair and the
/// densest crowd ever needed; without this the memory of a process would grow for hours.
const LIFETIME: u32 = 4096;

/// Scratch memory of the stages.
#[derive(Default)]
pub struct StepScratch {
    /// Number of steps since it was allocated.
    age: u32,
    /// The bodies' keys.
    pub(crate) keys: Vec<u64>,
    /// The solver's bodies, followed by the planes.
    pub(crate) solver_bodies: SolverBodies,
    /// Which of them are unchanged since the last collision substep.
    pub(crate) inactive: InactiveBodies,
    /// The pairs that a hook left out of this collision substep.
    pub(crate) left_out: LeftOut,
    /// Bodies for which a step does nothing, with their contacts and saved impulses.
    pub(crate) dormant: Dormant,
    /// Which bodies can meet in this step.
    pub(crate) reach: Reach,
    /// The collision substeps of this step.
    pub(crate) schedule: Schedule,
    /// The speculative margins of this step.
    pub(crate) margins: SpeculativeMargins,
    /// The touching pairs of the step so far.
    pub(crate) touches: Touches,
    /// Continuous collision detection, with the impacts of the step so far.
    pub(crate) ccd: Ccd,
    pub(crate) first_contacts: FirstContacts,
    /// Most near pairs of a collision substep, if the first one has left pairs out.
    pub(crate) most_near_pairs: Option<usize>,
    pub(crate) solver: Solver,
    pub(crate) sleeper: Sleeper,
    pub(crate) broad_phase: broad_phase::cpu::Scratch,
    /// The pairs of bodies that come near each other within this step, if it has several collision substeps.
    pub(crate) near_in_step: broad_phase::cpu::WideSearch,
    pub(crate) angles: angles::cpu::Scratch,
    pub(crate) triangle_test: triangle_test::cpu::Scratch,
    pub(crate) manifolds: manifolds::step::Scratch,
    pub(crate) force_scan: force_scan::cpu::Scratch,
}

impl StepScratch {
    /// Returns memory that depends on what pairs of bodies had in common, if it is old. Called before every step, also
    /// one on a device: steps on the CPU may be long ago.
    pub(crate) fn age(&mut self, results: &mut StepResults) {
        self.age += 1;
        if self.age == LIFETIME {
            self.renew();
            results.shrink();
        }
    }

    fn renew(&mut self) {
        self.age = 0;
        self.touches = Touches::default();
        self.ccd = Ccd::default();
        self.first_contacts = FirstContacts::default();
        self.solver = Solver::default();
        self.angles = angles::cpu::Scratch::default();
        self.triangle_test = triangle_test::cpu::Scratch::default();
        self.force_scan = force_scan::cpu::Scratch::default();
        self.manifolds.renew();
    }
}

#[cfg(test)]
mod tests {
    use crate::state::Body;
    use crate::step::{StepState, cpu};
    use crate::testing::scenes::{Scene, pour};
    use crate::types::body::RigidBody;
    use crate::types::settings::Response;
    use glam::Quat;

    /// A heap of knots after some steps, in which its first ones have fallen asleep.
    fn heap(response: Response, mut before_step: impl FnMut(&mut StepState)) -> StepState {
        let mut scene = Scene::new();
        pour::walls(&mut scene, 6.0, 2.5, 3.0);
        pour::knots(&mut scene, 5, 2, || Quat::from_rotation_x(1.0));
        let mut step = StepState::default();
        step.input.config.response = response;
        step.input.config.gravity = scene.gravity;
        let meshes = &mut step.input.meshes;
        let mut bodies: Vec<Body> = (scene.bodies.iter())
            .map(|body| {
                let slot = meshes.add(body.shape.mesh().clone());
                let kind = if body.fixed {
                    RigidBody::Static
                } else {
                    RigidBody::Dynamic
                };
                Body {
                    kind,
                    ..Body::at_rest(slot, body.position, body.rotation, body.scale)
                }
            })
            .collect();
        for _ in 0..400 {
            step.input.bodies.clear();
            for body in &bodies {
                let added = step.input.bodies.push(body, &step.input.meshes);
                added.expect("the scene is valid");
            }
            before_step(&mut step);
            cpu::run_all(&mut step);
            for (i, body) in bodies.iter_mut().enumerate() {
                let moved = step.input.bodies.motion(i);
                (body.position, body.rotation) = (moved.position, moved.rotation);
                (body.linear_velocity, body.angular_velocity) = (moved.linear_velocity, moved.angular_velocity);
            }
        }
        step
    }

    #[test]
    fn new_memory_gives_the_same_bits() {
        for response in [Response::Impulse, Response::Contacts] {
            let mut touching = 0;
            let kept = heap(response, |step| touching += step.results.contacts.pairs.len());
            let renewed = heap(response, |step| {
                step.scratch.renew();
                step.results.shrink();
            });
            assert!(touching > 400, "{touching}");
            let sleeps = kept.results.asleep.contains(&true);
            assert_eq!(sleeps, response == Response::Contacts);
            assert_eq!(
                kept.input.bodies.position, renewed.input.bodies.position,
                "{response:?}"
            );
            assert_eq!(
                kept.results.contacts.points, renewed.results.contacts.points,
                "{response:?}"
            );
        }
    }
}
