//! Collisions between thousands of moving, concave triangle meshes, triangle by triangle, inside Bevy.

pub mod asset;
pub mod collisions;
pub mod components;
pub mod diagnostics;
pub mod events;
pub mod geometry;
pub mod plugin;
pub mod projection;
pub mod queries;
pub mod settings;
pub mod stages;
mod sync;

/// What most programs need: `use bevy_faceoff::prelude::*;`
pub mod prelude {
    pub use crate::asset::CollisionMesh;
    pub use crate::collisions::{Collision, Collisions, StepReport};
    pub use crate::components::*;
    pub use crate::events::{BodyRejected, CollisionEnd, CollisionStart};
    pub use crate::geometry::TriMesh;
    pub use crate::plugin::{FaceoffHeadlessPlugins, FaceoffPlugins, FaceoffStep, FaceoffSystems, StepPlugin};
    pub use crate::projection::BakeSettings;
    pub use crate::settings::{Backend, Culling, Gravity, Response};
}
