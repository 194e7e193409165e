//! Mass properties of a mesh at density 1.

use crate::geometry::TriMesh;
use glam::{Mat3, Vec3};

/// What a mesh weighs and how it resists turning, at density 1 (kg per cubic mesh unit).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MassProperties {
    /// Enclosed volume, equal to the mass at density 1.
    pub volume: f32,
    /// Centre of mass in mesh space.
    pub center: Vec3,
    /// Second moments of volume about the centre, `integral of r r^T dV` (symmetric). Scale by `S` gives
    /// `det(S) * S M S`; the inertia tensor is `trace(M) * I - M`.
    pub second_moment: Mat3,
    /// Diameter of the thinnest part, in mesh units.
    pub thickness: f32,
    /// Whether the figures are a fallback because the mesh is not closed.
    pub approximate: bool,
}

impl MassProperties {
    /// Integrates over the enclosed volume; see [`MassProperties::approximate`] for open meshes.
    pub fn of(mesh: &TriMesh) -> Self {
        let _ = mesh;
        todo!()
    }
}
