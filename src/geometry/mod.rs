//! Geometry of triangle meshes: validation, connectivity, triangle-triangle tests, mass properties, clusters.
//!
//! This module uses `glam` for vectors, and neither the ECS nor the asset system nor the GPU.

mod aabb;
mod box_tree;
pub mod cluster;
pub(crate) mod crossing;
pub mod direction;
pub(crate) mod distance;
mod edges;
pub mod features;
pub(crate) mod lanes;
pub(crate) mod linear_cast;
mod mass;
pub mod mesh;
mod mesh_error;
mod one_sided;
pub mod repair;
pub(crate) mod rounding;
pub mod shapes;
mod slivers;
mod thickness;
mod topology;
pub mod triangle;
pub(crate) mod union_find;
mod weld;
mod winding;

pub use aabb::Aabb;
pub use mass::{MassBasis, MassProperties, SHELL_THICKNESS};
pub(crate) use mesh::MeshParts;
pub use mesh::TriMesh;
pub use mesh_error::MeshError;
pub use one_sided::OneSided;
pub use topology::{Defect, DefectKind, Defects, Gaps, MAX_OPENING, Orientation};
