//! Sleep: which bodies are frozen, by islands.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub(crate) mod traits;
