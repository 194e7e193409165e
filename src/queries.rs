//! Questions asked outside a simulation.

use crate::asset::{BakedMesh, CollisionMesh};
use crate::stages::Stage;
use crate::stages::bodies::BodyFault;
use crate::stages::state::{Body, StepState, TouchingPair as StagePair};
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

/// A placement that cannot be used.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("body {body}: {fault}")]
pub struct PlacementError {
    /// Index into the placements.
    pub body: usize,
    /// What is wrong and what to do.
    pub fault: BodyFault,
}

/// Two placements that touch, `a < b`.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct TouchingPair {
    /// The one of smaller index.
    pub a: u32,
    /// The other.
    pub b: u32,
    /// One is a closed mesh and has the other, or a connected component of it, inside; no faces intersect then.
    pub contained: bool,
    /// Intersecting faces as indices of the input meshes, `a`'s first, ascending.
    pub faces: Vec<[u32; 2]>,
}

/// All pairs of placements that touch, ascending, by the exact mode on the CPU.
///
/// Runs on rayon's current thread pool: call it inside `ThreadPool::install` to choose one.
///
/// # Errors
/// If a placement cannot be used; nothing is checked then.
pub fn check(placements: &[Placement]) -> Result<Vec<TouchingPair>, PlacementError> {
    let mut state = StepState::default();
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
            .map_err(|fault| PlacementError { body, fault })?;
    }
    for stage in [Stage::BroadPhase, Stage::Angles, Stage::TriangleTest] {
        stage.run_on_cpu(&mut state);
    }
    let contacts = &state.contacts;
    let touching = |pair: &StagePair| {
        let StagePair { bodies, contained, .. } = *pair;
        let mut faces: Vec<[u32; 2]> = contacts.faces_of(pair).iter().map(|f| [f.a, f.b]).collect();
        faces.sort_unstable();
        TouchingPair {
            a: bodies[0],
            b: bodies[1],
            contained,
            faces,
        }
    };
    Ok(contacts.pairs.iter().map(touching).collect())
}
