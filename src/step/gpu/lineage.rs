//! Which body of a step was which in the step before.

use crate::gpu::layout::{CARRIED_SLEEP, CONTINUES, WOKEN};
use crate::state::{Plane, StepState};
use crate::types::body::RigidBody;
use glam::Vec3;

/// The bodies of the last step that was sent off, as far as others, or they themselves, sleep by it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lineage {
    /// Ascending.
    keys: Vec<u64>,
    seen: Vec<Seen>,
    planes: Vec<Plane>,
    gravity: Vec3,
}

/// What of a body is not on the device.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    mesh: u64,
    center: Vec3,
    kind: RigidBody,
    scale: Vec3,
    layers: [u32; 2],
    sensor: bool,
}

/// How the bodies of a step follow from those of the step before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Descent {
    /// Of each body its number then, and what goes on, as `Body::carried` has it.
    pub bodies: Vec<(u32, u32)>,
    /// Of each body then, and each half-space after them, its number now; `u32::MAX` if it is gone.
    pub renumbered: Vec<u32>,
    /// Whether half-spaces are others.
    pub new_ground: bool,
}

impl Lineage {
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

    /// How the bodies of `state` follow from those of the last call.
    pub fn follow(&mut self, state: &StepState) -> Descent {
        let StepState {
            bodies,
            planes,
            dynamics,
            config,
            ..
        } = state;
        let count = bodies.len();
        let keys = dynamics.keys_of(count);
        let seen: Vec<Seen> = (0..count).map(|i| Seen::new(state, i)).collect();
        let mut descent = Descent {
            bodies: vec![(0, 0); count],
            renumbered: vec![u32::MAX; self.keys.len()],
            new_ground: self.planes != *planes,
        };
        let (mut before, same_gravity) = (0, self.gravity == config.gravity);
        for (i, &key) in keys.iter().enumerate() {
            while self.keys.get(before).is_some_and(|&old| old < key) {
                before += 1;
            }
            if self.keys.get(before) != Some(&key) {
                continue;
            }
            descent.renumbered[before] = i as u32;
            let handling = &bodies.handling[i];
            let sleeps = handling.can_sleep && same_gravity || bodies.kind[i] == RigidBody::Static;
            // Another scale or mesh may put the centre of mass elsewhere.
            let (now, then) = (&seen[i], &self.seen[before]);
            let same_center = (now.center, now.scale) == (then.center, then.scale);
            let mut carried = if same_center { CONTINUES } else { 0 };
            carried |= if sleeps && now == then { CARRIED_SLEEP } else { 0 };
            carried |= if handling.woken { WOKEN } else { 0 };
            descent.bodies[i] = (before as u32, carried);
        }
        if !self.keys.is_empty() {
            let planes_then = self.planes.len() as u32;
            let plane_now = |k| {
                if k < planes.len() as u32 {
                    count as u32 + k
                } else {
                    u32::MAX
                }
            };
            descent.renumbered.extend((0..planes_then).map(plane_now));
        }
        *self = Self {
            keys: keys.into_owned(),
            seen,
            planes: planes.clone(),
            gravity: config.gravity,
        };
        descent
    }
}

impl Seen {
    fn new(state: &StepState, i: usize) -> Self {
        let StepState { bodies, meshes, .. } = state;
        Self {
            mesh: meshes[bodies.mesh[i]].version,
            center: meshes[bodies.mesh[i]].mesh.mass.center,
            kind: bodies.kind[i],
            scale: bodies.scale[i],
            layers: [bodies.layers[i].memberships, bodies.layers[i].filters],
            sensor: bodies.sensor[i],
        }
    }
}
