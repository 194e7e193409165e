//! Meshes and their mathematics.

mod doubled;
mod mass;
mod mesh;
mod openings;
mod repair;
mod repair_large;
mod shells;
mod triangle;
mod weld;
