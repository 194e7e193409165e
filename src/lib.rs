//! Exact collisions and contacts between thousands of moving, concave triangle meshes: a plugin for Bevy 0.19, and a
//! library without an engine.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::{geometry::shapes, prelude::*};
//!
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()));
//! app.world_mut().spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
//!
//! let mut meshes = app.world_mut().resource_mut::<Assets<CollisionMesh>>();
//! let torus = meshes.add(CollisionMesh::new(&shapes::torus_240()));
//! for height in [1.0, 2.0] {
//!     app.world_mut().spawn((
//!         RigidBody::Dynamic,
//!         MeshCollider(torus.clone()),
//!         Transform::from_xyz(0.0, height, 0.0),
//!     ));
//! }
//! app.finish();
//!
//! // A game does this 64 times a second by itself.
//! for _ in 0..64 {
//!     app.world_mut().run_schedule(FaceoffStep);
//! }
//! for hit in app.world().resource::<Collisions>().iter() {
//!     println!("{} touches {} at {}", hit.collider1, hit.collider2, hit.contact.point);
//! }
//! ```
//!
//! # Three ways to use it
//!
//! | crate | in | what it does |
//! |---|---|---|
//! | `bevy_faceoff` | Bevy, or no engine | collisions, contacts and motion of all bodies, on the CPU or on a GPU |
//! | `avian_faceoff` | Avian | contacts between meshes; all else is Avian's |
//! | `parry_faceoff` | parry and rapier | contacts between meshes; all else is theirs |
//!
//! # Map
//!
//! | to | see |
//! |---|---|
//! | build a game or a headless app | [`prelude`], [`plugin`] |
//! | look up what to use, choose settings, come from another engine, understand a surprise | [`guide`] |
//! | make triangle meshes | [`geometry`] |
//! | bake them, and choose how | [`projection`] |
//! | load and save baked meshes, without an app | [`asset`] |
//! | ask which placed meshes touch, and where, without an app | [`queries`] |
//! | know what components and settings mean | [`types`], [`plugin::components`], [`plugin::settings`] |
//!
//! Meshes are baked once, by height projection (Aly & Elawady, "A New Narrow Phase Collision Detection Algorithm Using
//! Height Projection", EDERC 2010), made exact. Every fixed step then runs ordered stages, on the CPU or on a GPU:
//! broad phase, angles, triangle test, manifolds, force scan, integrate.
//!
//! # Units
//!
//! Metres, kilograms, seconds and radians. Counter-clockwise faces look outward.
//!
//! # Features
//!
//! | feature | adds |
//! |---|---|
//! | `bevy`, on by default | [`plugin`] and [`prelude`]: components, resources, loader, asset processor. Without it no crate of Bevy is built |
//! | `gpu`, on by default | the stages on a GPU, through wgpu; without it nothing of wgpu is built |
//! | `bevy_render` | the stages on the device of Bevy's renderer, if the app has one |
//! | `bevy_mesh` | colliders from Bevy's meshes, and Bevy's meshes from colliders |
//! | `bevy_scene` | `bsn!` of Bevy, for programs that leave out its own feature |
//! | `bevy_gltf` | colliders for the scenes of Bevy's glTF loader |
//! | `bevy_picking` | Bevy's pointer events on colliders |
//! | `interpolation` | motion that looks smooth at any frame rate: `Transform`s between two steps, by `bevy_transform_interpolation` |
//! | `debug_gizmos` | `plugin::debug`: shapes, contacts and more, drawn into the scene |
//! | `debug_panel` | `plugin::panel`: times, counts and rejected bodies on the screen |
//! | `cli` | the command line `faceoff` |
//! | `window` | parts of Bevy for the examples of this repository; of no use to a game |
//!
//! The plugin without GPU code, or the core without an engine (geometry, projection, file formats, queries, and the
//! step on plain arrays):
//!
//! ```toml
//! bevy_faceoff = { path = "../bevy_faceoff", default-features = false, features = ["bevy"] }
//! bevy_faceoff = { path = "../bevy_faceoff", default-features = false }
//! ```

pub mod asset;
pub mod geometry;
#[cfg(feature = "bevy")]
pub mod guide;
#[cfg(feature = "bevy")]
pub mod plugin;
pub mod projection;
pub mod queries;
pub mod types;

// The stages and what they work on, for this repository's tests, benches and command line. Hidden from the
// documentation: they change without notice.
#[doc(hidden)]
pub mod angles;
#[doc(hidden)]
pub mod broad_phase;
#[doc(hidden)]
pub mod ccd;
#[doc(hidden)]
pub mod force_scan;
#[cfg(feature = "gpu")]
#[doc(hidden)]
pub mod gpu;
#[doc(hidden)]
pub mod integrate;
#[doc(hidden)]
pub mod manifolds;
mod parallel;
mod simd;
#[doc(hidden)]
pub mod sleep;
#[doc(hidden)]
pub mod solver;
#[doc(hidden)]
pub mod state;
#[doc(hidden)]
pub mod step;
#[doc(hidden)]
pub mod testing;
#[doc(hidden)]
pub mod triangle_test;

/// What most programs need: `use bevy_faceoff::prelude::*;`
#[cfg(feature = "bevy")]
pub mod prelude {
    pub use crate::asset::CollisionMesh;
    pub use crate::geometry::TriMesh;
    pub use crate::plugin::backend::{ActiveBackend, BackendFailed, BackendReady};
    pub use crate::plugin::character::{Character, CharacterGround, GroundContact};
    pub use crate::plugin::clock::{Physics, PhysicsTime};
    pub use crate::plugin::collisions::{Collision, Collisions, StepReport};
    pub use crate::plugin::components::*;
    pub use crate::plugin::events::{BodyRejected, CollisionEnd, CollisionStart};
    pub use crate::plugin::hooks::{CollisionHooks, CollisionHooksPlugin, ContactPair, ContactSurface};
    #[cfg(feature = "interpolation")]
    pub use crate::plugin::interpolation::{InterpolationPlugin, TransformInterpolation};
    #[cfg(feature = "bevy_mesh")]
    pub use crate::plugin::mesh_collider_from::MeshColliderFrom;
    #[cfg(feature = "bevy_gltf")]
    pub use crate::plugin::prefab::{ColliderSettings, MeshColliderHierarchy, MeshColliderHierarchyReady};
    pub use crate::plugin::queries::{
        CasterShape, PointHitData, QueryShape, RayCaster, RayHitData, RayHits, ShapeCaster, ShapeHitData, ShapeHits,
        SpatialQuery, SpatialQueryFilter,
    };
    pub use crate::plugin::settings::{Backend, EventHysteresis, FaceLists, Gravity, MeasureEnergy, Readback};
    pub use crate::plugin::shapes::{BallCollider, CapsuleCollider, ConeCollider, CuboidCollider, CylinderCollider};
    pub use crate::plugin::snapshot::Snapshot;
    pub use crate::plugin::{FaceoffHeadlessPlugins, FaceoffPlugins, FaceoffStep, FaceoffSystems, StepPlugin};
    pub use crate::projection::BakeSettings;
    pub use crate::state::{BodyFault, Contact, ContactPoint, FacePair, ManifoldPoint};
    pub use crate::types::body::{
        AngularVelocity, CenterOfMass, CollisionLayers, ComputedCenterOfMass, ExternalForces, LinearVelocity,
        LockedAxes, RigidBody, Sleeping,
    };
    pub use crate::types::hooks::ActiveCollisionHooks;
    pub use crate::types::kernel_cache::KernelCache;
    pub use crate::types::limits::StepLimits;
    pub use crate::types::material::{CombineRule, Friction, Restitution};
    pub use crate::types::settings::{Culling, Response};
    pub use crate::types::solver_settings::SolverSettings;
    pub use crate::types::stage::Stage;
}

/// Runs the program of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
