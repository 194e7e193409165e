//! Meshes given on the command line.

use crate::progress::with_bar;
use crate::{CullingChoice, Outcome, output};
use bevy_faceoff::asset::{CollisionMesh, Imported, import_file, input_files};
use bevy_faceoff::geometry::shapes;
use bevy_faceoff::projection::BakeSettings;
use std::path::{Path, PathBuf};

/// The files that are read for a named shape, which has none, or a mesh file.
pub fn files(name: &str) -> Vec<PathBuf> {
    match name {
        "torus" | "knot" => Vec::new(),
        file => input_files(file),
    }
}

/// The named shape, or else a mesh file, with all data that the culling mode needs.
pub fn shape(name: &str, culling: CullingChoice) -> Outcome<CollisionMesh> {
    let mesh = match name {
        "torus" => CollisionMesh::new(&shapes::torus_240()),
        "knot" => CollisionMesh::new(&shapes::knot_1120()),
        file => return load(Path::new(file), culling),
    };
    complete(name, mesh, BakeSettings::default(), culling)
}

/// Loads a mesh file, baked or not, with all data that the culling mode needs.
pub fn load(path: &Path, culling: CullingChoice) -> Outcome<CollisionMesh> {
    let imported = import_file(path)?;
    warn_all(path, imported.warnings());
    let (mesh, settings) = match imported {
        Imported::Mesh { mesh, settings, .. } => (CollisionMesh::without_faces(&mesh, settings), settings),
        Imported::Baked { mesh, header } => (mesh, header.settings),
    };
    warn(path, &mesh);
    complete(&path.display().to_string(), mesh, settings, culling)
}

/// Bakes the face table if the culling mode needs it and the mesh has none.
fn complete(name: &str, mesh: CollisionMesh, settings: BakeSettings, culling: CullingChoice) -> Outcome<CollisionMesh> {
    if culling != CullingChoice::Faces || mesh.faces.is_some() {
        return Ok(mesh);
    }
    let settings = BakeSettings {
        faces: true,
        ..settings
    };
    settings.validate().map_err(|e| format!("{name}: {e}"))?;
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    with_bar(name, settings, |progress| mesh.rebake(settings, &pool, progress))
}

/// Prints the warnings about a mesh to standard error.
pub fn warn(path: &Path, mesh: &CollisionMesh) {
    warn_all(path, &mesh.warnings());
}

/// Prints warnings about a file to standard error.
pub fn warn_all(path: &Path, warnings: &[String]) {
    for warning in warnings {
        output::log(&format!("warning: {}: {warning}", path.display()));
    }
}
