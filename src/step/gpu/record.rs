//! The kernels of each part of a step, in the order of [`order`](crate::step::order).

use super::buffers::StepCapacity;
use super::reach;
use crate::gpu::buffers::{Buffers, Capacity};
use crate::gpu::device::Gpu;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::{ContactPair, ContactPoint, NOTHING};
use crate::gpu::program::{Calls, Groups, Program};
use crate::gpu::shader::{Module, Shaders, module};
use crate::manifolds::gpu::ContactCapacity;
use crate::manifolds::gpu::record::per_64_slots;
use crate::solver::gpu::layout::{COUNTERS, PAIRS, POINTS, SavedPair, SavedPoint};
use crate::step::order::{Part, SubstepPosition, parts};
use crate::types::settings::Response;
use crate::types::stage::Stage;
use crate::{angles, broad_phase, force_scan, integrate, manifolds, sleep, solver, triangle_test};

/// Loads the bodies at the start of a step with contacts.
const BEGIN: Kernel = kernel!("step/begin");
/// Loads compounds, and places their colliders.
const BEGIN_COMPOUNDS: Kernel = kernel!("step/begin_compounds");
/// Reuses the contact points of inactive pairs.
const REUSE_CONTACT_POINTS: Kernel = kernel!("step/reuse_contact_points");
/// Tests whether the lists of contact generation, and earlier ones, overflowed.
const OVERFLOW_LISTS: Kernel = kernel!("step/overflow_lists");
/// Moves the bodies between collision substeps.
const MOVE_BODIES: Kernel = kernel!("step/move_bodies");
/// Moves the colliders of compounds between collision substeps.
const MOVE_COMPOUNDS: Kernel = kernel!("step/move_compounds");
/// Tests whether the touch list overflowed.
const OVERFLOW_TOUCHES: Kernel = kernel!("step/overflow_touches");
/// Writes the motions after the step.
const FINISH: Kernel = kernel!("step/finish");
/// Writes the motions of compounds and their colliders after the step.
const FINISH_COMPOUNDS: Kernel = kernel!("step/finish_compounds");
/// Saves the memory for the next step.
const REMEMBER: Kernel = kernel!("step/remember");

/// The modules and kernels of the step itself.
pub const SHADERS: Shaders = Shaders {
    modules: &[
        reach::CONSTANTS,
        module!("step/placed"),
        module!("step/start"),
        module!("step/meeting"),
        module!("step/scheduled"),
    ],
    kernels: &[
        &BEGIN,
        &BEGIN_COMPOUNDS,
        &reach::SWEEPS,
        &reach::JOIN_GROUPS,
        &reach::GROUP_BODIES,
        &reach::GROUP_PAIRS,
        &reach::COUNT_SUBSTEPS,
        &reach::TERRITORIES,
        &reach::SCHEDULE,
        &reach::BEGIN_SUBSTEP,
        &REUSE_CONTACT_POINTS,
        &OVERFLOW_LISTS,
        &MOVE_BODIES,
        &MOVE_COMPOUNDS,
        &OVERFLOW_TOUCHES,
        &FINISH,
        &FINISH_COMPOUNDS,
        &REMEMBER,
    ],
};

/// The shaders of all stages, in the order of layers: a shader may import earlier ones.
pub const ALL_SHADERS: [&Shaders; 10] = [
    &crate::gpu::SHADERS,
    &broad_phase::gpu::SHADERS,
    &angles::gpu::SHADERS,
    &triangle_test::gpu::SHADERS,
    &manifolds::gpu::SHADERS,
    &solver::gpu::SHADERS,
    &sleep::gpu::SHADERS,
    &force_scan::gpu::SHADERS,
    &integrate::gpu::SHADERS,
    &SHADERS,
];

/// All kernels.
pub fn all_kernels() -> impl Iterator<Item = &'static Kernel> {
    ALL_SHADERS.iter().flat_map(|shaders| shaders.kernels.iter().copied())
}

/// All modules.
pub fn all_modules() -> impl Iterator<Item = &'static Module> {
    ALL_SHADERS.iter().flat_map(|shaders| shaders.modules)
}

/// Records the parts of a step.
#[derive(Clone, Copy, Debug)]
pub struct Recorder<'s> {
    /// What happens to bodies that touch.
    pub response: Response,
    /// Capacity of the lists.
    pub capacity: &'s Capacity,
    /// Capacity of the lists for contact points.
    pub contact_capacity: Option<&'s StepCapacity>,
    /// Whether bodies may fall asleep.
    pub may_sleep: bool,
    /// Whether the bodies are placed already, by [`Recorder::reach`].
    pub is_begun: bool,
}

impl Recorder<'_> {
    /// The calls of a collision substep that belong to these stages.
    pub fn calls(&self, stages: &[Stage], position: SubstepPosition) -> Calls {
        let mut calls = Calls::new(Stage::BroadPhase);
        for part in parts(self.response, position).filter(|part| stages.contains(&part.stage())) {
            calls.stage(part.stage());
            self.part(&mut calls, part, position);
        }
        calls
    }

    fn part(&self, calls: &mut Calls, part: Part, position: SubstepPosition) {
        let with_contacts = self.response == Response::Contacts;
        let (per_body, per_compound) = (Groups::PerBodies(64), Groups::PerCompounds(64));
        match part {
            Part::Begin if self.is_begun => {}
            Part::Begin if with_contacts => begin(calls),
            Part::Begin => broad_phase::gpu::record_place(calls),
            Part::FindSpherePairs => {
                if with_contacts && !position.is_first {
                    calls.call(&reach::BEGIN_SUBSTEP, Groups::Exactly(1));
                }
                broad_phase::gpu::record_search(calls, self.capacity);
            }
            Part::FindNearPairs => angles::gpu::record(calls, self.capacity),
            Part::TestTriangles => triangle_test::gpu::record(calls, self.capacity),
            Part::FindContactPoints => {
                manifolds::gpu::record::record_select(calls, self.capacity);
                if let Some(StepCapacity { contacts, .. }) = self.contact_capacity {
                    manifolds::gpu::record::record_points(calls, contacts);
                    manifolds::gpu::record::record_compounds(calls, contacts);
                }
            }
            Part::ReuseContactPoints => {
                if let Some(StepCapacity { contacts, .. }) = self.contact_capacity {
                    calls.call(&REUSE_CONTACT_POINTS, per_64_slots(contacts));
                }
                self.list_contact_points(calls);
            }
            Part::ReportContactPoints => self.list_contact_points(calls),
            // Bodies do not push each other.
            Part::SumImpulses if self.response == Response::None => {}
            Part::SumImpulses => force_scan::gpu::record_impulses(calls, self.capacity),
            Part::ApplyImpulses => integrate::gpu::record(calls),
            Part::Wake => {
                solver::gpu::arguments::record_arguments(calls);
                sleep::gpu::record_wake(calls, self.may_sleep);
            }
            Part::Solve => {
                if let Some(contact_capacity) = self.contact_capacity {
                    solver::gpu::record::record(calls, &contact_capacity.solver());
                }
            }
            Part::RecordTouches => force_scan::gpu::record_touches(calls),
            Part::FallAsleep => sleep::gpu::record_fall_asleep(calls, self.may_sleep),
            // Steps with hooks run on the CPU.
            Part::FilterPairs | Part::ModifyContacts => {}
            // The CPU does, before the commands of this stage are submitted: see `fast_bodies`.
            Part::StopFastBodies => {}
            // In the last collision substep `Part::Remember` moves the bodies, so that a step that has to be repeated
            // starts from their old poses.
            Part::MoveBodies if position.is_last => {}
            Part::MoveBodies => {
                calls.call(&MOVE_BODIES, per_body);
                calls.call(&MOVE_COMPOUNDS, per_compound);
            }
            // The host reports them. If the touch list overflowed, the step is discarded.
            Part::ReportTouches => {
                calls.call(&OVERFLOW_TOUCHES, Groups::Exactly(1));
            }
            Part::Remember => {
                if let Some(contact_capacity) = self.contact_capacity.filter(|_| with_contacts) {
                    calls.call(&FINISH, per_body);
                    calls.call(&FINISH_COMPOUNDS, per_compound);
                    remember(calls, contact_capacity);
                }
            }
        }
    }
}

impl Recorder<'_> {
    /// The begin of a step that may need several collision substeps: places the bodies, and counts them.
    pub fn reach(&self) -> Calls {
        let mut calls = Calls::new(Part::Begin.stage());
        begin(&mut calls);
        reach::record(&mut calls, self.capacity);
        calls
    }

    /// Compacts the lists of contact points, and tests all lists so far for overflow.
    fn list_contact_points(&self, calls: &mut Calls) {
        if let Some(StepCapacity { contacts, .. }) = self.contact_capacity {
            manifolds::gpu::record::record_lists(calls, contacts);
            calls.call(&OVERFLOW_LISTS, Groups::Exactly(1));
        }
    }
}

/// Places the bodies of a step with contacts.
fn begin(calls: &mut Calls) {
    calls.call(&BEGIN, Groups::PerBodies(64));
    calls.call(&BEGIN_COMPOUNDS, Groups::PerCompounds(64));
}

/// The calls of a step with [`Response::Impulse`].
pub fn impulse_calls(capacity: &Capacity) -> Calls {
    let recorder = Recorder {
        response: Response::Impulse,
        capacity,
        contact_capacity: None,
        may_sleep: false,
        is_begun: false,
    };
    recorder.calls(&Stage::ALL, SubstepPosition::of(0, 1))
}

/// The kernels of such a step, whatever its capacity: lists may grow at any time.
pub fn impulse_kernels() -> impl Iterator<Item = &'static Kernel> {
    kernels_of(impulse_calls)
}

/// The kernels of a step with [`Response::None`], whatever its capacity.
pub fn report_kernels() -> impl Iterator<Item = &'static Kernel> {
    kernels_of(|capacity| {
        let contact_capacity = StepCapacity {
            contacts: ContactCapacity {
                pairs: capacity.pairs,
                points: capacity.pairs,
                ..ContactCapacity::default()
            },
            bodies: capacity.bodies,
            touches: 0,
            solves: false,
            has_fast_bodies: false,
        };
        let recorder = Recorder {
            response: Response::None,
            capacity,
            contact_capacity: Some(&contact_capacity.covering(capacity)),
            may_sleep: false,
            is_begun: false,
        };
        recorder.calls(&Stage::ALL, SubstepPosition::of(0, 1))
    })
}

/// The kernels of calls for short lists, and of those for long ones.
fn kernels_of(calls: impl Fn(&Capacity) -> Calls) -> impl Iterator<Item = &'static Kernel> {
    [1, 1 << 20].into_iter().flat_map(move |length| {
        let capacity = Capacity {
            bodies: length,
            compounds: 1,
            parts: 1,
            planes: 1,
            pairs: length,
            ..Capacity::default()
        };
        let kernels: Vec<_> = calls(&capacity).iter().map(|call| call.kernel).collect();
        kernels
    })
}

/// [`impulse_calls`], bound to buffers.
pub fn impulse_program(gpu: &Gpu, buffers: &Buffers) -> Program {
    Program::new(gpu, &impulse_calls(&buffers.capacity), &[buffers])
}

/// Saves the solver's memory and the contact points of the last collision substep.
fn remember(calls: &mut Calls, contact_capacity: &StepCapacity) {
    let StepCapacity { contacts, .. } = contact_capacity;
    for (counter, count, bytes, from, to) in [
        (
            NOTHING,
            1,
            4 * COUNTERS as usize,
            "solver_counters",
            "last_step_counters",
        ),
        (
            PAIRS,
            contacts.pairs,
            size_of::<SavedPair>(),
            "saved_pairs",
            "last_step_pairs",
        ),
        (
            POINTS,
            contacts.points,
            size_of::<SavedPoint>(),
            "saved_points",
            "last_step_points",
        ),
        (
            PAIRS,
            contacts.pairs,
            size_of::<ContactPair>(),
            "contact_pairs",
            "last_step_contact_pairs",
        ),
        (
            POINTS,
            contacts.points,
            size_of::<ContactPoint>(),
            "contact_points",
            "last_step_contact_points",
        ),
    ] {
        let quads = bytes as u32 / 16;
        let groups = count.saturating_mul(quads).div_ceil(64);
        let call = calls.call(&REMEMBER, Groups::Exactly(groups));
        call.constants([counter, quads, 0, 0]);
        call.bind_words("source", from).bind_words("stored", to);
    }
}
