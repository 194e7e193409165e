//! Collision meshes as Bevy assets: the loader, the processor, and the pools they work on.

#[cfg(feature = "bevy_mesh")]
pub mod bevy_mesh;
pub(crate) mod jobs;
pub mod loader;
pub mod processor;

pub use loader::{CollisionMeshLoader, CollisionMeshSettings, register};
