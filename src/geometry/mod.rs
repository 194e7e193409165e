//! Triangle meshes as pure geometry: validation, triangle tests, mass, clusters.
//!
//! Nothing here knows the ECS, the asset system or the GPU; `glam` is the only vocabulary.

mod aabb;
pub mod cluster;
pub mod direction;
pub mod features;
pub mod mass;
pub mod mesh;
pub mod shapes;
mod thickness;
pub mod triangle;

pub use aabb::Aabb;
pub use mass::MassProperties;
pub(crate) use mesh::MeshParts;
pub use mesh::{MeshError, Orientation, TriMesh};
