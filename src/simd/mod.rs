//! Eight boxes, triangles or points at a time: vector arithmetic, and the descent of two trees of boxes.

pub mod descent;
pub mod lanes;
pub mod levels;
pub mod rounding;
pub mod tree;
