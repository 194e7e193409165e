//! Why a file gives no mesh.

use super::format::FormatError;
use super::gltf::GltfError;
use super::recipe::RecipeError;
use crate::geometry::MeshError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a file gives no mesh. Lines count from 1, faces and vertices from 0.
#[derive(Debug, Error)]
pub enum ImportError {
    /// A coordinate is no number.
    #[error("line {line}: {word:?} is not a number; coordinates look like 1.5 or -2e-3")]
    NotANumber {
        /// Where.
        line: usize,
        /// What stands there.
        word: String,
    },
    /// A coordinate is NaN, infinite, or too large for single precision.
    #[error("line {line}: {word} is not a finite single-precision number; export the mesh again, or use a larger unit")]
    NotFinite {
        /// Where.
        line: usize,
        /// What stands there.
        word: String,
    },
    /// A vertex with fewer than three coordinates.
    #[error("line {line}: a vertex needs three coordinates")]
    ShortVertex {
        /// Where.
        line: usize,
    },
    /// A corner of a face is no index.
    #[error("line {line}: {word:?} is not a face corner; corners look like 7, 7/1, 7//3 or 7/1/3")]
    NotAnIndex {
        /// Where.
        line: usize,
        /// What stands there.
        word: String,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "line {line}: a face names vertex {index}, but there are {vertices} vertices (they count from 1, and from -1 \
         backwards)"
    )]
    NoSuchVertex {
        /// Where.
        line: usize,
        /// The index as it stands there.
        index: i64,
        /// How many vertices there are; for a negative index, how many were read before it.
        vertices: usize,
    },
    /// More vertices or triangles than 32-bit indices can name.
    #[error("line {line}: the mesh is too large for 32-bit indices; split it")]
    TooLarge {
        /// Where.
        line: usize,
    },
    /// There is nothing to collide with.
    #[error("there are {vertices} vertices and no faces; is this an OBJ file, exported with its faces?")]
    NoFaces {
        /// How many vertices were found.
        vertices: usize,
    },
    /// Neither text nor long enough to be binary STL.
    #[error("{length} bytes are too few for an STL file; export or copy it again")]
    StlHeader {
        /// How long the file is.
        length: usize,
    },
    /// A binary STL file ends too early, or is no STL file.
    #[error(
        "the file says that it has {triangles} triangles, but there are {there}: it is cut off, or no STL file; export or \
         copy it again"
    )]
    StlCutOff {
        /// How many there should be.
        triangles: u32,
        /// How many there are.
        there: usize,
    },
    /// A corner in a binary STL file is NaN or infinite.
    #[error("triangle {face} has a coordinate that is not finite; export the mesh again")]
    StlNotFinite {
        /// The number of the triangle.
        face: usize,
    },
    /// Words of a text STL file in a wrong order.
    #[error("line {line}: {reason}")]
    StlText {
        /// Where.
        line: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A word that has no meaning in a text STL file.
    #[error("line {line}: {word:?} is no word of STL, which has solid, facet, normal, outer, loop and vertex")]
    StlWord {
        /// Where.
        line: usize,
        /// What stands there.
        word: String,
    },
    /// A glTF file that cannot be read.
    #[error(transparent)]
    Gltf(#[from] GltfError),
    /// A part was chosen of a file that has none.
    #[error("only glTF files have parts to choose from; remove the part")]
    NoParts,
    /// A path leads to something else than a file.
    #[error("it is no file but a folder, a pipe or a device; name a mesh file")]
    NoFile,
    /// A recipe names a mesh in an asset source of an app.
    #[error(
        "mesh: {0:?} is in an asset source, which only the app that has it can read; name a path relative to the recipe"
    )]
    AssetSource(String),
    /// A format that is not read.
    #[error(
        "{0} files are not read; export the mesh as glTF, OBJ or STL, or build a TriMesh from its vertices and faces in code"
    )]
    Foreign(&'static str),
    /// Neither the name nor the first bytes tell what it is.
    #[error("the format is unknown; mesh files end in .gltf, .glb, .obj, .stl, .faceoff or .bake.ron")]
    Unknown,
    /// A recipe where a mesh is needed.
    #[error("a recipe holds no mesh; give the path of the recipe, not its content")]
    RecipeIsNoMesh,
    /// The faces are read but are no usable mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A `.faceoff` file that cannot be read.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A `.bake.ron` file that cannot be read.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The file system failed.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// Any of these, with the file it is about.
    #[error("{}: {source}", path.display())]
    InFile {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<ImportError>,
    },
}
