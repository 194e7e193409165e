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

pub mod angles;
pub mod asset;
pub mod broad_phase;
pub mod ccd;
pub mod force_scan;
pub mod geometry;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod integrate;
pub mod manifolds;
pub(crate) mod parallel;
#[cfg(feature = "bevy")]
pub mod plugin;
pub mod projection;
pub mod queries;
pub(crate) mod simd;
pub mod sleep;
pub mod solver;
pub mod state;
pub mod step;
pub mod testing;
pub mod triangle_test;
pub mod types;

#[cfg(feature = "bevy")]
/// What most programs need: `use bevy_faceoff::prelude::*;`
pub mod prelude {
    pub use crate::asset::CollisionMesh;
    pub use crate::geometry::TriMesh;
    pub use crate::plugin::backend::{ActiveBackend, BackendFailed, BackendReady};
    pub use crate::plugin::clock::{Physics, PhysicsTime};
    pub use crate::plugin::collisions::{Collision, Collisions, StepReport};
    pub use crate::plugin::components::*;
    pub use crate::plugin::events::{BodyRejected, CollisionEnd, CollisionStart};
    #[cfg(feature = "bevy_mesh")]
    pub use crate::plugin::mesh_collider_from::MeshColliderFrom;
    pub use crate::plugin::settings::{Backend, EventHysteresis, Gravity, Reading};
    pub use crate::plugin::snapshot::Snapshot;
    pub use crate::plugin::{FaceoffHeadlessPlugins, FaceoffPlugins, FaceoffStep, FaceoffSystems, StepPlugin};
    pub use crate::projection::BakeSettings;
    pub use crate::types::body::{
        AngularVelocity, CenterOfMass, CollisionLayers, ExternalForces, LinearVelocity, LockedAxes, RigidBody, Sleeping,
    };
    pub use crate::types::material::{CombineRule, Friction, Restitution};
    pub use crate::types::settings::{Culling, Response};
    pub use crate::types::solver_settings::SolverSettings;
}

/// Runs the programs of the README as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
