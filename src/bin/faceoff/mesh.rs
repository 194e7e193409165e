//! Meshes named on the command line.

use crate::Outcome;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::shapes;
use std::path::Path;

/// A shape by name, or else a mesh file.
pub fn shape(name: &str) -> Outcome<CollisionMesh> {
    match name {
        "torus" => Ok(CollisionMesh::new(&shapes::torus_240())),
        "knot" => Ok(CollisionMesh::new(&shapes::knot_1120())),
        file => load(Path::new(file)),
    }
}

/// A mesh file, baked or to be baked without a face table.
pub fn load(path: &Path) -> Outcome<CollisionMesh> {
    Err(format!("{path:?}").into())
}
