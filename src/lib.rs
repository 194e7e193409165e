//! Collisions between thousands of moving, concave triangle meshes, triangle by triangle, inside Bevy.
//!
//! The method is height projection (Aly & Elawady, "A New Narrow Phase Collision Detection Algorithm Using Height
//! Projection", EDERC 2010), made exact: meshes are baked once ([`projection`], [`asset`]); every fixed step runs
//! ordered [`stages`]; results are components, messages and resources.
//!
//! * Add [`FaceoffPlugins`](plugin::FaceoffPlugins) after `DefaultPlugins`, or
//!   [`FaceoffHeadlessPlugins`](plugin::FaceoffHeadlessPlugins) after `MinimalPlugins` and `LogPlugin`.
//! * Spawn a [`RigidBody`](components::RigidBody) with a [`MeshCollider`](components::MeshCollider); see [`components`]
//!   for all that can stand beside them and [`settings`] for what holds for all bodies.
//! * Read [`Collisions`](collisions::Collisions), [`CollidingEntities`](components::CollidingEntities) or
//!   [`events`].
//! * To check placed meshes without an app, call [`queries::check`].
//! * The stages run on a GPU or on the CPU: see [`Backend`](settings::Backend) and [`backend`].
//! * Pause, step by hand, slow down: see [`clock`].
//!
//! Units are metres, kilograms, seconds and radians. Bodies move in `FixedPostUpdate`, in the schedule
//! [`FaceoffStep`](plugin::FaceoffStep).

pub mod asset;
pub mod backend;
pub mod clock;
pub mod collisions;
pub mod components;
#[cfg(feature = "debug_gizmos")]
pub mod debug;
pub mod diagnostics;
pub mod events;
pub mod geometry;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(feature = "bevy_mesh")]
pub mod mesh_collider_from;
pub mod plugin;
pub mod projection;
pub mod queries;
mod renderer;
pub mod settings;
pub mod snapshot;
pub mod stages;
mod sync;

/// What most programs need: `use bevy_faceoff::prelude::*;`
pub mod prelude {
    pub use crate::asset::CollisionMesh;
    pub use crate::backend::{ActiveBackend, BackendFailed, BackendReady};
    pub use crate::clock::{Physics, PhysicsTime};
    pub use crate::collisions::{Collision, Collisions, StepReport};
    pub use crate::components::*;
    pub use crate::events::{BodyRejected, CollisionEnd, CollisionStart};
    pub use crate::geometry::TriMesh;
    #[cfg(feature = "bevy_mesh")]
    pub use crate::mesh_collider_from::MeshColliderFrom;
    pub use crate::plugin::{FaceoffHeadlessPlugins, FaceoffPlugins, FaceoffStep, FaceoffSystems, StepPlugin};
    pub use crate::projection::BakeSettings;
    pub use crate::settings::{Backend, Culling, EventHysteresis, Gravity, Reading, Response, SolverSettings};
    pub use crate::snapshot::Snapshot;
}

/// Runs the programs of the README as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
