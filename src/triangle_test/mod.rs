//! TriangleTest: finds the intersecting triangles of each pair, and a representative contact.
//!
//! Per pair, in single precision with a rounding allowance that keeps every true intersection:
//! 1. Small meshes: a cluster of eight triangles survives if it meets the other body's bounding sphere, its box in
//!    either body's axes, and its bound along the best support axis. Surviving clusters are culled against the box of
//!    the other's survivors, and boxes of clusters are compared eight at a time. Large meshes: the bounding-volume
//!    trees (boxes and slabs) of both are traversed together down to pairs of clusters that may touch, so the cost
//!    follows the size of the contact.
//! 2. An approximate [`Culling`](crate::types::settings::Culling) leaves out triangles that are not in the
//!    [`View`](super::state::View) of their body.
//! 3. Boxes of triangles are compared eight at a time, in coordinates relative to their clusters: rounding errors are
//!    small compared with the triangles, whatever the size of the bodies.
//! 4. Triangles whose boxes overlap must cross each other's planes.
//!
//! Few pairs beyond the true intersections remain. Single precision decides those that are clear, and
//! [`intersect`](crate::geometry::triangle::intersect) the others in double precision. Without an intersection one body
//! may still contain the other.
//!
//! `cpu::touching` finds only which bodies touch, and stops at the first intersection of each pair.
//!
//! All culls but the views are conservative. So an approximate mode finds exactly those face pairs of the exact
//! mode whose faces are both in view.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
