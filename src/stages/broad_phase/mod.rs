//! BroadPhase: which bounding spheres overlap.
//!
//! A hashed grid with a level for every power of four of the radii (of two on the GPU), so that one huge body does not make the cells of all
//! others as large. A body looks for others on its own level and on the coarser ones: each pair is found from its smaller
//! body, or on one level from the one that comes first in the grid's order.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
