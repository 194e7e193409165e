//! How many collision substeps each body needs: the largest number that it or a body that it can meet needs. The device
//! counts them, because only it knows where the bodies are. A body that has completed its step keeps its pose and its
//! contact points while others go on. The twin of the CPU's `step/reach`, `step/territories` and `step/schedule`.
//!
//! The commands of a step are recorded before the largest number is known, for a number that the last steps suggest. If
//! the step needs more, it does nothing and is repeated, as if a list were too short; if it needs fewer, the last ones
//! do nothing. So the results are the same for any number that suffices.

use crate::broad_phase;
use crate::gpu::buffers::Capacity;
use crate::gpu::kernel::{Kernel, kernel};
use crate::gpu::layout::{Division, GROUPS_PER_64_PAIRS};
use crate::gpu::program::{Calls, Groups};
use crate::gpu::shader::{Module, shared_constants};
use crate::solver::CollisionSubstep;
use crate::solver::gpu::layout::Pace;
use crate::solver::gpu::upload;
use crate::state::StepConfig;
use crate::step::territories;
use crate::types::solver_settings::MAX_COLLISION_SUBSTEPS;

/// Computes the spheres that bodies sweep over in the step.
pub(super) const SWEEPS: Kernel = kernel!("step/sweeps");
/// Joins bodies that can meet.
pub(super) const JOIN_GROUPS: Kernel = kernel!("step/join_groups");
/// Adds bodies to their groups.
pub(super) const GROUP_BODIES: Kernel = kernel!("step/group_bodies");
/// Finds groups in which bodies can meet.
pub(super) const GROUP_PAIRS: Kernel = kernel!("step/group_pairs");
/// Counts the collision substeps that they need.
pub(super) const COUNT_SUBSTEPS: Kernel = kernel!("step/count_substeps");
/// Keeps groups with different numbers apart.
pub(super) const TERRITORIES: Kernel = kernel!("step/territories");
/// Gives each body its number.
pub(super) const SCHEDULE: Kernel = kernel!("step/schedule");
/// Begins a collision substep.
pub(super) const BEGIN_SUBSTEP: Kernel = kernel!("step/begin_substep");

/// After this many comparisons of bodies with territories of groups all bodies get the largest number: one workgroup
/// compares them.
const MAX_COMPARISONS: u32 = 1 << 22;

pub(super) const CONSTANTS: Module = shared_constants!("faceoff::constants::reach", {
    f32 MAX_SPEED_GAIN = territories::MAX_SPEED_GAIN;
    u32 MAX_COMPARISONS = MAX_COMPARISONS;
});

/// Adds the calls that count the collision substeps, after the bodies are placed.
pub(super) fn record(calls: &mut Calls, capacity: &Capacity) {
    let per_body = Groups::PerBodies(64);
    let per_pair = Groups::per_64(capacity.pairs, Groups::Indirect("arguments", GROUPS_PER_64_PAIRS));
    calls.call(&SWEEPS, per_body);
    broad_phase::gpu::record_swept_search(calls, capacity);
    calls.call(&JOIN_GROUPS, per_pair);
    calls.call(&GROUP_BODIES, per_body);
    calls.call(&GROUP_PAIRS, per_pair);
    calls.call(&COUNT_SUBSTEPS, per_body);
    calls.call(&TERRITORIES, Groups::Exactly(1));
    calls.call(&SCHEDULE, per_body);
    calls.call(&BEGIN_SUBSTEP, Groups::Exactly(1));
}

/// The paces of bodies with 1, 2, ... collision substeps in a step, of which no body needs more than `most`.
pub(super) fn paces(config: &StepConfig, most: u32) -> Vec<Pace> {
    let pace = |count| upload::pace(&config.solver, CollisionSubstep::of(config, count).pace());
    (1..=most).map(pace).collect()
}

/// The rule for their number, for a step with commands for `recorded`.
pub(super) fn division(config: &StepConfig, recorded: u32) -> Division {
    Division {
        travel: config.solver.collision_substep_travel,
        most: most(config),
        recorded,
        padding: 0,
    }
}

/// No body has more collision substeps.
pub(super) fn most(config: &StepConfig) -> u32 {
    config.solver.max_collision_substeps.clamp(1, MAX_COLLISION_SUBSTEPS)
}

/// The numbers of collision substeps that the last steps needed.
#[derive(Debug, Default)]
pub(super) struct RecentSubsteps {
    /// So many are recorded beyond what the last steps suggest.
    pub spare: u32,
    /// 0: there was no such step.
    needed: [u32; REMEMBERED],
    /// Where the next one goes.
    at: usize,
}

/// So many steps are remembered. A repetition costs more than some collision substeps that do nothing.
const REMEMBERED: usize = 8;

impl RecentSubsteps {
    /// Adds the number that a step needed.
    pub fn add(&mut self, needed: u32) {
        self.needed[self.at] = needed;
        self.at = (self.at + 1) % REMEMBERED;
    }

    /// The number of collision substeps for which commands are recorded, if no more than `most` can be needed. Where
    /// bodies meet the number changes often, so there is one to spare.
    pub fn recorded(&self, most: u32) -> u32 {
        let needed = self.needed.into_iter().max().unwrap_or(0);
        let suggested = match needed {
            // The device does not count them.
            _ if most == 1 => return 1,
            0 => most,
            1 => 1,
            _ => (needed + 1).min(most),
        };
        (suggested + self.spare).min(MAX_COLLISION_SUBSTEPS)
    }

    /// Forgets the last steps.
    pub fn forget(&mut self) {
        self.needed = Default::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_are_recorded_as_the_last_steps_needed() {
        let mut recent = RecentSubsteps::default();
        assert_eq!(recent.recorded(5), 5, "nothing is known");
        recent.add(1);
        assert_eq!(recent.recorded(5), 1);
        recent.add(3);
        for _ in 1..REMEMBERED {
            assert_eq!(recent.recorded(8), 4);
            assert_eq!(recent.recorded(2), 2);
            recent.add(1);
        }
        recent.add(1);
        assert_eq!(recent.recorded(8), 1);
    }
}
