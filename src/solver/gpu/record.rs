//! An interval as calls.

use super::kernels::*;
use super::layout::*;
use super::lists::{Inputs, Lists};
use crate::gpu::kernel::{Builder, Groups};
use crate::gpu::radix_sort::Sort;
use crate::sleep::gpu as sleep;
use crate::solver::CollisionSubstep;
use crate::types::solver_settings::SolverSettings;
use wgpu::Buffer;

/// How often everything is done in an interval: all that calls depend on beside buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Passes {
    substeps: u32,
    bias: u32,
    relax: u32,
    bounce: u32,
    sleeping: bool,
}

impl Passes {
    /// Those of an interval.
    pub fn new(settings: &SolverSettings, interval: &CollisionSubstep) -> Self {
        Self {
            substeps: interval.substeps.max(1),
            bias: settings.bias_iterations,
            relax: settings.relax_iterations,
            bounce: settings.restitution_iterations,
            sleeping: settings.sleeping,
        }
    }
}

/// Adds the calls of one interval.
pub fn record(builder: &mut Builder, inputs: &Inputs, lists: &Lists, passes: Passes) {
    record_solve(builder, inputs, lists, passes);
    record_settle(builder, inputs, lists, passes);
}

/// Adds those that find who falls asleep.
pub fn record_settle(builder: &mut Builder, inputs: &Inputs, lists: &Lists, passes: Passes) {
    if passes.sleeping {
        sleep::record(builder, inputs, lists, SETTLE);
    }
}

/// Adds those before.
pub fn record_solve(builder: &mut Builder, inputs: &Inputs, lists: &Lists, passes: Passes) {
    let recorder = Recorder::new(builder, inputs, lists);
    recorder.count(builder);
    if passes.sleeping {
        sleep::record(builder, inputs, lists, WAKE);
    } else {
        sleep::record_without(builder, inputs, lists);
    }
    recorder.prepare(builder);
    for substep in 1..=passes.substeps {
        let last = substep == passes.substeps;
        recorder.substep(builder, passes, last);
    }
    recorder.bounce(builder, passes.bounce);
    recorder.finish(builder);
}

/// A body's part in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Take {
    /// Counts the pairs that push the body first.
    shares: bool,
    /// What follows.
    then: u32,
}

/// The buffers, and the small uniforms that calls share.
struct Recorder<'b> {
    inputs: &'b Inputs<'b>,
    lists: &'b Lists,
    pairs: Groups,
    bodies: Groups,
    /// By what a pass does beside solving.
    passes: [Buffer; 4],
    /// By `then`, without counting and with.
    takes: [[Buffer; 4]; 2],
    /// Sorted ends: their bodies, and themselves.
    ends: [&'b Buffer; 2],
}

impl<'b> Recorder<'b> {
    fn new(builder: &Builder, inputs: &'b Inputs<'b>, lists: &'b Lists) -> Self {
        let slot = |slot| Groups::Indirect(inputs.first_slot + slot);
        let takes = |shares| [0, 1, 2, 3].map(|then| builder.constants([shares, then, 0, 0]));
        Self {
            inputs,
            lists,
            pairs: slot(GROUPS_PER_64_PAIRS),
            bodies: slot(GROUPS_PER_64_BODIES),
            passes: [0, 1, 2, 3].map(|flags| builder.constants([flags, 0, 0, 0])),
            takes: [0, 1].map(takes),
            ends: sorted_ends(lists),
        }
    }

    fn count(&self, builder: &mut Builder) {
        let (i, l) = (self.inputs, self.lists);
        let constants = builder.constants([i.counter_of[0], i.counter_of[1], i.first_slot, 0]);
        let counts = [
            &l.interval,
            &constants,
            i.contact_counters,
            i.status,
            &l.counters,
            i.arguments,
        ];
        builder.call(&ARGUMENTS, &counts, Groups::Exactly(1));
    }

    fn prepare(&self, builder: &mut Builder) {
        let (i, l) = (self.inputs, self.lists);
        let bodies = [
            &l.interval,
            i.bodies,
            i.states,
            i.forces,
            &l.movers,
            &l.velocities,
            &l.masses,
            &l.shifts,
            &l.links,
        ];
        builder.call(&BEGIN, &bodies, self.bodies);
        let old = Groups::Indirect(i.first_slot + GROUPS_PER_64_OLD_BODIES);
        builder.call(&RENUMBER, &[&l.interval, i.renumbered, &l.links], old);
        let pairs = [
            &l.interval,
            &l.counters,
            i.contact_pairs,
            i.bodies,
            i.states,
            &l.masses,
            &l.links,
            &l.kept_pairs,
            &l.pairs,
        ];
        builder.call(&PREPARE_PAIRS, &pairs, self.pairs);
        let points = [
            &l.interval,
            &l.counters,
            i.contact_points,
            &l.pairs,
            &l.kept_pairs,
            &l.kept_points,
            &l.movers,
            &l.shapes,
            &l.points,
        ];
        builder.call(&PREPARE_POINTS, &points, self.pairs);
        self.sort_ends(builder);
    }

    fn sort_ends(&self, builder: &mut Builder) {
        let l = self.lists;
        let ends = [&l.interval, &l.counters, &l.pairs, &l.keys, &l.values];
        builder.call(&ENDS, &ends, self.pairs);
        let sort = Sort {
            counters: &l.counters,
            input: [&l.keys, &l.values],
            scratch: [&l.other_keys, &l.other_values],
            digits: &l.digits,
            sums: &l.sums,
        };
        let groups = [GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK];
        let groups = groups.map(|slot| Groups::Indirect(self.inputs.first_slot + slot));
        sort.record(builder, ENTRIES, l.room.body_bits(), groups);
        let segments = [&l.interval, &l.counters, self.ends[0], &l.links];
        builder.call(&SEGMENTS, &segments, self.pairs);
    }

    /// Bodies have sped up already; unless it is the last one they do so again at its end, for the next.
    fn substep(&self, builder: &mut Builder, passes: Passes, last: bool) {
        let l = self.lists;
        let substep = [
            &l.interval,
            &l.counters,
            &l.pairs,
            &l.shapes,
            &l.points,
            &l.masses,
            &l.shifts,
            &l.velocities,
            &l.impulses,
        ];
        builder.call(&BEGIN_SUBSTEP, &substep, self.pairs);
        let mut takes = vec![Take::default(); 1 + passes.bias as usize + passes.relax as usize];
        takes[0].shares = true;
        takes[passes.bias as usize].then |= THEN_ADVANCE;
        if !last && let Some(end) = takes.last_mut() {
            end.then |= THEN_ACCELERATE;
        }
        for (k, take) in (0..).zip(takes) {
            if k > 0 {
                let biased = k <= passes.bias;
                // The first pass after the bodies have moved.
                let measures = k == passes.bias + 1;
                let flag = |set: bool, flag| if set { flag } else { 0 };
                self.pass(builder, flag(biased, PASS_BIASED) | flag(measures, PASS_MEASURES));
            }
            self.take(builder, take);
        }
    }

    fn pass(&self, builder: &mut Builder, flags: u32) {
        let l = self.lists;
        let pass = [
            &l.interval,
            &self.passes[flags as usize],
            &l.counters,
            &l.pairs,
            &l.shapes,
            &l.points,
            &l.masses,
            &l.shifts,
            &l.velocities,
            &l.impulses,
        ];
        builder.call(&PASS, &pass, self.pairs);
    }

    fn take(&self, builder: &mut Builder, take: Take) {
        let l = self.lists;
        let buffers = [
            &l.interval,
            &self.takes[usize::from(take.shares)][take.then as usize],
            &l.movers,
            &l.velocities,
            &l.masses,
            &l.shifts,
            &l.links,
            self.ends[1],
            &l.impulses,
            &l.pairs,
        ];
        builder.call(&TAKE, &buffers, self.bodies);
    }

    fn bounce(&self, builder: &mut Builder, times: u32) {
        let l = self.lists;
        let begin = [
            &l.interval,
            &l.counters,
            &l.pairs,
            &l.shapes,
            &l.points,
            &l.masses,
            &l.shifts,
            &l.impulses,
        ];
        builder.call(&BOUNCE_BEGIN, &begin, self.pairs);
        let shares = Take { shares: true, then: 0 };
        self.take(builder, shares);
        let bounce = [&l.counters, &l.pairs, &l.points, &l.masses, &l.velocities, &l.impulses];
        for _ in 0..times {
            builder.call(&BOUNCE, &bounce, self.pairs);
            self.take(builder, Take::default());
        }
    }

    fn finish(&self, builder: &mut Builder) {
        let l = self.lists;
        let finish = [&l.interval, &l.movers, &l.velocities, &l.shifts, self.inputs.states];
        builder.call(&FINISH, &finish, self.bodies);
        let keep = [
            &l.interval,
            &l.counters,
            &l.pairs,
            &l.shapes,
            &l.points,
            &l.movers,
            &l.kept_pairs,
            &l.kept_points,
        ];
        builder.call(&KEEP, &keep, self.pairs);
    }
}

/// Where the sort leaves its keys and values: every digit moves them to the other side.
fn sorted_ends(lists: &Lists) -> [&Buffer; 2] {
    let digits = lists.room.body_bits().div_ceil(crate::gpu::radix_sort::DIGIT);
    if digits.is_multiple_of(2) {
        [&lists.keys, &lists.values]
    } else {
        [&lists.other_keys, &lists.other_values]
    }
}
