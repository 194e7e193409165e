//! The Bevy plugin: components, resources, messages, assets and the schedule of the step. Needs the feature `bevy`.
//!
//! The rest of the crate does not depend on Bevy.
//!
//! | to | see |
//! |---|---|
//! | add the plugins | [`FaceoffPlugins`], [`FaceoffHeadlessPlugins`] |
//! | spawn bodies | [`components`], and [`types`](crate::types) for the components that the core shares |
//! | look up what to use for what | [`guide::what_to_use`](crate::guide::what_to_use) |
//! | write bodies in `bsn!`, save a world and load it again | [`guide::scenes`](crate::guide::scenes) |
//! | load meshes | [`assets`] |
//! | make colliders from Bevy's meshes | `mesh_collider_from`, with the feature `bevy_mesh` |
//! | give colliders to a glTF scene | `prefab`, with the feature `bevy_gltf` |
//! | set gravity, backend and other global settings | [`settings`], and [`types::settings`](crate::types::settings) |
//! | read results | [`collisions`], [`events`], [`diagnostics`] |
//! | order systems against the step | [`FaceoffStep`], [`FaceoffSystems`] |
//! | decide which pairs collide, and change contacts | [`hooks`] |
//! | pause, slow down, step by hand | [`clock`] |
//! | query what a ray hits | [`queries`] |
//! | move a character that walks, climbs and rides | [`character`] |
//! | get pointer events on colliders | `picking`, with the feature `bevy_picking` |
//! | show motion that is smooth at any frame rate | `interpolation`, with the feature of that name |
//! | save and restore the state of the simulation | [`snapshot`] |
//! | see where the step runs | [`backend`] |
//! | draw from the GPU, without reading poses back | [`poses`], [`Poses`] |
//! | see shapes, motion, contacts, islands and casts | `debug`, with the feature `debug_gizmos` |
//! | see times, counts and rejected bodies on the screen | `panel`, with the feature `debug_panel` |

pub mod assets;
pub mod backend;
pub mod character;
pub mod clock;
pub mod collisions;
pub mod components;
#[cfg(feature = "debug_gizmos")]
pub mod debug;
#[cfg(feature = "gpu")]
mod device_source;
pub mod diagnostics;
pub mod events;
mod groups;
pub mod hooks;
#[cfg(any(feature = "debug_gizmos", feature = "debug_panel"))]
mod inspect;
#[cfg(feature = "interpolation")]
pub mod interpolation;
#[cfg(feature = "bevy_mesh")]
pub mod mesh_collider_from;
#[cfg(feature = "debug_panel")]
pub mod panel;
#[cfg(feature = "bevy_picking")]
pub mod picking;
#[cfg(feature = "bevy_gltf")]
pub mod prefab;
pub mod queries;
mod registration;
mod renderer;
mod schedule;
pub mod settings;
pub mod shapes;
pub mod snapshot;
mod step_plugin;
pub(crate) mod sync;

#[cfg(feature = "gpu")]
pub use crate::step::gpu::Poses;
pub use groups::{CollisionMeshPlugin, FaceoffHeadlessPlugins, FaceoffPlugins};
pub use schedule::{FaceoffStep, FaceoffSystems};
pub use step_plugin::{StepPlugin, threads};
#[cfg(feature = "gpu")]
pub use step_plugin::{drawn_part, gpu, poses};
