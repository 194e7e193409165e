//! Geometry of triangle meshes: validation, connectivity, triangle-triangle tests, mass properties, clusters.
//!
//! This module uses `glam` for vectors, and neither the ECS nor the asset system nor the GPU.

mod aabb;
pub mod cluster;
pub mod direction;
pub(crate) mod distance;
mod edges;
pub mod features;
pub(crate) mod lanes;
pub(crate) mod linear_cast;
mod mass;
pub mod mesh;
pub mod shapes;
mod slivers;
mod thickness;
mod topology;
pub mod triangle;
pub(crate) mod union_find;
mod weld;

pub use aabb::Aabb;
pub use mass::MassProperties;
pub(crate) use mesh::MeshParts;
pub use mesh::{MeshError, TriMesh};
pub use topology::{Gaps, Orientation};
