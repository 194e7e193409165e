//! Continuous collision detection: times of impact of moving meshes against formulas, and against distances at many
//! poses along their paths, computed by brute force in double precision.

mod bullets;
mod flights;
mod impacts;
pub mod oracle;
mod random;
pub mod shapes;
mod special;
mod time_of_impact;
mod timing;
