//! Integrate: bodies move.
//!
//! By semi-implicit Euler: velocities take gravity and the summed impulses, then poses take the new velocities. With
//! [`Response::Contacts`](crate::types::settings::Response::Contacts) the solver has done so in its substeps: fast bodies are
//! stopped where they first meet others (see [`ccd`](crate::ccd)), and all are put where the solver moved them.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
