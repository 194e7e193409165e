//! Contact generation: the points at which two bodies push each other, for the solver.
//!
//! Per pair of bodies, whose surfaces come nearer than a margin or cross:
//!
//! 1. Pairs of triangles nearer than the margin are found down both trees of boxes.
//! 2. Features: a vertex over a face, separation `n_f . (v - f)`, where the projection lies in the face and no edge of the
//!    vertex leads below it; and two convex edges, whose cross product is a normal that the surfaces at both edges can have
//!    (the arc between the neighbouring faces' normals, the edge's part of the Gauss map), separation
//!    `n . (p_b - p_a)` from the closest points. An edge normal that is nearly a face's becomes that face's: otherwise
//!    bodies that lie flat on each other get normals that scatter, and stacks fall over.
//! 3. Where surfaces cross, the segments in which triangles intersect, oriented along the cross product of the faces'
//!    normals, are joined into closed contours by the edge that pierces and the face that is pierced. Each contour is a
//!    patch. Its area vector `1/2 sum (p - c) x dp` is the gradient of the volume of the overlap there, so it is the
//!    direction in which the bodies get out of each other fastest. Near a patch only features count whose normals
//!    agree with it, and only there may features overlap, within 4 % of the bodies' size. A patch that keeps no overlapping
//!    feature gets its points by rays along its normal, from five points in it to where they leave the bodies.
//! 4. One closed body inside the other without a crossing is pushed out the short way.
//! 5. At most [`MAX_POINTS`] are kept: the deepest, then always the one farthest from those kept, in position and normal.
//! 6. Finely cut round surfaces touch where the smooth ones would, and if they are round all ways along the normals of these.
//!
//! All of it follows from the surfaces alone, without a convex decomposition or a distance field, and finds nothing twice:
//! each vertex and edge is owned by one triangle.
//!
//! Triangles of meshes that are open, or whose faces disagree about the outside, have two sides: they push to the side on
//! which the other body's centre of mass lies.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub(crate) mod report;
pub(crate) mod step;

pub use crate::state::manifolds::{Manifold, ManifoldPoint, Manifolds};

/// How many points a pair has at most. With four a stack creeps by centimetres, with eight rings get into each other by
/// some percent of their size.
pub const MAX_POINTS: usize = 16;

/// A pair of bodies whose contact points are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginPair {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// Points are found where the surfaces come as near as this, metres; 0 or more.
    pub margin: f32,
}
