//! Runs parts of a step by themselves on a device, for tests.

pub mod gpu_manifolds;
pub mod gpu_solver;
