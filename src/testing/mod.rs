//! What tests, benchmarks and the command line share and programs do not need: scenes, and parts of a step run by themselves
//! on a device.

#[cfg(feature = "gpu")]
pub mod gpu_manifolds;
#[cfg(feature = "gpu")]
pub mod gpu_primitives;
#[cfg(feature = "gpu")]
pub mod gpu_solver;
pub mod scenes;
