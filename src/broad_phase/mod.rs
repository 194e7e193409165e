//! BroadPhase: which bounding spheres overlap.
//!
//! A hashed grid with a level for every power of four of the radii (of two on the GPU), so that one huge body does not make the cells of all
//! others as large. A body looks for others on its own level and on the coarser ones: each pair is found from its smaller
//! body, or on one level from one of the two. On the CPU static bodies have levels of their own, which are searched but do
//! not search each other.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
