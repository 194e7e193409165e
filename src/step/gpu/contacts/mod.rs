//! Contacts in the device's step: contact generation and solver, joined.
//!
//! A step is one submission, whatever number of collision substeps it is cut into. Bodies and the solver's memory stay on
//! the device from step to step, in [`StepLists::settled`](lists::StepLists) and the kept lists. These are written at the
//! end of a step and not before, and only if no list was too short in any of its intervals; so such a step can run again.
//!
//! | file | holds |
//! |---|---|
//! | [`kernels`] | what stands between contact generation and solver |
//! | [`lists`] | the buffers between them |
//! | [`lineage`] | which body of a step was which in the step before |
//! | [`input`] | what a step is told |
//! | [`memory`] | what outlives a step, for snapshots |

pub mod input;
pub mod kernels;
pub mod lineage;
pub mod lists;
pub mod memory;

use crate::gpu::buffers::{Buffers, TooLarge};
use crate::gpu::device::Gpu;
use crate::gpu::kernel::{Builder, Groups, Kernel, Kernels, Program};
use crate::gpu::layout;
use crate::gpu::layout::{
    ContactLimits, GROUPS_PER_64_PAIRS, GROUPS_PER_64_SLOTS, GROUPS_PER_DIGIT_BLOCK, GROUPS_PER_SORT_BLOCK, NOTHING,
    PAIRS as PAIR_COUNT,
};
use crate::gpu::radix_sort::Sort;
use crate::gpu::timer::Timer;
use crate::integrate;
use crate::manifolds::gpu as manifolds;
use crate::manifolds::gpu::{ContactBuffers, ContactCapacity, Shared};
use crate::solver::gpu as solver;
use crate::solver::gpu::layout::GROUPS_PER_64_PAIRS as SOLVER_PAIRS;
use crate::solver::gpu::{Inputs, Lists, Passes, Room, layout as solver_layout};
use crate::triangle_test;
use crate::types::settings::Response;
use crate::types::stage::Stage;
use crate::{angles, broad_phase, force_scan};
use input::SolverInput;
use kernels::*;
use lists::{StepCapacity, StepLists};
use std::collections::HashMap;
use wgpu::{Buffer, CommandEncoder};

/// Every kernel that only steps with contacts need.
pub fn all_kernels() -> impl Iterator<Item = &'static Kernel> {
    (manifolds::KERNELS.into_iter())
        .chain(solver::KERNELS)
        .chain(kernels::KERNELS)
}

/// Lists start with room for this many things, and grow.
pub const START: StepCapacity = StepCapacity {
    contacts: ContactCapacity {
        margin_pairs: 0,
        slots: 0,
        near_triangles: 1 << 15,
        features: 1 << 13,
        segments: 1 << 12,
        staged_points: 2048,
        pairs: 256,
        points: 2048,
    },
    bodies: 0,
    touches: 2048,
};

/// Calls are kept for so many ways of cutting up a step: one for each number of substeps an interval may have.
const MAX_PROGRAMS: usize = 16;

/// Buffers and calls of steps with contacts.
pub struct Contacts {
    /// What fits.
    pub room: StepCapacity,
    /// Of contact generation.
    pub contacts: ContactBuffers,
    /// Of the solver.
    solver: Lists,
    /// Between them.
    pub lists: StepLists,
    /// Finds contact points, and moves bodies without them: [`Response::None`].
    detection: Program,
    /// Finds contact points in the first interval of a step.
    first: Program,
    /// In the others.
    other: Program,
    /// Moves bodies by them, by how often everything is done.
    solve: HashMap<Passes, Program>,
    /// Ends the step.
    last: Program,
}

impl Contacts {
    /// Makes buffers and calls. What outlives a step is empty.
    ///
    /// # Errors
    /// If the device cannot hold the lists.
    pub fn new(gpu: &Gpu, kernels: &Kernels, buffers: &Buffers, mut room: StepCapacity) -> Result<Self, TooLarge> {
        // As many as there can be: the lists are made on the device.
        let sizes = &buffers.sizes;
        room.contacts.margin_pairs = sizes.pairs;
        room.contacts.slots = sizes.bodies.saturating_mul(sizes.planes).saturating_add(sizes.pairs);
        room.bodies = room.bodies.max(sizes.bodies.saturating_add(sizes.planes));
        let solver_room = Room {
            bodies: room.bodies,
            pairs: room.contacts.pairs,
            points: room.contacts.points,
        };
        let contacts = ContactBuffers::new(gpu, room.contacts)?;
        let solver = Lists::new(gpu, solver_room)?;
        let lists = StepLists::new(gpu, &room)?;
        let recorder = Recorder {
            buffers,
            contacts: &contacts,
            solver: &solver,
            lists: &lists,
        };
        let program = |stages: &dyn Fn(&mut Builder)| {
            let mut builder = Builder::new(gpu, kernels);
            stages(&mut builder);
            builder.finish()
        };
        let detection = program(&|builder| recorder.detection(builder));
        let first = program(&|builder| recorder.interval(builder, true));
        let other = program(&|builder| recorder.interval(builder, false));
        let last = program(&|builder| recorder.last(builder));
        Ok(Self {
            room,
            contacts,
            solver,
            lists,
            detection,
            first,
            other,
            solve: HashMap::new(),
            last,
        })
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.contacts.bytes() + self.solver.bytes() + self.lists.bytes()
    }

    /// What the solver's lists hold.
    pub fn solver_room(&self) -> Room {
        self.solver.room
    }

    /// Copies what outlives a step from `old`.
    pub fn take_memory(&self, old: &Self, encoder: &mut CommandEncoder) {
        for (from, to) in old.lists.memory().into_iter().zip(self.lists.memory()) {
            encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size().min(to.size()));
        }
    }

    /// Calls of all stages for one interval, with contacts.
    pub fn dispatches(&self) -> [usize; Stage::COUNT] {
        let solve = self.solve.values().next();
        Stage::ALL.map(|stage| self.first.len(stage) + solve.map_or(0, |solve| solve.len(stage)) + self.last.len(stage))
    }

    /// Writes how long the lists are, for so many bodies and half-spaces.
    pub fn write_limits(&self, gpu: &Gpu, bodies: u32, planes: u32) {
        let limits: ContactLimits = self.room.contacts.limits(bodies, planes);
        gpu.queue
            .write_buffer(&self.contacts.limits, 0, bytemuck::bytes_of(&limits));
    }

    /// Records a step without contacts' response, whose contact points are wanted all the same.
    pub fn record_detection(
        &self,
        encoder: &mut CommandEncoder,
        buffers: &Buffers,
        bodies: u32,
        timer: Option<&Timer>,
    ) {
        encoder.clear_buffer(&self.lists.tally, 0, None);
        encoder.clear_buffer(&self.contacts.counters, 0, None);
        for stage in Stage::ALL {
            let around = timer.map(|timer| timer.around(stage, 0));
            let arguments = self.arguments(stage, buffers, Response::None);
            self.detection.record(stage, encoder, bodies, arguments, around);
        }
    }

    /// Makes the calls of intervals with these passes, if there are none yet.
    pub fn prepare(&mut self, gpu: &Gpu, kernels: &Kernels, buffers: &Buffers, passes: Passes) {
        if self.solve.contains_key(&passes) {
            return;
        }
        if self.solve.len() >= MAX_PROGRAMS {
            self.solve.clear();
        }
        let recorder = Recorder {
            buffers,
            contacts: &self.contacts,
            solver: &self.solver,
            lists: &self.lists,
        };
        let mut builder = Builder::new(gpu, kernels);
        recorder.solve(&mut builder, passes);
        let program = builder.finish();
        self.solve.insert(passes, program);
    }

    /// Records a step with contacts.
    pub fn record(&self, encoder: &mut CommandEncoder, buffers: &Buffers, input: &SolverInput, timer: Option<&Timer>) {
        let Self { lists, solver, .. } = self;
        let Some(solve) = self.solve.get(&input.passes()) else {
            return;
        };
        let copy_all = |encoder: &mut CommandEncoder, from: &Buffer, to: &Buffer| {
            encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size().min(to.size()));
        };
        encoder.clear_buffer(&lists.tally, 0, None);
        for (from, to) in [
            (&lists.kept_counters, &solver.counters),
            (&lists.kept_pairs, &solver.kept_pairs),
            (&lists.kept_points, &solver.kept_points),
            (&lists.last_pairs, &self.contacts.contact_pairs),
            (&lists.last_points, &self.contacts.contact_points),
        ] {
            copy_all(encoder, from, to);
        }
        if input.old_bodies() == 0 {
            encoder.clear_buffer(&solver.counters, 0, None);
        }
        for lap in 0..input.collision_substeps {
            let is_first = lap == 0;
            let is_last = lap + 1 == input.collision_substeps;
            let (interval, numbers, find) = if is_first {
                (&lists.first_interval, &lists.first_numbers, &self.first)
            } else {
                encoder.clear_buffer(&buffers.buckets, 0, None);
                (&lists.other_interval, &lists.other_numbers, &self.other)
            };
            copy_all(encoder, interval, &solver.interval);
            copy_all(encoder, numbers, &lists.renumbered);
            encoder.clear_buffer(&self.contacts.counters, 0, None);
            for stage in Stage::ALL {
                let program = match stage {
                    Stage::ForceScan => solve,
                    Stage::Integrate if is_last => &self.last,
                    _ => find,
                };
                let around = timer.map(|timer| timer.around(stage, lap));
                let arguments = self.arguments(stage, buffers, Response::Contacts);
                program.record(stage, encoder, input.room(), arguments, around);
                if stage == Stage::BroadPhase && is_first {
                    // To draw from.
                    copy_all(encoder, &buffers.bodies, &buffers.before);
                }
            }
        }
    }

    /// Where a stage finds how many workgroups it takes.
    fn arguments<'b>(&'b self, stage: Stage, buffers: &'b Buffers, response: Response) -> &'b Buffer {
        match stage {
            Stage::Manifolds => &self.contacts.arguments,
            Stage::ForceScan if response == Response::Contacts => &self.lists.arguments,
            _ => &buffers.arguments,
        }
    }
}

/// Adds calls.
struct Recorder<'b> {
    buffers: &'b Buffers,
    contacts: &'b ContactBuffers,
    solver: &'b Lists,
    lists: &'b StepLists,
}

impl Recorder<'_> {
    fn detection(&self, builder: &mut Builder) {
        let b = self.buffers;
        builder.stage(Stage::BroadPhase);
        broad_phase::gpu::record(builder, b);
        self.find(builder, true, false);
        builder.stage(Stage::ForceScan);
        force_scan::gpu::record(builder, b);
        builder.stage(Stage::Integrate);
        integrate::gpu::record(builder, b);
    }

    /// All of an interval up to its contact points.
    fn interval(&self, builder: &mut Builder, first: bool) {
        let (b, l) = (self.buffers, self.lists);
        let per_body = Groups::PerBodies(64);
        builder.stage(Stage::BroadPhase);
        if first {
            let begin = [
                &b.meshes,
                &b.step,
                &b.moved,
                &l.settled,
                &l.arrivals,
                &b.bodies,
                &l.states,
            ];
            builder.call(&BEGIN, &begin, per_body);
        } else {
            let place = [
                &b.meshes,
                &b.step,
                &l.states,
                &self.solver.movers,
                &b.bodies,
                &b.counters,
            ];
            builder.call(&PLACE, &place, per_body);
        }
        broad_phase::gpu::record_search(builder, b);
        self.find(builder, first, true);
    }

    /// From pairs of spheres to contact points.
    fn find(&self, builder: &mut Builder, with_triangles: bool, some_are_still: bool) {
        let (b, c) = (self.buffers, self.contacts);
        builder.stage(Stage::Angles);
        angles::gpu::record(builder, b);
        self.select(builder);
        if with_triangles {
            builder.stage(Stage::TriangleTest);
            triangle_test::gpu::record(builder, b);
        }
        builder.stage(Stage::Manifolds);
        let shared = Shared {
            step: &b.step,
            bodies: &b.bodies,
            planes: &b.planes,
            meshes: &b.meshes,
            words: &b.words,
        };
        manifolds::record_points(builder, shared, c);
        if some_are_still {
            let s = self.solver;
            let recall = [
                &b.step,
                &s.interval,
                &b.bodies,
                &c.counters,
                &c.slots,
                &c.staged,
                &c.contact_pairs,
                &c.contact_points,
                &s.counters,
            ];
            builder.call(&RECALL, &recall, Groups::Indirect(GROUPS_PER_64_SLOTS));
        }
        manifolds::record_lists(builder, c);
        let tally = [&b.step, &c.counters, &self.lists.tally, &b.status, &b.counters];
        builder.call(&TALLY, &tally, Groups::Exactly(1));
    }

    /// The pairs that contact generation looks at. Those that the broad phase finds are in the order of its buckets.
    fn select(&self, builder: &mut Builder) {
        let (b, c) = (self.buffers, self.contacts);
        let per_pair = Groups::Indirect(GROUPS_PER_64_PAIRS);
        let keys = [&b.step, &b.counters, &b.bodies, &b.near_pairs, &b.keys[0], &b.values[0]];
        builder.call(&KEYS, &keys, per_pair);
        // Those for two keys a pair are more than enough.
        let groups = [GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK].map(Groups::Indirect);
        let sort = |builder: &mut Builder, input: [&_; 2], scratch: [&_; 2]| {
            let sort = Sort {
                counters: &b.counters,
                input,
                scratch,
                digits: &b.digits,
                sums: &b.sums,
            };
            let [keys, _] = sort.record(builder, PAIR_COUNT, b.sizes.body_bits(), groups);
            std::ptr::eq(keys, input[0])
        };
        let sides = [[&b.keys[0], &b.values[0]], [&b.keys[1], &b.values[1]]];
        let mut at = 0;
        if !sort(builder, sides[at], sides[1 - at]) {
            at = 1 - at;
        }
        let [keys, values] = sides[at];
        builder.call(&ORDER, &[&b.step, &b.counters, &b.near_pairs, keys, values], per_pair);
        if !sort(builder, sides[at], sides[1 - at]) {
            at = 1 - at;
        }
        let [_, values] = sides[at];
        let pairs = [
            &b.step,
            &b.counters,
            &b.bodies,
            &b.near_pairs,
            values,
            &c.margin_pairs,
            &c.counters,
        ];
        builder.call(&PAIRS, &pairs, per_pair);
    }

    fn solve(&self, builder: &mut Builder, passes: Passes) {
        let (b, c, l, s) = (self.buffers, self.contacts, self.lists, self.solver);
        builder.stage(Stage::ForceScan);
        let inputs = Inputs {
            bodies: &l.bodies,
            states: &l.states,
            forces: &l.forces,
            renumbered: &l.renumbered,
            contact_pairs: &c.contact_pairs,
            contact_points: &c.contact_points,
            contact_counters: &c.counters,
            counter_of: [layout::CONTACT_PAIRS, layout::CONTACT_POINTS],
            status: &b.status,
            arguments: &l.arguments,
            first_slot: 0,
        };
        solver::record_solve(builder, &inputs, s, passes);
        let touches = [
            &b.step,
            &s.counters,
            &s.pairs,
            &c.contact_points,
            &s.points,
            &l.states,
            &s.shifts,
            &l.tally,
            &l.touches,
        ];
        builder.call(&TOUCHES, &touches, Groups::Indirect(SOLVER_PAIRS));
        solver::record_settle(builder, &inputs, s, passes);
    }

    fn last(&self, builder: &mut Builder) {
        let (b, c, l, s) = (self.buffers, self.contacts, self.lists, self.solver);
        builder.stage(Stage::Integrate);
        let verdict = [&b.step, &l.tally, &b.status, &b.counters];
        builder.call(&VERDICT, &verdict, Groups::Exactly(1));
        let finish = [
            &b.meshes,
            &b.step,
            &b.counters,
            &l.tally,
            &b.bodies,
            &s.movers,
            &l.states,
            &b.moved,
            &l.settled,
        ];
        builder.call(&FINISH, &finish, Groups::PerBodies(64));
        let room = &s.room;
        for (counter, count, bytes, from, to) in [
            (
                NOTHING,
                1,
                4 * solver_layout::COUNTERS as usize,
                &s.counters,
                &l.kept_counters,
            ),
            (
                solver_layout::PAIRS,
                room.pairs,
                size_of::<solver_layout::KeptPair>(),
                &s.kept_pairs,
                &l.kept_pairs,
            ),
            (
                solver_layout::POINTS,
                room.points,
                size_of::<solver_layout::KeptPoint>(),
                &s.kept_points,
                &l.kept_points,
            ),
            (
                solver_layout::PAIRS,
                room.pairs,
                size_of::<layout::ContactPair>(),
                &c.contact_pairs,
                &l.last_pairs,
            ),
            (
                solver_layout::POINTS,
                room.points,
                size_of::<layout::ContactPoint>(),
                &c.contact_points,
                &l.last_points,
            ),
        ] {
            let quads = bytes as u32 / 16;
            let constants = builder.constants([counter, quads, 0, 0]);
            let groups = count.saturating_mul(quads).div_ceil(64);
            let keep = [&constants, &b.counters, &s.counters, from, to];
            builder.call(&KEEP, &keep, Groups::Exactly(groups));
        }
    }
}
