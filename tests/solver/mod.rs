//! The solver against analytic solutions. Contact points come from spheres, boxes and planes of these tests.

mod bodies;
mod cloud;
mod friction;
mod overlap;
mod rest;
mod restitution;
mod same_bits;
pub mod shapes;
mod spin;
mod warm_start;
pub mod world;
