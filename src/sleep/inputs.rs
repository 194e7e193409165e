//! State of a body whose change wakes it, or its neighbours.

use crate::state::StepInput;
use crate::types::body::RigidBody;
use glam::{Quat, Vec3};

/// What a caller decides about a body, but for its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BodyTraits {
    /// See [`MeshSlot::version`](crate::state::mesh_arena::MeshSlot::version).
    pub mesh: u64,
    /// The mesh's own centre of mass.
    pub center: Vec3,
    pub kind: RigidBody,
    pub scale: Vec3,
    pub layers: [u32; 2],
    pub sensor: bool,
}

/// The same, and where the body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlacedTraits {
    traits: BodyTraits,
    position: Vec3,
    rotation: Quat,
}

impl BodyTraits {
    /// Those of body `i`.
    pub fn of(input: &StepInput, i: usize) -> Self {
        let StepInput { bodies, meshes, .. } = input;
        let slot = &meshes[bodies.mesh[i]];
        Self {
            mesh: slot.version,
            center: slot.mesh.mass.center,
            kind: bodies.kind[i],
            scale: bodies.scale[i],
            layers: [bodies.layers[i].memberships, bodies.layers[i].filters],
            sensor: bodies.sensor[i],
        }
    }
}

impl PlacedTraits {
    /// Those of body `i`.
    pub fn of(input: &StepInput, i: usize) -> Self {
        Self {
            traits: BodyTraits::of(input, i),
            position: input.bodies.position[i],
            rotation: input.bodies.rotation[i],
        }
    }
}
