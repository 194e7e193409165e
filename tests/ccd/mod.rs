//! Continuous collision: when moving meshes come near each other, against formulas and against many poses along their ways, each
//! decided by brute force in double precision.

mod bullets;
mod clamped;
mod flights;
mod oracle;
mod random;
mod shapes;
mod special;
mod time_of_impact;
mod timing;
