//! Meshes named on the command line.

use crate::Outcome;
use bevy_faceoff::asset::{CollisionMesh, Imported, import_file};
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

/// A mesh file, baked or to be baked. Face tables are left out: the exact mode has no use for them.
pub fn load(path: &Path) -> Outcome<CollisionMesh> {
    let mesh = match import_file(path)? {
        Imported::Mesh { mesh, .. } => CollisionMesh::new(&mesh),
        Imported::Baked { mesh, .. } => mesh,
    };
    warn(path, &mesh);
    Ok(mesh)
}

/// Tells on standard error what is odd about a mesh.
pub fn warn(path: &Path, mesh: &CollisionMesh) {
    for warning in mesh.warnings() {
        eprintln!("warning: {}: {warning}", path.display());
    }
}
