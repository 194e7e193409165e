//! The state of a body, other than its motion, whose change wakes the body or its neighbours.

use crate::state::{LocalPose, StepInput};
use crate::types::body::{LockedAxes, RigidBody};
use glam::{DVec3, Quat, Vec3};

/// The properties of a body whose change wakes it or its neighbours.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct SleepInputs {
    /// The fingerprint of its mesh.
    pub mesh: u64,
    /// The centre of mass in the mesh's axes.
    pub center: Vec3,
    pub kind: RigidBody,
    pub scale: Vec3,
    pub layers: [u32; 2],
    pub sensor: bool,
    pub gravity_scale: f32,
    pub locked_axes: LockedAxes,
}

/// These properties, the pose of the body and, in a body of several colliders, the place of the collider and the body's
/// centre of mass.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct PlacedSleepInputs {
    pub inputs: SleepInputs,
    pub place: Option<(LocalPose, DVec3)>,
    pub position: Vec3,
    pub rotation: Quat,
}

impl SleepInputs {
    /// The properties of body `i`.
    pub fn of(input: &StepInput, i: usize) -> Self {
        let StepInput { bodies, meshes, .. } = input;
        let slot = &meshes[bodies.mesh[i]];
        Self {
            mesh: slot.mesh.fingerprint(),
            center: slot.mesh.mass.center,
            kind: bodies.kind[i],
            scale: bodies.scale[i],
            layers: [bodies.layers[i].memberships, bodies.layers[i].filters],
            sensor: bodies.sensor[i],
            gravity_scale: bodies.gravity_scale[i],
            locked_axes: bodies.params[i].locked_axes,
        }
    }
}

impl PlacedSleepInputs {
    /// The properties and the pose of body `i`.
    pub fn of(input: &StepInput, i: usize) -> Self {
        let bodies = &input.bodies;
        let inputs = SleepInputs::of(input, i);
        let Some(part) = bodies.part(i as u32) else {
            return Self {
                inputs,
                place: None,
                position: bodies.position[i],
                rotation: bodies.rotation[i],
            };
        };
        let compound = &bodies.compounds[part.compound as usize];
        Self {
            inputs,
            place: Some((part.pose, compound.local_center)),
            position: compound.motion.position,
            rotation: compound.motion.rotation,
        }
    }
}
