//! The solver against mechanics that has an answer on paper. Contact points are made here, from spheres, boxes and planes.

mod bodies;
mod bounce;
mod cloud;
mod friction;
mod overlap;
mod rest;
mod same_bits;
mod shapes;
mod sleeping;
mod spin;
mod world;
