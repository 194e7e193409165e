//! Questions asked outside a simulation.

use crate::asset::CollisionMesh;
use glam::{Quat, Vec3};
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
#[derive(Clone, Debug, Error, PartialEq)]
#[error("body {body}: {reason}")]
pub struct PlacementError {
    /// Index into the placements.
    pub body: usize,
    /// What is wrong and what to do.
    pub reason: String,
}

/// Two placements that touch, `a < b`.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchingPair {
    /// The one of smaller index.
    pub a: u32,
    /// The other.
    pub b: u32,
    /// One is a closed mesh and the other lies wholly inside it.
    pub contained: bool,
    /// Intersecting faces as indices of the input meshes, a's first, in ascending order.
    pub faces: Vec<[u32; 2]>,
}

/// All pairs of placements that touch, in ascending order, by the exact mode on the CPU.
pub fn check(placements: &[Placement]) -> Result<Vec<TouchingPair>, PlacementError> {
    let _ = placements;
    todo!()
}
