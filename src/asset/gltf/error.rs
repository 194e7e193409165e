//! Why a glTF file gives no mesh.

use super::MeshChoice;
use thiserror::Error;

/// Why a glTF file gives no mesh. Everything counts from 0, as glTF does.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GltfError {
    /// The container of a `.glb` file is broken.
    #[error("the GLB container is damaged ({0}); export or copy the file again")]
    Container(&'static str),
    /// The document is no JSON, or not what glTF wants it to be.
    #[error("line {line}, column {column} of the glTF document: {reason}")]
    Document {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What is wrong.
        reason: String,
    },
    /// Another version of glTF.
    #[error("the file is glTF {0:?}; export it as glTF 2.0")]
    Version(String),
    /// The mesh cannot be understood without an extension that is not read.
    #[error("the file needs the glTF extension {0:?}, which is not read; export it without (compression, say)")]
    Extension(String),
    /// A buffer has no data.
    #[error("buffer {buffer}: {reason}")]
    Buffer {
        /// Which one.
        buffer: usize,
        /// What is wrong.
        reason: String,
    },
    /// Data lies in other files.
    #[error("its data lies in {0:?}; give the path of the file, not its content")]
    OtherFiles(String),
    /// There is no scene, and no mesh was chosen.
    #[error("the file has no scene; choose one of its {meshes} meshes, as in part: (mesh: 0)")]
    NoScene {
        /// How many meshes there are.
        meshes: usize,
    },
    /// The scene or a node in it is impossible.
    #[error("{place} {index}: {reason}")]
    Scene {
        /// `"scene"` or `"node"`.
        place: &'static str,
        /// Which one.
        index: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// The chosen mesh is not there.
    #[error("there is no mesh {choice}; there are {count}: {names}")]
    NoSuchMesh {
        /// What was asked for.
        choice: MeshChoice,
        /// How many there are.
        count: usize,
        /// What the first of them are called.
        names: String,
    },
    /// The chosen primitive is not there.
    #[error("mesh {mesh} has no primitive {primitive}; it has {count}")]
    NoSuchPrimitive {
        /// Number and name of the mesh.
        mesh: String,
        /// What was asked for.
        primitive: u32,
        /// How many there are.
        count: usize,
    },
    /// A primitive cannot be read.
    #[error("mesh {mesh}, primitive {primitive}: {reason}")]
    Primitive {
        /// Number and name of the mesh.
        mesh: String,
        /// Which of its primitives.
        primitive: usize,
        /// What is wrong.
        reason: String,
    },
    /// An accessor cannot be read.
    #[error("mesh {mesh}, primitive {primitive}, accessor {accessor}: {reason}")]
    Accessor {
        /// Number and name of the mesh.
        mesh: String,
        /// Which of its primitives.
        primitive: usize,
        /// Which accessor.
        accessor: usize,
        /// What is wrong.
        reason: String,
    },
    /// There is nothing to collide with.
    #[error("there are no triangles in {0}")]
    NoTriangles(&'static str),
    /// Repeated instances make far more than the file holds.
    #[error(
        "the scene repeats its meshes to more than {limit} {what}, far more than the file holds; choose one mesh of it and \
         make a body of each instance"
    )]
    TooManyInstances {
        /// `"vertices"` or `"triangles"`.
        what: &'static str,
        /// The most that a file of this length may have.
        limit: u64,
    },
}
