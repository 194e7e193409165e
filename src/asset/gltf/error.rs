//! [`GltfError`]: why a glTF file cannot be read.

use crate::asset::part::NameOrIndex;
use thiserror::Error;

/// Why a glTF file cannot be read. Indices count from 0, as in glTF.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GltfError {
    /// The container of a `.glb` file is damaged.
    #[error("the GLB container is damaged ({0}); export or copy the file again")]
    Container(&'static str),
    /// The document is not valid JSON or not a valid glTF document.
    #[error("line {line}, column {column} of the glTF document: {reason}")]
    Document {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What is wrong.
        reason: String,
    },
    /// The version of glTF is not supported.
    #[error("the file is glTF {0:?}; export it as glTF 2.0")]
    Version(String),
    /// The file requires an extension that is not supported.
    #[error(
        "the file needs the glTF extension {0:?}, which is not supported; export it without, or without compression"
    )]
    Extension(String),
    /// A buffer is invalid.
    #[error("buffer {buffer}: {reason}")]
    Buffer {
        /// The index of the buffer.
        buffer: usize,
        /// What is wrong.
        reason: String,
    },
    /// The file needs other files, but only its bytes were given.
    #[error("its data is in {0:?}; give the path of the file, not its content")]
    OtherFiles(String),
    /// There is no scene, and no part was chosen.
    #[error("the file has no scene; choose one of its {meshes} meshes, as in part: (mesh: 0)")]
    NoScene {
        /// The number of meshes in the file.
        meshes: usize,
    },
    /// The scene or a node in it is invalid.
    #[error("{place} {index}: {reason}")]
    Scene {
        /// `"scene"` or `"node"`.
        place: &'static str,
        /// The index of the scene or node.
        index: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// The chosen mesh or node does not exist.
    #[error("there is no {kind} {choice}; there are {count}: {names}")]
    NoSuchPart {
        /// `"mesh"` or `"node"`.
        kind: &'static str,
        /// The chosen one.
        choice: NameOrIndex,
        /// The number of them in the file.
        count: usize,
        /// The names of the first ones.
        names: String,
    },
    /// The chosen primitive does not exist.
    #[error("mesh {mesh} has no primitive {primitive}; it has {count}")]
    NoSuchPrimitive {
        /// The index and name of the mesh.
        mesh: String,
        /// The chosen primitive.
        primitive: u32,
        /// The number of primitives of the mesh.
        count: usize,
    },
    /// A primitive is invalid.
    #[error("mesh {mesh}, primitive {primitive}: {reason}")]
    Primitive {
        /// The index and name of the mesh.
        mesh: String,
        /// The index of the primitive.
        primitive: usize,
        /// What is wrong.
        reason: String,
    },
    /// An accessor is invalid.
    #[error("mesh {mesh}, primitive {primitive}, accessor {accessor}: {reason}")]
    Accessor {
        /// The index and name of the mesh.
        mesh: String,
        /// The index of the primitive.
        primitive: usize,
        /// The index of the accessor.
        accessor: usize,
        /// What is wrong.
        reason: String,
    },
    /// The scene or the chosen part has no triangles.
    #[error("there are no triangles in {0}")]
    NoTriangles(&'static str),
    /// Repeated instances make far more vertices or triangles than the file holds.
    #[error(
        "the scene repeats its meshes to more than {limit} {what}, far more than the file holds; choose one mesh of it and \
         make each instance a body"
    )]
    TooManyInstances {
        /// `"vertices"` or `"triangles"`.
        what: &'static str,
        /// The maximum for a file of this length.
        limit: u64,
    },
}
