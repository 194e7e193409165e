//! Sleep: islands of bodies at rest fall asleep, and wake when something disturbs them.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub(crate) mod inputs;
mod rest;
