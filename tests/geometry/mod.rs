//! Meshes and their mathematics.

mod mass;
mod mesh;
mod openings;
mod shells;
mod triangle;
mod weld;
