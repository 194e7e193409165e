//! Integrate: semi-implicit Euler. Velocities take gravity and the summed impulses, then poses take the new velocities.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
