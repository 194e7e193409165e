//! Collision meshes as Bevy assets: the loader, the asset processor, and conversions from and to Bevy's own meshes.

#[cfg(feature = "bevy_mesh")]
pub mod bevy_mesh;
mod error;
mod hot_reload;
pub(crate) mod jobs;
pub mod loader;
#[cfg(feature = "bevy_mesh")]
pub(crate) mod mesh_bakes;
pub mod processor;
mod stale;

pub use error::LoadError;
pub use loader::{CollisionMeshLoader, CollisionMeshSettings};
#[cfg(feature = "bevy_mesh")]
pub use mesh_bakes::MeshBakeError;

use crate::asset::CollisionMesh;
use bevy::prelude::*;

/// Registers the asset and its loader, and its [processor] if Bevy processes assets. Further calls do nothing.
///
/// Without Bevy's `AssetPlugin` it logs an error and returns false.
pub fn register(app: &mut App) -> bool {
    if !app.world().contains_resource::<AssetServer>() {
        tracing::error!(
            "collision meshes are assets: add bevy's AssetPlugin (or DefaultPlugins) before the plugins of bevy_faceoff"
        );
        return false;
    }
    if !app.world().contains_resource::<Assets<CollisionMesh>>() {
        app.init_asset::<CollisionMesh>()
            .register_asset_reflect::<CollisionMesh>()
            .register_asset_loader(CollisionMeshLoader);
        processor::register(app);
    }
    true
}
