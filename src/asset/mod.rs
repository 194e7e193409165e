//! Baked meshes as Bevy assets: the asset, its file, its loader.

pub mod collision_mesh;

pub use collision_mesh::CollisionMesh;
