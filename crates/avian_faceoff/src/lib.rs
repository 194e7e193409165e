#![doc = include_str!("../README.md")]

pub mod contacts;
mod joints;
mod manifolds;
mod memory;
pub mod meshes;
mod narrow_phase;
mod overlap;
mod plugin;
mod pose;
mod precision;
pub mod steps;

pub use narrow_phase::ExactNarrowPhase;
pub use plugin::{ExactMeshPlugin, WithExactMeshes};

/// What a game needs.
pub mod prelude {
    pub use crate::contacts::ExactContacts;
    pub use crate::meshes::{ExactCollider, ExactTrimesh};
    pub use crate::plugin::WithExactMeshes;
    pub use crate::steps::{PhysicsSteps, PhysicsStepsPlugin};
    pub use bevy_faceoff::asset::CollisionMesh;
}
