//! What a step leaves for the next one.

use super::remap;
use crate::ccd::stops::Stops;
use crate::sleep::traits::PlacedTraits;
use crate::solver::{SleepState, SolverBodies, WarmStart};
use crate::state::inactive::{GONE, InactiveBodies};
use crate::state::{Plane, StepInput};
use crate::types::body::RigidBody;
use glam::Vec3;

/// What is kept from step to step. With it, the last step's manifolds and the bodies' motions a step can be repeated, to the
/// bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepMemory {
    /// The last step's bodies, ascending.
    keys: Vec<u64>,
    /// What is kept of each.
    bodies: Vec<BodyMemory>,
    planes: Vec<Plane>,
    gravity: Vec3,
    /// The impulses of the last collision substep.
    pub(super) warm: WarmStart,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct BodyMemory {
    sleep: SleepState,
    traits: PlacedTraits,
    /// It was stopped by others that it met.
    stopped: bool,
}

impl StepMemory {
    /// Nothing is kept: the next step begins with bodies that are awake and push nothing.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Finds out which of the solver's bodies, which are those of `input` and awake, go on sleeping, and which of them nothing has
    /// changed about.
    pub(super) fn recall(&self, input: &StepInput, moved: &mut SolverBodies, inactive: &mut InactiveBodies) {
        let StepInput {
            config, bodies, planes, ..
        } = input;
        let all_wake = self.gravity != config.gravity;
        inactive.flags.resize(moved.len(), false);
        inactive.numbers.resize(self.keys.len(), GONE);
        let numbers = remap::numbers_before(self.keys.iter(), &moved.keys[..bodies.len()]);
        for (i, before) in numbers.enumerate() {
            let Some(before) = before.map(|number| number as usize) else {
                continue;
            };
            inactive.numbers[before] = i as u32;
            let BodyMemory {
                mut sleep,
                traits,
                stopped,
            } = self.bodies[before];
            let same = traits == PlacedTraits::of(input, i);
            let params = &bodies.params[i];
            if !params.can_sleep || params.woken && sleep.asleep || sleep.asleep && !same || all_wake {
                sleep = SleepState::default();
            }
            moved.sleep[i] = sleep;
            // What has just met something is looked at as often as others: it will meet it again.
            moved.bodies[i].continuous &= !stopped;
            let (motion, forces) = (&moved.motions[i], &moved.forces[i]);
            let rests = motion.linear_velocity == Vec3::ZERO && motion.angular_velocity == Vec3::ZERO;
            inactive.flags[i] =
                same && (bodies.kind[i] == RigidBody::Static || (sleep.asleep && rests && forces.is_zero()));
            inactive.has_sleepers |= sleep.asleep;
        }
        let same_planes = self.planes == *planes;
        inactive.flags[bodies.len()..].fill(same_planes);
        remap::renumber_planes(&mut inactive.numbers, self.planes.len(), bodies.len(), planes.len());
    }

    /// Keeps what the next step needs.
    pub(super) fn keep(&mut self, input: &StepInput, moved: &SolverBodies, stops: &Stops) {
        let count = input.bodies.len();
        self.keys.clear();
        self.keys.extend_from_slice(&moved.keys[..count]);
        self.bodies.clear();
        self.bodies.extend((0..count).map(|i| BodyMemory {
            sleep: moved.sleep[i],
            traits: PlacedTraits::of(input, i),
            stopped: stops.has_stopped(i),
        }));
        input.planes.clone_into(&mut self.planes);
        self.gravity = input.config.gravity;
    }
}
