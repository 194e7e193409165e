//! TriangleTest: which triangles of a pair intersect, and where the bodies push each other.
//!
//! Per pair, in single precision and padded so that nothing true is lost:
//! 1. Small meshes: clusters of eight triangles survive if they reach the other body's half of the best support axis, its
//!    bounding sphere, its box in either body's axes; what survives is culled against the box of what is left of the
//!    other, and boxes of clusters are compared eight at a time. Large meshes: both trees of boxes and slabs are opened
//!    together, down to pairs of clusters that may touch, so that the cost follows the contact.
//! 2. An approximate [`Culling`](crate::types::settings::Culling) leaves out triangles that the [`View`](super::state::View) of
//!    their end does not show.
//! 3. Boxes of triangles are compared eight at a time, in coordinates that are relative to their clusters: rounding is
//!    small beside the triangles, whatever the size of the bodies.
//! 4. Pairs whose boxes overlap must cross each other's planes.
//!
//! What is left, a little more than the true intersections, is decided in double precision by
//! [`intersect`](crate::geometry::triangle::intersect). A pair without a hit may still be one body inside the other.
//!
//! Whoever asks only which bodies touch gets it from [`cpu::touching`], which ends at the first hit of a pair.
//!
//! All culls but the views are conservative, so the approximate modes find exactly those of the exact mode's pairs of
//! faces whose both faces are in view.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
