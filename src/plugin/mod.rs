//! All that knows of Bevy: components, resources, messages, assets, the schedule of the step.
//!
//! | to | see |
//! |---|---|
//! | add the plugins | [`FaceoffPlugins`], [`FaceoffHeadlessPlugins`] |
//! | spawn bodies | [`components`], and [`types`](crate::types) for those that the core shares |
//! | load meshes | [`assets`] |
//! | set what holds for all bodies | [`settings`] |
//! | read results | [`collisions`], [`events`], [`diagnostics`] |
//! | order systems against the step | [`FaceoffStep`], [`FaceoffSystems`] |
//! | pause, slow down, step by hand | [`clock`] |
//! | go back in time | [`snapshot`] |
//! | know what runs the step | [`backend`] |

pub mod assets;
pub mod backend;
pub mod clock;
pub mod collisions;
pub mod components;
#[cfg(feature = "debug_gizmos")]
pub mod debug;
pub mod diagnostics;
pub mod events;
mod groups;
#[cfg(feature = "bevy_mesh")]
pub mod mesh_collider_from;
mod renderer;
mod schedule;
pub mod settings;
pub mod snapshot;
mod step_plugin;
pub(crate) mod sync;

pub use groups::{CollisionMeshPlugin, FaceoffHeadlessPlugins, FaceoffPlugins};
pub use schedule::{FaceoffStep, FaceoffSystems};
pub use step_plugin::{StepPlugin, threads};
#[cfg(feature = "gpu")]
pub use step_plugin::{gpu, poses};
