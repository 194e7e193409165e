//! The solver against mechanics that has an answer on paper. Contact points are made here, from spheres, boxes and planes.

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
