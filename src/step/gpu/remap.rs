//! Body remap on the GPU: the numbers of bodies in the last submitted step and in this one, and what carries over.

use crate::gpu::layout::{CARRIED_SLEEP, CONTINUES, WOKEN};
use crate::sleep::inputs::SleepInputs;
use crate::state::inactive::GONE;
use crate::state::{Plane, StepInput};
use crate::step::remap;
use crate::types::body::RigidBody;
use glam::Vec3;

/// State of the last submitted step whose change wakes bodies. Poses are known to the device only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LastBodies {
    /// Ascending.
    pub(super) keys: Vec<u64>,
    pub(super) sleep_inputs: Vec<SleepInputs>,
    pub(super) planes: Vec<Plane>,
    pub(super) gravity: Vec3,
}

/// The numbers of bodies in two successive steps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BodyRemap {
    /// For each body its number in the last step, and what carries over, as in `Body::carried`.
    pub bodies: Vec<(u32, u32)>,
    /// For each body of the last step, followed by the half-spaces, its new number; `u32::MAX` if it is gone.
    pub new_numbers: Vec<u32>,
    /// Whether the half-spaces differ.
    pub planes_changed: bool,
}

impl LastBodies {
    /// Forgets all bodies: nothing carries over to the next step.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Number of bodies in the last step.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether nothing carries over.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Matches the bodies of `input` with those of the last call, and replaces these.
    pub fn advance_to(&mut self, input: &StepInput) -> BodyRemap {
        let StepInput {
            bodies, planes, config, ..
        } = input;
        let count = bodies.len();
        let mut keys = Vec::new();
        input.write_keys(&mut keys);
        let sleep_inputs: Vec<_> = (0..count).map(|i| SleepInputs::of(input, i)).collect();
        let mut remap = BodyRemap {
            bodies: vec![(0, 0); count],
            new_numbers: vec![GONE; self.keys.len()],
            planes_changed: self.planes != *planes,
        };
        let same_gravity = self.gravity == config.gravity;
        for (i, before) in remap::previous_numbers(&self.keys, &keys).enumerate() {
            let Some(before) = before else { continue };
            remap.new_numbers[before as usize] = i as u32;
            let params = &bodies.params[i];
            let sleeps = params.can_sleep && same_gravity || bodies.kind[i] == RigidBody::Static;
            // Another scale or mesh may move the centre of mass.
            let (now, then) = (&sleep_inputs[i], &self.sleep_inputs[before as usize]);
            let same_center = (now.center, now.scale) == (then.center, then.scale);
            let mut carried = if same_center { CONTINUES } else { 0 };
            carried |= if sleeps && now == then { CARRIED_SLEEP } else { 0 };
            carried |= if params.woken { WOKEN } else { 0 };
            remap.bodies[i] = (before, carried);
        }
        if !self.keys.is_empty() {
            remap::renumber_planes(&mut remap.new_numbers, self.planes.len(), count, planes.len());
        }
        *self = Self {
            keys,
            sleep_inputs,
            planes: planes.clone(),
            gravity: config.gravity,
        };
        remap
    }
}
