//! An interval as calls.

use super::*;
use crate::gpu::program::{Calls, Groups};
use crate::gpu::radix_sort::Sort;
use crate::solver::CollisionSubstep;
use crate::types::solver_settings::SolverSettings;
use layout::*;

/// How often everything is done in an interval: all that calls depend on beside buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Passes {
    substeps: u32,
    bias: u32,
    relax: u32,
    bounce: u32,
    /// Whether bodies may fall asleep.
    pub sleeping: bool,
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

/// Adds the call that counts pairs and points, and says how many workgroups all others have. It comes before all else.
pub fn record_arguments(calls: &mut Calls) {
    calls.call(&ARGUMENTS, Groups::Exactly(1));
}

/// Adds the calls that solve an interval.
pub fn record(calls: &mut Calls, room: &Room, passes: Passes) {
    let ends = prepare(calls, room);
    let mut recorder = Recorder { calls, ends };
    for substep in 1..=passes.substeps {
        recorder.substep(passes, substep == passes.substeps);
    }
    recorder.restitution(passes.bounce);
    recorder.finish();
}

/// As many groups as it takes for a thread a body.
pub(crate) const fn per_body() -> Groups {
    per(GROUPS_PER_64_BODIES)
}

/// As many groups as it takes for a thread a pair.
pub(crate) const fn per_pair() -> Groups {
    per(GROUPS_PER_64_PAIRS)
}

const fn per(slot: u32) -> Groups {
    Groups::Indirect("solver_arguments", slot)
}

const SORT: Sort = Sort {
    counters: "solver_counters",
    input: ["end_keys", "ends"],
    scratch: ["other_end_keys", "other_ends"],
    digits: "end_digits",
    sums: "end_sums",
};

/// Adds the calls before the first substep, and tells where the sorted ends are.
fn prepare(calls: &mut Calls, room: &Room) -> &'static str {
    calls.call(&BEGIN, per_body());
    calls.call(&WARM_START_RENUMBER, per(GROUPS_PER_64_OLD_BODIES));
    calls.call(&CONSTRAINTS, per_pair());
    calls.call(&WARM_START, per_pair());
    calls.call(&ENDS, per_pair());
    let groups = [GROUPS_PER_SORT_BLOCK, GROUPS_PER_DIGIT_BLOCK].map(per);
    let [keys, ends] = SORT.record(calls, ENTRIES, room.body_bits(), groups);
    calls.call(&SEGMENTS, per_pair()).bind("end_keys", keys);
    ends
}

/// What bodies do with the impulses of a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Take {
    /// Counts the pairs that push the body first.
    shares: bool,
    /// What follows.
    then: u32,
}

struct Recorder<'c> {
    calls: &'c mut Calls,
    /// Where the sorted ends are.
    ends: &'static str,
}

impl Recorder<'_> {
    /// Bodies have sped up already; unless it is the last one they do so again at its end, for the next.
    fn substep(&mut self, passes: Passes, last: bool) {
        self.calls.call(&SUBSTEP_BEGIN, per_pair());
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
                let flags = flag(biased, PASS_BIASED) | flag(measures, PASS_MEASURES);
                self.calls.call(&SOLVE, per_pair()).constants([flags, 0, 0, 0]);
            }
            self.apply_impulses(take);
        }
    }

    fn apply_impulses(&mut self, take: Take) {
        let call = self.calls.call(&APPLY_IMPULSES, per_body());
        call.constants([take.shares.into(), take.then, 0, 0])
            .bind("ends", self.ends);
    }

    fn restitution(&mut self, times: u32) {
        self.calls.call(&RESTITUTION_BEGIN, per_pair());
        self.apply_impulses(Take { shares: true, then: 0 });
        for _ in 0..times {
            self.calls.call(&RESTITUTION, per_pair());
            self.apply_impulses(Take::default());
        }
    }

    fn finish(&mut self) {
        self.calls.call(&FINISH, per_body());
        self.calls.call(&WARM_START_KEEP, per_pair());
    }
}
