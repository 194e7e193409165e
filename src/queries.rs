//! Questions asked outside a simulation.

use crate::asset::{BakedMesh, CollisionMesh};
use crate::stages::Stage;
use crate::stages::bodies::BodyFault;
use crate::stages::mesh_arena::MeshArena;
use crate::stages::state::{Body, StepState};
use glam::{Quat, Vec3};
use std::collections::HashMap;
use thiserror::Error;

/// A mesh placed in the world: scaled, then rotated, then moved.
#[derive(Clone, Debug)]
pub struct Placement {
    /// What is placed.
    pub mesh: CollisionMesh,
    /// Where its origin lies.
    pub translation: Vec3,
    /// How it is turned; normalised before use.
    pub rotation: Quat,
    /// How it is scaled along its own axes; no component may be zero.
    pub scale: Vec3,
}

/// Why placements could not be checked.
#[derive(Debug, Error)]
pub enum CheckError {
    /// A placement that cannot be used.
    #[error("body {body}: {fault}")]
    Placement {
        /// Index into the placements.
        body: usize,
        /// What is wrong and what to do.
        fault: BodyFault,
    },
    /// The system refused threads.
    #[error("no threads to work on: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Two placements that touch, `a < b`.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct TouchingPair {
    /// The one of smaller index.
    pub a: u32,
    /// The other.
    pub b: u32,
    /// One is a closed mesh and the other lies wholly inside it.
    pub contained: bool,
    /// Intersecting faces as indices of the input meshes, `a`'s first, ascending.
    pub faces: Vec<[u32; 2]>,
}

/// All pairs of placements that touch, ascending, by the exact mode on `state`'s threads.
///
/// `state` is only scratch: its bodies and meshes are replaced. Keep one for many calls.
pub fn check_with(state: &mut StepState, placements: &[Placement]) -> Result<Vec<TouchingPair>, CheckError> {
    state.bodies.clear();
    state.planes.clear();
    state.meshes = MeshArena::default();
    let mut slots: HashMap<*const BakedMesh, u32> = HashMap::new();
    for (body, placement) in placements.iter().enumerate() {
        let key: *const BakedMesh = &raw const *placement.mesh;
        let slot = *slots
            .entry(key)
            .or_insert_with(|| state.meshes.add(placement.mesh.clone()));
        let entry = Body::at_rest(slot, placement.translation, placement.rotation, placement.scale);
        state
            .bodies
            .push(&entry, &state.meshes)
            .map_err(|fault| CheckError::Placement { body, fault })?;
    }
    for stage in [Stage::BroadPhase, Stage::Angles, Stage::TriangleTest] {
        stage.run_on_cpu(state);
    }
    let contacts = &state.contacts;
    Ok(contacts
        .pairs
        .iter()
        .map(|pair| {
            let mut faces: Vec<[u32; 2]> = contacts.faces_of(pair).iter().map(|f| [f.a, f.b]).collect();
            faces.sort_unstable();
            TouchingPair {
                a: pair.bodies[0],
                b: pair.bodies[1],
                contained: pair.contained,
                faces,
            }
        })
        .collect())
}

/// [`check_with`] on threads of its own, one for each core.
pub fn check(placements: &[Placement]) -> Result<Vec<TouchingPair>, CheckError> {
    // Two placements are quicker on one thread than a pool is built.
    let threads = if placements.len() <= 2 { 1 } else { 0 };
    let mut state = StepState::new(threads)?;
    check_with(&mut state, placements)
}
