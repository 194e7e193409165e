//! Keeps groups with different numbers of collision substeps apart.
//!
//! Such groups are at different times of the step while it runs: one may have completed it while another has begun. So
//! their bodies must not come near each other at any time. The territory of a group is a box around all places that its
//! bodies may reach, even if impulses within the group turn and speed them up. Groups whose territories overlap are
//! joined, unless both have the same number. A group that sleeps moves only after another has crossed the gap between
//! them, so it reaches only as far as the rest of the other's way. The twin on a GPU gives it the whole way.

use super::reach::{Meeting, Sweep};
use crate::geometry::union_find::UnionFind;
use crate::state::{Bodies, StepConfig};
use glam::DVec3;

/// Impulses within a group change velocities by at most this multiple of the group's relative speed: a light body that
/// a heavy one hits leaves with twice its speed.
pub(super) const MAX_SPEED_GAIN: f32 = 2.0;
/// After this many comparisons of territories all awake groups are joined, and after as many again all groups: more
/// comparisons would take longer than the collision substeps that they save.
const MAX_COMPARISONS: usize = 1 << 17;

/// Scratch memory.
#[derive(Default)]
pub(super) struct Territories {
    all: Vec<Territory>,
}

/// A group of bodies and the box that their bodies sweep over.
#[derive(Clone, Copy)]
struct Territory {
    /// First body of the group.
    root: u32,
    /// Whether some body is awake.
    awake: bool,
    /// The box of what its bodies sweep over, enlarged by `reached`.
    low: DVec3,
    high: DVec3,
    /// How much of the [reach](reach) of the group the box has already, metres.
    reached: f64,
}

impl Territories {
    /// Joins groups with different numbers of collision substeps whose territories overlap.
    pub fn separate(
        &mut self,
        bodies: &Bodies,
        config: &StepConfig,
        is_awake: impl Fn(u32) -> bool,
        groups: &mut UnionFind,
        meetings: &mut [Meeting],
    ) {
        self.find(bodies, config, is_awake, groups);
        // What sleeps far away must not change how what is awake moves.
        let mut awake = self.all.iter().filter(|territory| territory.awake).count();
        let mut comparisons = 0;
        let mut i = 0;
        while i < self.all.len() {
            let own = self.all[i];
            let neighbour = if meetings[own.root as usize].collision_substeps > 1 {
                comparisons += awake + 1;
                self.neighbour(&own, config, meetings)
            } else {
                // Neighbours with more collision substeps find this group.
                None
            };
            if comparisons > MAX_COMPARISONS {
                let all_join = awake == 1;
                let joins = |territory: &Territory| all_join || territory.awake;
                while let Some(last) = self.all.iter().rposition(joins)
                    && let Some(first) = self.all.iter().position(joins)
                    && first < last
                {
                    self.join([first, last], config, groups, meetings);
                }
                if all_join {
                    return;
                }
                (awake, comparisons, i) = (1, 0, 0);
                continue;
            }
            match neighbour {
                Some(other) => {
                    awake -= usize::from(self.all[other].awake && self.all[i].awake);
                    self.join([i, other], config, groups, meetings);
                    // A larger territory may have new neighbours.
                    i = 0;
                }
                None => i += 1,
            }
        }
    }

    /// Whether a group with several collision substeps may reach a box within the step.
    pub fn reach(&self, [low, high]: [DVec3; 2], config: &StepConfig, meetings: &[Meeting]) -> bool {
        let place = Territory {
            root: 0,
            awake: false,
            low,
            high,
            reached: 0.0,
        };
        self.all.iter().any(|own| {
            let meeting = &meetings[own.root as usize];
            meeting.collision_substeps > 1 && own.gap(&place) <= own.rest_of_reach(config, meeting)
        })
    }

    /// A group with another number of collision substeps whose territory overlaps this one.
    fn neighbour(&self, own: &Territory, config: &StepConfig, meetings: &[Meeting]) -> Option<usize> {
        let meeting = |territory: &Territory| &meetings[territory.root as usize];
        let rest = |territory: &Territory| territory.rest_of_reach(config, meeting(territory));
        let own_rest = rest(own);
        let differs = |other: &Territory| meeting(other).collision_substeps != meeting(own).collision_substeps;
        let others = self.all.iter();
        others
            .enumerate()
            .find(|(_, other)| differs(other) && own.gap(other) <= own_rest + rest(other))
            .map(|(number, _)| number)
    }

    /// Joins two groups. The second one leaves the list.
    fn join(
        &mut self,
        [one, other]: [usize; 2],
        config: &StepConfig,
        groups: &mut UnionFind,
        meetings: &mut [Meeting],
    ) {
        let [a, b] = [one, other].map(|i| self.all[i]);
        groups.join(a.root, b.root);
        let root = groups.root(a.root);
        let joined = meetings[b.root as usize];
        let mut meeting = meetings[a.root as usize];
        meeting.join(&joined, config);
        meetings[root as usize] = meeting;
        self.all[one] = a.with(&b, reach(config, &meeting), root);
        // In order, so that what happens far away changes nothing here.
        self.all.remove(other);
    }

    fn find(&mut self, bodies: &Bodies, config: &StepConfig, is_awake: impl Fn(u32) -> bool, groups: &mut UnionFind) {
        self.all.clear();
        // The root is the smallest member, so it comes first, and the list is ascending by root.
        for i in bodies.movers().map(|i| i as u32) {
            let root = groups.root(i);
            let [low, high] = Sweep::of(bodies, config, i).bounds();
            let awake = is_awake(i);
            match self.all.binary_search_by_key(&root, |territory| territory.root) {
                Ok(at) => {
                    let territory = &mut self.all[at];
                    territory.awake |= awake;
                    territory.low = territory.low.min(low);
                    territory.high = territory.high.max(high);
                }
                Err(at) => {
                    let territory = Territory {
                        root,
                        awake,
                        low,
                        high,
                        reached: 0.0,
                    };
                    self.all.insert(at, territory);
                }
            }
        }
    }
}

/// How far impulses within a group may take its bodies out of their way in a step, metres.
fn reach(config: &StepConfig, meeting: &Meeting) -> f64 {
    f64::from(MAX_SPEED_GAIN * config.dt * meeting.speeds.relative())
}

impl Territory {
    /// How far its bodies may leave the box, metres.
    fn rest_of_reach(&self, config: &StepConfig, meeting: &Meeting) -> f64 {
        (reach(config, meeting) - self.reached).max(0.0)
    }

    /// The distance of two boxes along the axis on which they are farthest apart, metres; negative if they overlap.
    fn gap(&self, other: &Self) -> f64 {
        (self.low - other.high).max(other.low - self.high).max_element()
    }

    /// The territory of two groups that are joined, and together have this `reach`.
    fn with(&self, other: &Self, reach: f64, root: u32) -> Self {
        let gap = self.gap(other).max(0.0);
        let rest = |own: &Self, other: &Self| {
            let until_it_moves = match own.awake {
                true => own.reached,
                false => own.reached.max(other.reached + gap),
            };
            DVec3::splat((reach - until_it_moves).max(0.0))
        };
        let (own_rest, other_rest) = (rest(self, other), rest(other, self));
        Self {
            root,
            awake: self.awake || other.awake,
            low: (self.low - own_rest).min(other.low - other_rest),
            high: (self.high + own_rest).max(other.high + other_rest),
            reached: reach,
        }
    }
}
