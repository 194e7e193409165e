//! Shared by tests, benchmarks and the command line, and not meant for programs: scenes, and single parts of a step
//! that run on a device.

pub mod external;
#[cfg(feature = "gpu")]
pub mod gpu_manifolds;
#[cfg(feature = "gpu")]
pub mod gpu_primitives;
#[cfg(feature = "gpu")]
pub mod gpu_solver;
pub mod scenes;

pub use crate::simd::level::use_baseline_only;
