//! Collision meshes as Bevy assets: the loader, the asset processor, and conversions from and to Bevy's own meshes.

#[cfg(feature = "bevy_mesh")]
pub mod bevy_mesh;
pub(crate) mod jobs;
pub mod loader;
pub mod processor;

pub use loader::{CollisionMeshLoader, CollisionMeshSettings, register};
