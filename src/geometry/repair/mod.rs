//! Repair of meshes: [`repair`] merges vertices, drops faces that add nothing, splits edges at T-junctions, makes the
//! winding consistent and closes holes.
//!
//! The result is a new mesh: its vertices and faces have other numbers, and what refers to faces of the old one, such
//! as a list of painted faces, no longer fits. A mesh without defects stays as it is, to the bit.
//!
//! ```
//! use bevy_faceoff::geometry::repair::{Steps, repair};
//! use bevy_faceoff::geometry::{TriMesh, shapes};
//!
//! let cube = shapes::cube(1.0);
//! let open = TriMesh::new(cube.vertices().to_vec(), cube.triangles()[1..].to_vec())?;
//! let repaired = repair(&open, &Steps { close_holes: 12, ..Steps::SAFE })?;
//! assert!(repaired.mesh.is_closed());
//! assert_eq!(repaired.work.closed_holes, 1);
//! # Ok::<(), bevy_faceoff::geometry::MeshError>(())
//! ```

mod drop;
mod fill;
mod holes;
mod large;
mod split;
mod surface;

pub use holes::{LeftHole, WhyLeft};

use super::mesh::WELD_TOLERANCE;
use super::{MeshError, TriMesh};
use serde::Serialize;
use surface::Surface;

/// Rounds of steps that depend on each other. One or two are enough, except for meshes with defects of all kinds
/// everywhere.
const MAX_ROUNDS: usize = 4;

/// What to repair. The steps run in the order of the fields. Faces are dropped again after a split, and oriented again
/// after holes were closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// Vertices within this distance of each other, relative to the diagonal of the mesh's bounding box, count as one
    /// in all steps.
    pub tolerance: f32,
    /// Merge those vertices.
    pub weld: bool,
    /// Drop faces of zero area, faces with the same corners as an earlier one, and vertices that no face uses. No face
    /// is dropped that keeps the mesh closed.
    pub drop: bool,
    /// Split the edges of faces where a vertex of another face lies on them: T-junctions. With `drop`, faces of zero
    /// area that fill T-junctions are dropped too.
    pub split: bool,
    /// Make the winding of each shell consistent, and turn solids outward; see [`TriMesh::oriented`].
    pub orient: bool,
    /// Close holes of up to this many edges with triangles between their vertices; 0 closes none. In holes of up to 256
    /// edges the triangles have the smallest possible area, so they do not overlap if the hole lies in a plane. In
    /// larger holes some may overlap, near edges where the boundary bends into the hole.
    pub close_holes: usize,
}

impl Steps {
    /// No step.
    pub const NONE: Self = Self {
        tolerance: WELD_TOLERANCE,
        weld: false,
        drop: false,
        split: false,
        orient: false,
        close_holes: 0,
    };

    /// All steps that do not change what the mesh looks like: all but closing holes.
    pub const SAFE: Self = Self {
        weld: true,
        drop: true,
        split: true,
        orient: true,
        ..Self::NONE
    };
}

/// What the steps of a repair did. Counts of steps that did not run are 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Work {
    /// Vertices that were merged into others.
    pub merged_vertices: usize,
    /// Faces of zero area that were dropped.
    pub dropped_zero_area: usize,
    /// Faces of zero area that were kept, because without them the mesh would be open.
    pub kept_zero_area: usize,
    /// Faces that were dropped because earlier ones have the same corners.
    pub dropped_duplicates: usize,
    /// Pairs of faces back to back that were kept, because the mesh would be open without one of the two.
    pub kept_back_to_back: usize,
    /// Vertices that no face uses and that were dropped.
    pub dropped_vertices: usize,
    /// Places at which an edge was split, counted once for each edge and vertex.
    pub split_edges: usize,
    /// Faces whose winding was reversed.
    pub turned_faces: usize,
    /// Holes that were closed.
    pub closed_holes: usize,
    /// Faces that close them.
    pub added_faces: usize,
    /// Holes that were not closed, in no particular order.
    pub left_holes: Vec<LeftHole>,
}

/// A repaired mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Repaired {
    /// The mesh, with the weld tolerance of the steps.
    pub mesh: TriMesh,
    /// What was done.
    pub work: Work,
}

/// Repairs a mesh. The winding it has now counts as that of the input.
///
/// What is repaired are defects of single faces, edges and openings. Surfaces that cross each other stay as they are,
/// as do edges of more than two faces.
///
/// # Errors
/// If no face is left that has an area, because the tolerance is as large as the mesh; see [`MeshError`].
pub fn repair(mesh: &TriMesh, steps: &Steps) -> Result<Repaired, MeshError> {
    let mut surface = Surface {
        vertices: mesh.vertices().to_vec(),
        faces: mesh.all_faces(),
        tolerance: steps.tolerance,
    };
    let mut work = Work::default();
    if steps.weld {
        surface.weld(&mut work);
    }
    for _ in 0..MAX_ROUNDS {
        if steps.drop {
            surface.drop_faces(steps.split, &mut work);
        }
        // A part of a split face may be there already.
        if !steps.split || surface.split(&mut work) == 0 {
            break;
        }
    }
    if steps.orient {
        surface.orient(&mut work)?;
    }
    for _ in 0..MAX_ROUNDS {
        // Closed holes may make faces agree. Other edges may then form loops.
        if steps.close_holes == 0 || surface.close_holes(steps.close_holes, &mut work) == 0 || !steps.orient {
            break;
        }
        surface.orient(&mut work)?;
    }
    if steps.drop {
        surface.drop_vertices(&mut work);
    }
    let mesh = surface.into_mesh()?;
    Ok(Repaired { mesh, work })
}
