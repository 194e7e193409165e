//! Contact generation: contact manifolds of pairs of bodies, for the solver.
//!
//! Per pair whose surfaces intersect or come closer than the speculative margin:
//!
//! 1. The bounding-volume trees of both meshes are traversed for pairs of triangles closer than the margin. On the CPU
//!    the search has some slack once the pair's motion is known, and its candidates are kept until the bodies have
//!    moved by more than that.
//! 2. Features. Vertex-face: separation `n_f . (v - f)`, if the vertex projects into the face and none of its edges
//!    leads below the face. Edge-edge, of two convex edges: the normal is their cross product, if it lies on both
//!    edges' arcs of the Gauss map (between the normals of the adjacent faces); separation `n . (p_b - p_a)` of the
//!    closest points. An edge normal close to a face normal is replaced by it: otherwise the normals of bodies that lie
//!    flat on each other scatter, and stacks fall over. Where the bodies are nearest at other features, the way between
//!    the nearest points is the normal: a corner and an edge, two corners, edges that are parallel. At rims of open
//!    meshes all of these count.
//! 3. Contours. Where surfaces intersect, the segments in which triangles cross, oriented along the cross product of
//!    the faces' normals, are joined into closed contours through shared edge-face crossings. Each contour bounds a
//!    patch. Its area vector `1/2 sum (p - c) x dp` is the gradient of the overlap volume, so it is the direction in
//!    which the bodies separate fastest. Near a patch only features whose normals agree with it count, and only there
//!    may features overlap, by up to 2.5 % of the bodies' size. A patch at whose centre the bodies overlap by more, or
//!    that has no overlapping feature, gets its points from rays along its normal, cast from five points in the patch
//!    to where they leave the bodies. A contour that ends at the rim of an open mesh pushes the rim out through the
//!    other surface.
//! 4. Containment. A closed body inside another without intersecting faces is pushed out along the shortest way.
//! 5. Reduction. At most [`MAX_POINTS`] are kept: the deepest, then repeatedly the one farthest from those kept, in
//!    position and normal.
//! 6. Arrival. Within a step, points ahead of a body count if the surfaces meet there or do not meet before the next
//!    collision substep: not those on a plane that the body crosses beyond its face. See `cpu::arrival`. Pairs that
//!    meet elsewhere get the point of first contact: see [`ccd`](crate::ccd), and on a GPU
//!    `shaders/manifolds/first_contact.wgsl`.
//! 7. Smoothing. Finely tessellated curved surfaces touch where the smooth surfaces would, with their normals if they
//!    are convex in all directions.
//!
//! In a step of several collision substeps a pair that overlaps deeply keeps its points for some of them: see
//! `cpu::moved`. On the CPU a pair at rest keeps its features, and only their points are computed anew: see
//! `cpu::resting`.
//!
//! All of this follows from the surfaces alone, without a convex decomposition or a distance field. Each vertex and
//! edge is owned by one triangle, so no feature is found twice.
//!
//! Triangles of open meshes, and of meshes whose winding cannot be made consistent, are two-sided
//! ([`OneSided`](crate::geometry::OneSided)): they push to the side on which the other body's centre of mass lies.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub(crate) mod report;
pub(crate) mod step;

pub use crate::state::manifolds::{Manifold, ManifoldPoint, Manifolds};

/// Maximum number of points of a manifold. With four a stack creeps by centimetres; with eight, rings penetrate each
/// other by some percent of their size.
pub const MAX_POINTS: usize = 16;

/// A pair of bodies whose contact points are requested, with its margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginPair {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// Speculative margin: points are found where the surfaces are no farther apart, metres; 0 or more.
    pub margin: f32,
}
