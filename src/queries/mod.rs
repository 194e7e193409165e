//! Questions asked outside a simulation.

pub mod check;

pub use check::{
    Check, CheckOptions, Placement, PlacementError, TouchingPair, check, check_with, touching, touching_with,
};
#[cfg(feature = "gpu")]
pub use check::{CheckError, check_on_gpu};
