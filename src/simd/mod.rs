//! SIMD for eight boxes, triangles or points at a time: vector arithmetic, and traversal of box trees.

pub mod bounds;
pub mod descent;
pub mod lanes;
pub mod level;
pub mod levels;
pub mod line;
pub mod rounding;
pub mod tree;
