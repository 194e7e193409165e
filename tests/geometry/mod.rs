//! Meshes and their mathematics.

mod mass;
mod mesh;
mod triangle;
mod weld;
