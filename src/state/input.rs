//! The input of a step.

use super::bodies::Bodies;
use super::config::StepConfig;
use super::mesh_arena::MeshArena;
use super::planes::Plane;
#[cfg(feature = "bevy")]
use crate::types::hooks::ActiveCollisionHooks;

/// The input of a step. The step updates the bodies.
#[derive(Default)]
pub struct StepInput {
    /// Parameters of the step.
    pub config: StepConfig,
    /// Meshes of the bodies.
    pub meshes: MeshArena,
    /// The bodies.
    pub bodies: Bodies,
    /// The planes.
    pub planes: Vec<Plane>,
    /// Stable identifiers of the bodies, ascending, which match bodies between steps. If their number differs from that
    /// of the bodies, indices serve instead.
    pub keys: Vec<u64>,
}

impl StepInput {
    /// Whether a collider or plane has hooks.
    #[cfg(feature = "bevy")]
    pub(crate) fn has_hooks(&self) -> bool {
        let flags = self.bodies.flags();
        let mut planes = self.planes.iter().map(|plane| plane.hooks);
        flags.filters || flags.modifies || planes.any(|hooks| hooks != ActiveCollisionHooks::NONE)
    }

    /// Writes the identifier of each body: [`StepInput::keys`], or the index. The first `known` are there already.
    pub(crate) fn write_keys(&self, keys: &mut Vec<u64>, known: usize) {
        keys.truncate(known);
        if self.keys.len() == self.bodies.len() {
            keys.extend_from_slice(&self.keys[known..]);
        } else {
            keys.extend(known as u64..self.bodies.len() as u64);
        }
    }
}
