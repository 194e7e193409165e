//! [`MeshError`]: why a list of vertices and faces is not a valid mesh.

use super::mesh::MAX_COORDINATE;
use glam::Vec3;
use thiserror::Error;

/// Why a list of vertices and faces is not a valid mesh.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// The list of faces is empty.
    #[error("the mesh has no faces")]
    Empty,
    /// There are more vertices or faces than 32-bit indices can address.
    #[error("the mesh has {count} {what}, more than 32-bit indices can address")]
    TooLarge {
        /// `"vertices"` or `"faces"`.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A vertex has a NaN or infinite coordinate.
    #[error("vertex {vertex} is not finite: {position}")]
    NonFinite {
        /// Index of the vertex.
        vertex: u32,
        /// Its coordinates.
        position: Vec3,
    },
    /// The absolute value of a coordinate exceeds [`MAX_COORDINATE`].
    #[error("vertex {vertex} at {position} has a coordinate beyond {MAX_COORDINATE:e}: use a larger unit of length")]
    TooFar {
        /// Index of the vertex.
        vertex: u32,
        /// Its coordinates.
        position: Vec3,
    },
    /// A face refers to a vertex that does not exist.
    #[error("face {face} names vertex {index}, but the mesh has {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the face.
        face: u32,
        /// The vertex index in the face.
        index: u32,
        /// The number of vertices of the mesh.
        vertices: u32,
    },
    /// Every face has zero area.
    #[error("all {faces} faces are degenerate (zero area)")]
    AllDegenerate {
        /// The number of faces.
        faces: u32,
    },
}
