//! The data that passes between stages, as structures of arrays. This module has no algorithms.
//!
//! | file | holds |
//! |---|---|
//! | [`input`] | the input of a step: [`config`], [`mesh_arena`], [`bodies`], [`planes`] |
//! | [`compound`] | bodies of several colliders |
//! | [`body`], `checks`, [`fault`] | one body, its validation, and the errors |
//! | [`placed_mesh`] | a mesh with its pose |
//! | `part_index` | which colliders are parts of bodies of several |
//! | `excerpt` | a few of the bodies of a step, by themselves |
//! | [`pairs`] | pairs that may touch |
//! | [`contacts`] | touching pairs, faces and points as they are reported |
//! | [`manifolds`] | contact manifolds, the input of the solver |
//! | [`results`] | all results of a step |
//! | [`margins`], `arm` | speculative margins, and how far from a body's axis others may touch it |
//! | `travel` | how colliders move if nothing stops them |
//! | `inactive` | pairs that sleep and need no work |
//! | `dormant_set` | colliders asleep near which nothing is awake |
//! | `revision` | names of states of colliders that have not changed |
//! | `static_changes` | which static colliders have changed |
//! | `columns`, `merge` | the arrays of bodies as one list; merged lists |

mod arm;
pub mod bodies;
pub mod body;
pub(crate) mod checks;
mod columns;
pub mod compound;
pub mod config;
pub mod contacts;
pub mod crowd;
pub mod departure;
pub(crate) mod dormant_set;
mod energy;
#[cfg(feature = "gpu")]
mod excerpt;
pub mod fault;
pub(crate) mod inactive;
pub mod input;
pub mod manifolds;
pub mod margins;
#[cfg(feature = "bevy")]
pub(crate) mod memory_fault;
pub(crate) mod merge;
pub mod mesh_arena;
pub mod pairs;
pub(crate) mod part_index;
pub mod placed_mesh;
pub mod planes;
pub mod results;
pub(crate) mod revision;
mod static_changes;
pub(crate) mod travel;

pub use bodies::{Bodies, Frame};
pub use body::{Body, BodyParams, Motion};
pub use compound::{Compound, CompoundPart, LocalPose, NewCompoundPart};
pub use config::StepConfig;
pub use contacts::{Contact, ContactPoint, Contacts, FacePair, PairContact, PlaneContact};
pub use departure::Departure;
pub use fault::BodyFault;
pub use input::StepInput;
pub use manifolds::{ContactSurface, Manifold, ManifoldPoint, Manifolds};
pub use pairs::{NearPair, View};
pub use placed_mesh::PlacedMesh;
pub use planes::Plane;
pub use results::{Counts, Impulse, StepResults};
