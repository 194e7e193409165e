//! Meshes and their mathematics.

mod mass;
mod mesh;
mod openings;
mod repair;
mod shells;
mod triangle;
mod weld;
