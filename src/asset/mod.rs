//! Baked meshes as Bevy assets: the asset, its file, its loader.

pub mod collision_mesh;

pub use collision_mesh::{BakedMesh, CollisionMesh};

/// stub
pub fn register(app: &mut bevy::prelude::App) {
    let _ = app;
}
