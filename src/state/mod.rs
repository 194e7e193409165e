//! The data that passes between stages, as structures of arrays. Nothing here runs.
//!
//! | file | holds |
//! |---|---|
//! | [`input`] | what a step is told: [`config`], [`mesh_arena`], [`bodies`], [`planes`] |
//! | [`body`], [`fault`] | one body, and why it cannot take part |
//! | [`pairs`] | pairs that may touch |
//! | [`contacts`] | what touches |
//! | [`manifolds`] | the points at which bodies push each other |
//! | [`results`] | all that a step finds |
//! | `margins` | how far bodies look for each other |
//! | `still` | pairs that sleep, and so need no work |

pub mod bodies;
pub mod body;
pub mod config;
pub mod contacts;
pub mod fault;
pub mod input;
pub mod manifolds;
pub mod margins;
pub mod mesh_arena;
pub mod pairs;
pub mod planes;
pub mod results;
pub(crate) mod still;

pub use bodies::{Bodies, Frame};
pub use body::{Body, BodyParams, Motion};
pub use config::StepConfig;
pub use contacts::{Contact, ContactPoint, Contacts, FacePair, PairContact, PlaneContact};
pub use fault::BodyFault;
pub use input::StepInput;
pub use manifolds::{Manifold, ManifoldPoint, Manifolds};
pub use pairs::{NearPair, View};
pub use planes::Plane;
pub use results::{Counts, Impulse, StepResults};
