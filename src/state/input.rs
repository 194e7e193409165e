//! What a step is told.

use super::bodies::Bodies;
use super::config::StepConfig;
use super::mesh_arena::MeshArena;
use super::planes::Plane;

/// What a step is told. The step moves the bodies.
#[derive(Default)]
pub struct StepInput {
    /// What holds for all bodies.
    pub config: StepConfig,
    /// The meshes in use.
    pub meshes: MeshArena,
    /// The bodies.
    pub bodies: Bodies,
    /// The half-spaces.
    pub planes: Vec<Plane>,
    /// What tells a body from others from step to step, ascending. If there are not as many as bodies, their numbers do.
    pub keys: Vec<u64>,
}

impl StepInput {
    /// Writes what tells each body from others: [`StepInput::keys`], or its number.
    pub(crate) fn write_keys(&self, keys: &mut Vec<u64>) {
        if self.keys.len() == self.bodies.len() {
            keys.clone_from(&self.keys);
        } else {
            keys.clear();
            keys.extend(0..self.bodies.len() as u64);
        }
    }
}
