//! TriangleTest: which triangles of a pair intersect, and where the bodies push each other.
//!
//! Per pair, in single precision and padded so that nothing true is lost:
//! 1. clusters of eight triangles survive if they reach the other body's half of the best support axis, its bounding
//!    sphere, its box in either body's axes;
//! 2. surviving triangles are placed in the first body's axes and culled against the box of what is left of the other;
//!    here an approximate [`Culling`](crate::settings::Culling) leaves out those that the
//!    [`View`](super::state::View) of their end does not show;
//! 3. boxes of clusters, then of triangles, are compared eight at a time;
//! 4. pairs whose boxes overlap must cross each other's planes.
//!
//! What is left, a little more than the true intersections, is decided in double precision by
//! [`intersect`](crate::geometry::triangle::intersect). A pair without a hit may still be one body inside the other.
//!
//! All culls but the views are conservative, so the approximate modes find exactly those of the exact mode's pairs of
//! faces whose both faces are in view.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
