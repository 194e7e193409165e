//! The state that persists from one step to the next.

use super::remap;
use crate::ccd::stage::Ccd;
use crate::sleep::inputs::PlacedSleepInputs;
use crate::solver::{SleepState, SolverBodies, WarmStart};
use crate::state::inactive::{GONE, InactiveBodies};
use crate::state::revision::Revision;
use crate::state::{Plane, StepInput};
use crate::types::body::RigidBody;
use glam::Vec3;

/// The state that persists from step to step. Together with the manifolds of the last step and the motion of the bodies
/// it determines the next step to the bit.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StepMemory {
    /// Keys of the bodies of the last step, ascending.
    pub(super) keys: Vec<u64>,
    /// The state of each of them.
    pub(super) bodies: Vec<SavedBody>,
    pub(super) planes: Vec<Plane>,
    pub(super) gravity: Vec3,
    /// The impulses of the last collision substep.
    pub(super) warm: WarmStart,
    /// The keys of pairs that a hook left out, ascending.
    pub(super) left_out: Vec<[u64; 2]>,
    /// The state of the static bodies.
    #[serde(skip)]
    pub(super) revision: Revision,
    /// Names which of them has which number.
    #[serde(skip)]
    pub(super) layout: Revision,
}

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct SavedBody {
    pub sleep: SleepState,
    pub inputs: PlacedSleepInputs,
    /// The number of its body.
    pub body: u32,
    /// Whether the body had an impact in continuous collision detection.
    pub had_impact: bool,
}

impl StepMemory {
    /// The keys of the bodies of the last step, ascending; none if that left nothing.
    #[cfg(feature = "bevy")]
    pub(crate) fn keys(&self) -> &[u64] {
        &self.keys
    }

    /// Forgets everything: the next step begins with awake bodies and without impulses.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Restores the sleep state of `solver_bodies`, which are the awake bodies of `input`, and finds out which of them
    /// are unchanged since the last step.
    pub(super) fn restore(&self, input: &StepInput, solver_bodies: &mut SolverBodies, inactive: &mut InactiveBodies) {
        let StepInput {
            config, bodies, planes, ..
        } = input;
        let all_wake = self.gravity != config.gravity;
        // The bodies that have the numbers of the last step.
        let same = bodies.same_since(self.revision, self.layout).min(self.keys.len());
        let changed = bodies.static_changes_since(self.revision);
        let has_active_static = changed.is_none_or(|changed| !changed.is_empty());
        inactive.begin(solver_bodies.len(), same, bodies.movers(), has_active_static);
        // Taken out, because the others change meanwhile.
        let keys = std::mem::take(&mut solver_bodies.keys);
        let mut restore = |i: usize, before: usize| {
            let SavedBody {
                mut sleep,
                inputs,
                had_impact,
                ..
            } = self.bodies[before];
            let same = inputs == PlacedSleepInputs::of(input, i);
            let params = &bodies.params[i];
            let motion = &solver_bodies.motions[i];
            let at_rest = motion.linear_velocity == Vec3::ZERO && motion.angular_velocity == Vec3::ZERO;
            // A body under an impulse or a force is awake from the start of the step: its speed counts for collision
            // substeps, and its contact points are found.
            let is_woken = params.woken || !same || !at_rest || !solver_bodies.forces[i].is_zero();
            if !params.can_sleep || is_woken && sleep.asleep || all_wake {
                sleep = SleepState::default();
            }
            solver_bodies.sleep[i] = sleep;
            // A body with a recent impact is likely to have another one with the same body, so it needs collision
            // substeps too.
            solver_bodies.bodies[i].continuous &= !had_impact;
            inactive.flags[i] = same && (bodies.kind[i] == RigidBody::Static || sleep.asleep);
            inactive.any |= sleep.asleep;
            if bodies.kind[i] == RigidBody::Kinematic && !same {
                inactive.replaced.push(i as u32);
            }
        };
        let (before, now) = (&self.keys[same..], &keys[same..bodies.len()]);
        let are_same = before == now;
        let mut numbers = vec![GONE; if are_same { 0 } else { before.len() }];
        let changed = changed.unwrap_or_default().iter().map(|&i| i as usize);
        let again = changed.chain(bodies.movers().take_while(|&i| i < same));
        again.for_each(|i| restore(i, i));
        if are_same {
            (same..bodies.len()).for_each(|i| restore(i, i));
        } else {
            for (i, number) in (same..).zip(remap::previous_numbers(before, now)) {
                let Some(number) = number.map(|number| number as usize) else {
                    continue;
                };
                restore(i, same + number);
                let is_static = |kind: RigidBody| kind == RigidBody::Static;
                // One that begins or ends to move has another place among the numbers, and its pairs are new.
                if is_static(bodies.kind[i]) == is_static(self.bodies[same + number].inputs.inputs.kind) {
                    numbers[number] = i as u32;
                }
            }
        }
        solver_bodies.keys = keys;
        wake_whole_bodies(solver_bodies, &mut inactive.flags);
        let same_planes = self.planes == *planes;
        inactive.set_planes(bodies.len(), same_planes);
        if !are_same || self.planes.len() != planes.len() {
            if are_same {
                numbers.extend(same as u32..bodies.len() as u32);
            }
            remap::renumber_planes(&mut numbers, self.planes.len(), bodies.len(), planes.len());
        }
        inactive.set_numbers(same, numbers);
    }

    /// Saves the state that the next step needs.
    pub(super) fn save(&mut self, input: &StepInput, solver_bodies: &SolverBodies, ccd: &Ccd) {
        let count = input.bodies.len();
        let saved = |i: usize| SavedBody {
            sleep: solver_bodies.sleep[i],
            inputs: PlacedSleepInputs::of(input, i),
            body: input.bodies.body_of(i as u32),
            had_impact: ccd.had_impact(input.bodies.body_of(i as u32) as usize),
        };
        let same = input.bodies.same_since(self.revision, self.layout).min(self.keys.len());
        self.keys.truncate(same);
        self.keys.extend_from_slice(&solver_bodies.keys[same..count]);
        self.bodies.truncate(same);
        let changed = input.bodies.static_changes_since(self.revision);
        let changed = changed.unwrap_or_default().iter().map(|&i| i as usize);
        let again = changed.chain(input.bodies.movers().take_while(|&i| i < same));
        again.for_each(|i| self.bodies[i] = saved(i));
        self.bodies.extend((same..count).map(saved));
        self.revision = input.bodies.revision;
        self.layout = input.bodies.layout;
        input.planes.clone_into(&mut self.planes);
        self.gravity = input.config.gravity;
    }
}

/// A body of several colliders is asleep, and unchanged, if all of them are.
fn wake_whole_bodies(bodies: &mut SolverBodies, unchanged: &mut [bool]) {
    let parts = std::mem::take(&mut bodies.parts);
    for part in &parts {
        let (i, body) = (part.collider as usize, part.body as usize);
        if !bodies.sleep[i].asleep {
            bodies.sleep[body].asleep = false;
        }
        unchanged[body] &= unchanged[i];
    }
    for part in &parts {
        unchanged[part.collider as usize] = unchanged[part.body as usize];
    }
    bodies.parts = parts;
    bodies.share_sleep();
}
