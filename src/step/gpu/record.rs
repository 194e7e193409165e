//! What each part of a step does on the device: its kernels, in the order of [`order`](crate::step::order).

use super::buffers::StepCapacity;
use crate::gpu::buffers::{Buffers, Capacity};
use crate::gpu::device::Gpu;
use crate::gpu::kernel::{Kernel, Kernels, kernel};
use crate::gpu::layout::{ContactPair, ContactPoint, GROUPS_PER_64_SLOTS, NOTHING};
use crate::gpu::program::{Calls, Groups, Program};
use crate::gpu::shader::{Module, Shaders, module};
use crate::solver::gpu::Passes;
use crate::solver::gpu::layout::{COUNTERS, SavedPair, SavedPoint, PAIRS, POINTS};
use crate::step::order::{Part, Place, parts};
use crate::types::settings::Response;
use crate::types::stage::Stage;
use crate::{angles, broad_phase, force_scan, integrate, manifolds, sleep, solver, triangle_test};

/// Where bodies are as a step with contacts begins.
const BEGIN: Kernel = kernel!("step/begin");
/// The contact points of pairs about which nothing has changed.
const REUSE_CONTACT_POINTS: Kernel = kernel!("step/reuse_contact_points");
/// Whether the lists of contact generation, and those before, sufficed, and how much there was.
const OVERFLOW_LISTS: Kernel = kernel!("step/overflow_lists");
/// Where the bodies are as another interval begins.
const MOVE_BODIES: Kernel = kernel!("step/move_bodies");
/// Whether the list of touches sufficed.
const OVERFLOW_TOUCHES: Kernel = kernel!("step/overflow_touches");
/// Where the bodies are after the step.
const FINISH: Kernel = kernel!("step/finish");
/// What outlives it.
const REMEMBER: Kernel = kernel!("step/remember");

/// All of them.
pub const SHADERS: Shaders = Shaders {
    modules: &[module!("step/placed")],
    kernels: &[
        &BEGIN,
        &REUSE_CONTACT_POINTS,
        &OVERFLOW_LISTS,
        &MOVE_BODIES,
        &OVERFLOW_TOUCHES,
        &FINISH,
        &REMEMBER,
    ],
};

/// The kernels of a step, in the order of layers, in which a shader may import what comes before.
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

/// Every kernel there is.
pub fn all_kernels() -> impl Iterator<Item = &'static Kernel> {
    ALL_SHADERS.iter().flat_map(|shaders| shaders.kernels.iter().copied())
}

/// What kernels import.
pub fn all_modules() -> impl Iterator<Item = &'static Module> {
    ALL_SHADERS.iter().flat_map(|shaders| shaders.modules)
}

/// Records the parts of a step.
#[derive(Clone, Copy, Debug)]
pub struct Recorder<'s> {
    /// What happens to bodies that touch.
    pub response: Response,
    /// What the lists of a step hold.
    pub capacity: &'s Capacity,
    /// What those hold that only steps with contact points have.
    pub contact_capacity: Option<&'s StepCapacity>,
    /// How often the solver does everything.
    pub passes: Option<Passes>,
}

impl Recorder<'_> {
    /// The calls of an interval that belong to these stages.
    pub fn calls(&self, stages: &[Stage], place: Place) -> Calls {
        let mut calls = Calls::new(Stage::BroadPhase);
        for part in parts(self.response, place).filter(|part| stages.contains(&part.stage())) {
            calls.stage(part.stage());
            self.part(&mut calls, part, place);
        }
        calls
    }

    fn part(&self, calls: &mut Calls, part: Part, place: Place) {
        let with_contacts = self.response == Response::Contacts;
        let per_body = Groups::PerBodies(64);
        match part {
            Part::Begin if with_contacts => {
                calls.call(&BEGIN, per_body);
            }
            Part::Begin => broad_phase::gpu::record_place(calls),
            Part::FindSpherePairs => broad_phase::gpu::record_search(calls, self.capacity),
            Part::FindNearPairs => angles::gpu::record(calls),
            Part::TestTriangles => triangle_test::gpu::record(calls),
            Part::FindContactPoints => {
                manifolds::gpu::record::record_select(calls, self.capacity);
                manifolds::gpu::record::record_points(calls);
            }
            Part::ReuseContactPoints => {
                calls.call(&REUSE_CONTACT_POINTS, manifolds::gpu::record::per(GROUPS_PER_64_SLOTS));
                list_contact_points(calls);
            }
            Part::ReportContactPoints => list_contact_points(calls),
            Part::SumImpulses => force_scan::gpu::record_impulses(calls, self.capacity),
            Part::ApplyImpulses => integrate::gpu::record(calls),
            Part::Wake => {
                solver::gpu::arguments::record_arguments(calls);
                sleep::gpu::record_wake(calls, self.may_sleep());
            }
            Part::Solve => {
                if let (Some(contact_capacity), Some(passes)) = (self.contact_capacity, self.passes) {
                    solver::gpu::record::record(calls, &contact_capacity.solver(), passes);
                }
            }
            Part::RecordTouches => force_scan::gpu::record_touches(calls),
            Part::FallAsleep => sleep::gpu::record_fall_asleep(calls, self.may_sleep()),
            // Steps with such bodies run on the CPU.
            Part::StopFastBodies => {}
            // After the last interval the bodies are moved by what remembers them: a step that has to run again begins where they
            // were.
            Part::MoveBodies if place.is_last => {}
            Part::MoveBodies => {
                calls.call(&MOVE_BODIES, per_body);
            }
            // The host reports them. A list that is too short turns the step into nothing.
            Part::ReportTouches => {
                calls.call(&OVERFLOW_TOUCHES, Groups::Exactly(1));
            }
            Part::Remember => {
                if let Some(contact_capacity) = self.contact_capacity.filter(|_| with_contacts) {
                    calls.call(&FINISH, per_body);
                    remember(calls, contact_capacity);
                }
            }
        }
    }

    fn may_sleep(&self) -> bool {
        self.passes.is_some_and(|passes| passes.sleeping)
    }
}

/// The calls of a step with [`Response::Impulse`].
pub fn impulse_calls(capacity: &Capacity) -> Calls {
    let recorder = Recorder {
        response: Response::Impulse,
        capacity,
        contact_capacity: None,
        passes: None,
    };
    recorder.calls(&Stage::ALL, Place::of(0, 1))
}

/// The same, with their buffers.
pub fn impulse_program(gpu: &Gpu, kernels: &Kernels, buffers: &Buffers) -> Program {
    Program::new(gpu, kernels, &impulse_calls(&buffers.capacity), &[buffers])
}

/// Puts contact points in order, and finds out whether all lists so far sufficed.
fn list_contact_points(calls: &mut Calls) {
    manifolds::gpu::record::record_lists(calls);
    calls.call(&OVERFLOW_LISTS, Groups::Exactly(1));
}

/// Copies to where it outlives the step what the solver and contact generation know of the last interval.
fn remember(calls: &mut Calls, contact_capacity: &StepCapacity) {
    let StepCapacity { contacts, .. } = contact_capacity;
    for (counter, count, bytes, from, to) in [
        (NOTHING, 1, 4 * COUNTERS as usize, "solver_counters", "last_step_counters"),
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
