//! Triangle meshes as pure geometry: validation, triangle tests, mass, clusters.
//!
//! Nothing here knows the ECS, the asset system or the GPU; `glam` is the only vocabulary, and `wide` for eight of its vectors
//! at a time.

mod aabb;
pub mod cluster;
pub mod direction;
mod edges;
pub mod features;
pub mod lanes;
pub mod mass;
pub mod mesh;
pub mod shapes;
mod thickness;
mod topology;
pub mod triangle;
mod weld;

pub use aabb::Aabb;
pub use mass::MassProperties;
pub(crate) use mesh::MeshParts;
pub use mesh::{MeshError, Orientation, TriMesh};
pub use topology::Gaps;
