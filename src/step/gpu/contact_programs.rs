//! Buffers and calls of steps with contact points.
//!
//! Such a step is one submission, whatever its number of collision substeps. Bodies and the solver's memory stay on the
//! device from step to step, in the buffers of [`StepBuffers::memory`]. These are written only at the end of a step, if
//! nothing overflowed in any of its collision substeps. So a step can be repeated.

use super::buffers::{StepBuffers, StepCapacity};
use super::readback_lengths::ReadbackLengths;
use super::record::Recorder;
use super::solver_input::SolverInput;
use crate::gpu::buffer_contents::BufferContents;
use crate::gpu::buffers::{Buffers, TooLarge};
use crate::gpu::commands::Commands;
use crate::gpu::device::Gpu;
use crate::gpu::program::{Calls, Population, Program};
use crate::gpu::timer::Timer;
use crate::manifolds::gpu::{ContactBuffers, ContactCapacity, ContactScratch};
use crate::solver::gpu::SolverBuffers;
use crate::step::order::SubstepPosition;
use crate::types::settings::Response;
use crate::types::stage::Stage;

/// Initial capacity. Lists grow as needed.
pub const START: StepCapacity = StepCapacity {
    contacts: ContactCapacity {
        batches: 1,
        margin_pairs: 0,
        slots: 0,
        near_triangles: 1 << 15,
        pieces: 256,
        features: 1 << 13,
        segments: 1 << 12,
        staged_points: 2048,
        pairs: 256,
        points: 2048,
    },
    bodies: 0,
    touches: 2048,
    solves: false,
    has_fast_bodies: false,
};

/// Stages that find contact points.
const DETECTION: [Stage; 4] = [Stage::BroadPhase, Stage::Angles, Stage::TriangleTest, Stage::Manifolds];

/// Buffers and calls of steps with contact points. Without [`StepCapacity::solves`] there are none for the solver,
/// whose kernels may not be compiled.
pub struct ContactPrograms {
    /// The buffers of contact generation.
    pub contacts: ContactBuffers,
    /// The buffers of one batch of pairs.
    pub scratch: ContactScratch,
    /// The solver's buffers.
    pub solver: SolverBuffers,
    /// The buffers between them.
    pub step: StepBuffers,
    /// Finds contact points, and moves bodies without a response: [`Response::None`].
    report: Program,
    /// Places the bodies and counts the collision substeps, if there may be several.
    reach: Program,
    /// The broad phase of the first collision substep after that.
    after_reach: Program,
    /// Finds contact points in the first collision substep.
    first: Program,
    /// Finds them in the later ones.
    later: Program,
    /// Solves a collision substep: without sleep, and with it.
    solve: [Program; 2],
    /// Ends a collision substep that is not the last.
    between: Program,
    /// Ends the step.
    last: Program,
}

impl ContactPrograms {
    /// Creates buffers and calls. The memory between steps is empty.
    ///
    /// # Errors
    /// If the lists exceed the limits of the device.
    pub fn new(gpu: &Gpu, buffers: &Buffers, capacity: StepCapacity) -> Result<Self, TooLarge> {
        let capacity = capacity.covering(&buffers.capacity);
        let mut made = Self {
            contacts: ContactBuffers::new(gpu, capacity.contacts)?,
            scratch: ContactScratch::new(gpu, capacity.contacts)?,
            solver: SolverBuffers::new(gpu, capacity.solver())?,
            step: StepBuffers::new(gpu, capacity)?,
            report: Program::default(),
            reach: Program::default(),
            after_reach: Program::default(),
            first: Program::default(),
            later: Program::default(),
            solve: Default::default(),
            between: Program::default(),
            last: Program::default(),
        };
        let simple = recorder(Response::None, buffers, &capacity);
        let contacts = recorder(Response::Contacts, buffers, &capacity);
        let bind = |calls: Calls| made.bind(gpu, buffers, &calls);
        let [first, middle, last] = [
            SubstepPosition::of(0, 3),
            SubstepPosition::of(1, 3),
            SubstepPosition::of(2, 3),
        ];
        let report = bind(simple.calls(&Stage::ALL, SubstepPosition::of(0, 1)));
        if capacity.solves {
            let after_reach = Recorder {
                is_begun: true,
                ..contacts
            };
            let programs = [
                bind(contacts.reach()),
                bind(after_reach.calls(&[Stage::BroadPhase], first)),
                bind(contacts.calls(&DETECTION, first)),
                bind(contacts.calls(&DETECTION, middle)),
                bind(contacts.calls(&[Stage::Integrate], middle)),
                bind(contacts.calls(&[Stage::Integrate], last)),
            ];
            // The program is the same in every collision substep.
            let solve = [false, true].map(|may_sleep| {
                let recorder = Recorder { may_sleep, ..contacts };
                bind(recorder.calls(&[Stage::ForceScan], SubstepPosition::of(0, 1)))
            });
            made.solve = solve;
            [
                made.reach,
                made.after_reach,
                made.first,
                made.later,
                made.between,
                made.last,
            ] = programs;
        }
        made.report = report;
        Ok(made)
    }

    fn bind(&self, gpu: &Gpu, buffers: &Buffers, calls: &Calls) -> Program {
        Program::new(
            gpu,
            calls,
            &[buffers, &self.contacts, &self.scratch, &self.solver, &self.step],
        )
    }

    /// Capacity of the lists.
    pub fn capacity(&self) -> StepCapacity {
        self.step.capacity
    }

    /// Total size of the buffers, bytes.
    pub fn bytes(&self) -> u64 {
        self.contacts.bytes() + self.scratch.bytes() + self.solver.bytes() + self.step.bytes()
    }

    /// Copies the memory between steps from `old`.
    pub fn copy_memory(&self, old: &Self, commands: &mut Commands) {
        for (from, to) in old.step.memory().into_iter().zip(self.step.memory()) {
            commands.copy(from, to);
        }
    }

    /// Writes the lengths of the lists, and the numbers of bodies and planes.
    pub fn write_limits(
        &self,
        commands: &mut Commands,
        contents: &mut BufferContents,
        bodies: u32,
        planes: u32,
        lengths: &ReadbackLengths,
    ) {
        let capacity = ContactCapacity {
            pairs: lengths.contact_pairs,
            points: lengths.contact_points,
            ..self.contacts.capacity
        };
        let limits = capacity.limits(bodies, planes);
        commands.write_changes(contents, &self.contacts.limits, bytemuck::bytes_of(&limits));
    }

    /// Records a step without response, which reports contact points.
    pub fn record_report(&self, commands: &mut Commands, population: Population, timer: Option<&Timer>) {
        commands.clear(&self.step.tally);
        commands.clear(&self.contacts.contact_counters);
        for stage in Stage::ALL {
            let around = timer.map(|timer| timer.around(stage, 0));
            self.report.record(stage, commands, population, around);
        }
    }

    /// Records the start of a step with contacts. For each collision substep follow
    /// [`ContactPrograms::record_solution`] and [`ContactPrograms::record_motion`].
    pub fn record_start(&self, commands: &mut Commands, input: &SolverInput) {
        let Self { step, solver, .. } = self;
        commands.clear(&step.tally);
        for (from, to) in [
            (&step.last_step_counters, &solver.solver_counters),
            (&step.last_step_pairs, &solver.saved_pairs),
            (&step.last_step_points, &solver.saved_points),
            (&step.last_step_contact_pairs, &self.contacts.contact_pairs),
            (&step.last_step_contact_points, &self.contacts.contact_points),
        ] {
            commands.copy(from, to);
        }
        if input.old_bodies() == 0 {
            commands.clear(&solver.solver_counters);
        }
    }

    /// Records a collision substep from the broad phase to the solution of its contacts. The states of bodies at its
    /// start are kept if continuous collision needs them. The faces of pairs are tested only if `reads_pairs`: contacts
    /// do not depend on them.
    pub fn record_solution(
        &self,
        commands: &mut Commands,
        buffers: &Buffers,
        input: &SolverInput,
        number: u32,
        keeps_states: bool,
        reads_pairs: bool,
        timer: Option<&Timer>,
    ) {
        let nothing = Program::default();
        let Self { step, solver, .. } = self;
        let is_first = number == 0;
        let (collision_substep, numbers, find) = if is_first {
            (&step.first_collision_substep, &step.first_new_numbers, &self.first)
        } else {
            commands.clear(&buffers.buckets);
            (&step.later_collision_substep, &step.later_new_numbers, &self.later)
        };
        commands.copy(collision_substep, &solver.collision_substep);
        commands.copy(numbers, &step.new_numbers);
        commands.clear(&self.contacts.contact_counters);
        let counts_substeps = is_first && input.counts_substeps();
        if counts_substeps {
            let start = timer.map(|timer| timer.start(Stage::BroadPhase, number));
            self.reach
                .record(Stage::BroadPhase, commands, input.population(), start);
            commands.clear(&buffers.buckets);
        }
        for stage in Stage::ALL.into_iter().filter(|&stage| stage != Stage::Integrate) {
            let is_begun = counts_substeps && stage == Stage::BroadPhase;
            let program = match stage {
                Stage::ForceScan => &self.solve[usize::from(input.may_sleep())],
                Stage::TriangleTest if !reads_pairs => &nothing,
                Stage::BroadPhase if is_begun => &self.after_reach,
                _ => find,
            };
            let around = timer.map(|timer| {
                if is_begun {
                    timer.end(stage, number)
                } else {
                    timer.around(stage, number)
                }
            });
            program.record(stage, commands, input.population(), around);
            if stage == Stage::BroadPhase && is_first {
                // Copy for rendering.
                commands.copy(&buffers.bodies, &buffers.before);
            }
            if stage == Stage::BroadPhase && keeps_states {
                commands.copy(&step.motion_states, &step.earlier_states);
            }
        }
    }

    /// Records the motion of the bodies in a collision substep.
    pub fn record_motion(
        &self,
        commands: &mut Commands,
        input: &SolverInput,
        position: SubstepPosition,
        number: u32,
        timer: Option<&Timer>,
    ) {
        let program = if position.is_last { &self.last } else { &self.between };
        let around = timer.map(|timer| timer.around(Stage::Integrate, number));
        program.record(Stage::Integrate, commands, input.population(), around);
    }
}

fn recorder<'s>(response: Response, buffers: &'s Buffers, capacity: &'s StepCapacity) -> Recorder<'s> {
    Recorder {
        response,
        capacity: &buffers.capacity,
        contact_capacity: Some(capacity),
        may_sleep: false,
        is_begun: false,
    }
}
