//! BroadPhase: finds the pairs of bodies whose bounding spheres overlap, with a hashed grid.
//!
//! The grid has a level for every factor of four in the radii (of two on the GPU), so a huge body does not enlarge the
//! cells of all others. Each body searches its own level and the coarser ones. So a pair is found once: from its
//! smaller body, or within a level from one of the two. On the CPU static bodies have a grid of their own, which is
//! searched by moving bodies; two static bodies are never compared.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
