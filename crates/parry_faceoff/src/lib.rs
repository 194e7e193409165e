#![cfg_attr(feature = "rapier", doc = include_str!("../README.md"))]
#![cfg_attr(
    not(feature = "rapier"),
    doc = "Exact contacts between concave triangle meshes: see the README."
)]

#[cfg(not(any(feature = "rapier", feature = "bevy_rapier")))]
compile_error!("choose the parry: with feature `rapier` that of rapier3d, with `bevy_rapier` that of bevy_rapier3d");
#[cfg(all(feature = "rapier", feature = "bevy_rapier"))]
compile_error!(
    "features `rapier` and `bevy_rapier` exclude each other: for the second, set `default-features = false`"
);

mod convert;
mod dispatcher;
mod manifolds;
mod memory;
mod mesh;
mod shape;

/// The version of parry that this build is for.
#[cfg(feature = "rapier")]
pub use parry3d as parry;
/// The version of parry that this build is for.
#[cfg(all(feature = "bevy_rapier", not(feature = "rapier")))]
pub use parry3d_of_bevy_rapier as parry;

pub use bevy_faceoff;
pub use dispatcher::ExactDispatcher;
pub use mesh::{ExactMesh, ExactMeshError};
