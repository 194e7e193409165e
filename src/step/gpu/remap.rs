//! Which body of a step was which in the step before.

use crate::gpu::layout::{CARRIED_SLEEP, CONTINUES, WOKEN};
use crate::sleep::inputs::SleepInputs;
use crate::state::inactive::GONE;
use crate::state::{Plane, StepInput};
use crate::step::remap;
use crate::types::body::RigidBody;
use glam::Vec3;

/// State of the last submitted step whose change wakes bodies. Where the bodies are only the device knows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LastBodies {
    /// Ascending.
    keys: Vec<u64>,
    sleep_inputs: Vec<SleepInputs>,
    planes: Vec<Plane>,
    gravity: Vec3,
}

/// How the bodies of a step follow from those of the step before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BodyRemap {
    /// Of each body its number then, and what goes on, as `Body::carried` has it.
    pub bodies: Vec<(u32, u32)>,
    /// Of each body then, and each half-space after them, its number now; `u32::MAX` if it is gone.
    pub new_numbers: Vec<u32>,
    /// Whether half-spaces are others.
    pub planes_changed: bool,
}

impl LastBodies {
    /// Nothing goes on into the next step.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// How many bodies there were.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether nothing goes on.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// How the bodies of `input` follow from those of the last call.
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
            // Another scale or mesh may put the centre of mass elsewhere.
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
