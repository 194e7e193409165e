//! [`ImportError`]: why a mesh file cannot be read.

use super::format_error::FormatError;
use super::gltf::GltfError;
use super::part::MeshPart;
use super::recipe::RecipeError;
use crate::geometry::MeshError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a mesh file cannot be read. Lines count from 1; faces and vertices count from 0.
#[derive(Debug, Error)]
pub enum ImportError {
    /// A coordinate is not a number.
    #[error("line {line}: {word:?} is not a number; coordinates look like 1.5 or -2e-3")]
    NotANumber {
        /// The line.
        line: usize,
        /// The invalid word.
        word: String,
    },
    /// A coordinate is NaN, infinite, or too large for single precision.
    #[error("line {line}: {word} is not a finite single-precision number; export the mesh again, or use a larger unit")]
    NotFinite {
        /// The line.
        line: usize,
        /// The invalid word.
        word: String,
    },
    /// A vertex has fewer than three coordinates.
    #[error("line {line}: a vertex needs three coordinates")]
    ShortVertex {
        /// The line.
        line: usize,
    },
    /// A corner of a face is not an index.
    #[error("line {line}: {word:?} is not a face corner; corners look like 7, 7/1, 7//3 or 7/1/3")]
    NotAnIndex {
        /// The line.
        line: usize,
        /// The invalid word.
        word: String,
    },
    /// A face refers to a vertex that does not exist.
    #[error(
        "line {line}: a face names vertex {index}, but there are {vertices} vertices (indices count from 1, or backwards \
         from -1)"
    )]
    NoSuchVertex {
        /// The line.
        line: usize,
        /// The index as written in the file.
        index: i64,
        /// The number of vertices; for a negative index, the number read before it.
        vertices: usize,
    },
    /// There are more vertices or triangles than 32-bit indices can address.
    #[error("line {line}: the mesh is too large for 32-bit indices; split it")]
    TooLarge {
        /// The line.
        line: usize,
    },
    /// The file has no faces.
    #[error("there are {vertices} vertices and no faces; export the mesh with its faces")]
    NoFaces {
        /// The number of vertices found.
        vertices: usize,
    },
    /// A corner of a polygon in a PLY or OFF file is negative or beyond 32 bits.
    #[error("polygon {polygon} names vertex {index}; indices count from 0")]
    BadIndex {
        /// The index of the polygon in the file.
        polygon: usize,
        /// The index of the vertex.
        index: i64,
    },
    /// A file with the extension `.ply` is of another kind.
    #[error("the first line of the file is not \"ply\": it is not a PLY file; export or copy it again")]
    NotPly,
    /// The reader of PLY files found an error.
    #[error("{}{message}; export the mesh again", line.map_or(String::new(), |line| format!("line {line}: ")))]
    Ply {
        /// The line, if the error is in a line.
        line: Option<usize>,
        /// What is wrong.
        message: String,
    },
    /// An element of a PLY file lacks the properties that it needs.
    #[error("the element {0} of the PLY file has no {1}; export the mesh again")]
    PlyProperties(&'static str, &'static str),
    /// The header of a PLY file promises more than there is.
    #[error(
        "the file says that it has {count} elements {element}, for which its {length} bytes are too few: it is cut off or \
         damaged; export or copy it again"
    )]
    PlyCutOff {
        /// The name of the element.
        element: String,
        /// How many there are according to the header.
        count: usize,
        /// The length of the file in bytes.
        length: usize,
    },
    /// An OFF file of a kind that is not supported.
    #[error(
        "line {line}: {word:?} is not the start of an OFF file in text and three dimensions; export the mesh again"
    )]
    OffKind {
        /// The line.
        line: usize,
        /// The line's beginning.
        word: String,
    },
    /// A count in an OFF file is missing or negative.
    #[error(
        "line {line}: a count is missing or negative; after OFF there are the numbers of vertices, faces and edges"
    )]
    OffCounts {
        /// The line.
        line: usize,
    },
    /// An OFF file ends too early.
    #[error("the file says that it has {wanted} {what}, but there are {there}: it is cut off; export or copy it again")]
    OffCutOff {
        /// `"vertices"` or `"faces"`.
        what: &'static str,
        /// How many there are according to the header.
        wanted: u64,
        /// How many there are.
        there: u64,
    },
    /// The last face of an OFF file has fewer corners than it says.
    #[error("line {line}: a face says that it has {wanted} corners, and has fewer")]
    OffShortFace {
        /// The line.
        line: usize,
        /// The number of corners that it says.
        wanted: u64,
    },
    /// A count or index is not an integer.
    #[error("line {line}: {word:?} is not an integer")]
    NotAnInteger {
        /// The line.
        line: usize,
        /// The invalid word.
        word: String,
    },
    /// The file is neither text nor long enough to be binary STL.
    #[error("{length} bytes are too few for an STL file; export or copy it again")]
    StlHeader {
        /// The length of the file in bytes.
        length: usize,
    },
    /// A binary STL file ends too early, or the file is not STL.
    #[error(
        "the file says that it has {triangles} triangles, but there are {there}: it is cut off or not an STL file; export \
         or copy it again"
    )]
    StlCutOff {
        /// The number of triangles according to the header.
        triangles: u32,
        /// The number of triangles in the file.
        there: usize,
    },
    /// A binary STL file says that it has no triangles, but does not end there.
    #[error(
        "the file says that it has 0 triangles, but {rest} bytes follow, enough for {there}: its header is wrong; export the mesh \
         again"
    )]
    StlNoTriangles {
        /// The number of bytes after the header.
        rest: usize,
        /// The number of triangles that they may be.
        there: usize,
    },
    /// A corner in a binary STL file is NaN or infinite.
    #[error("triangle {face} has a coordinate that is not finite; export the mesh again")]
    StlNotFinite {
        /// The index of the triangle.
        face: usize,
    },
    /// The words of a text STL file are in a wrong order.
    #[error("line {line}: {reason}")]
    StlText {
        /// The line.
        line: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// A word is not a keyword of text STL.
    #[error("line {line}: {word:?} is not an STL keyword; they are solid, facet, normal, outer, loop and vertex")]
    StlWord {
        /// The line.
        line: usize,
        /// The invalid word.
        word: String,
    },
    /// A glTF file cannot be read.
    #[error(transparent)]
    Gltf(#[from] GltfError),
    /// A part was chosen in a file of a format without parts.
    #[error("only glTF and OBJ files have parts to choose from; remove the part")]
    NoParts,
    /// A part was chosen that files of this format do not have.
    #[error("{format} file has no {kind} to choose; choose {kinds}")]
    PartOfOtherFormat {
        /// The format, with its article.
        format: &'static str,
        /// `"mesh"`, `"node"`, `"object"` or `"group"`.
        kind: &'static str,
        /// The kinds of parts that the format has.
        kinds: &'static str,
    },
    /// The chosen object or group of an OBJ file does not exist.
    #[error("the file has no {kind} \"{name}\"; {names}")]
    NoSuchPart {
        /// `"object"` or `"group"`.
        kind: &'static str,
        /// The chosen name.
        name: String,
        /// The first names of those that exist.
        names: String,
    },
    /// The chosen object or group of an OBJ file has no faces.
    #[error("the {kind} \"{name}\" has no faces; choose another part, or export the mesh with its faces")]
    EmptyPart {
        /// `"object"` or `"group"`.
        kind: &'static str,
        /// The chosen name.
        name: String,
    },
    /// A mesh file needs a file that is not in its own folder or below it.
    #[error(
        "it names {0:?}, which is outside its own folder and is not read unless a recipe says so; move that file beside it, \
         or write read_outside: true into the recipe"
    )]
    Outside(String),
    /// The path is that of a folder, a pipe or a device.
    #[error("it is a folder, a pipe or a device; give the path of a mesh file")]
    NotAFile,
    /// The mesh of a recipe is in an asset source of an app.
    #[error("mesh: {0:?} is in an asset source, which only the app can read; give a path relative to the recipe")]
    AssetSource(String),
    /// The format is known but not supported.
    #[error(
        "{0} files are not supported; export the mesh as glTF, OBJ, STL, PLY or OFF, or build a TriMesh from its vertices and \
         faces in code"
    )]
    Unsupported(&'static str),
    /// The file is a pointer of Git LFS.
    #[error(
        "the file is a pointer of Git LFS, which stands in place of the mesh; run `git lfs pull`, or download the file itself"
    )]
    LfsPointer,
    /// The file is text in UTF-16.
    #[error("the file is text in UTF-16; save it as UTF-8 or ASCII")]
    Utf16,
    /// The lines of a text end with a carriage return alone.
    #[error(
        "the lines of the file end with a carriage return alone (CR), as on old Macs; save it with line feeds (LF or CR LF)"
    )]
    OldLineEnds,
    /// Neither the name nor the first bytes identify the format.
    #[error("the format is unknown; mesh files end in .gltf, .glb, .obj, .stl, .ply, .off, .faceoff or .bake.ron")]
    Unknown,
    /// The bytes are those of a recipe where a mesh is needed.
    #[error("a recipe does not contain a mesh; give the path of the recipe, not its content")]
    RecipeNotMesh,
    /// The vertices and faces are not a valid mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A `.faceoff` file cannot be read.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A `.bake.ron` file cannot be read.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The file system reported an error.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// One of the other errors, with the path of the file.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The path of the file.
        path: PathBuf,
        /// The error.
        source: Box<ImportError>,
    },
}

impl ImportError {
    /// A part that files of `format` do not have; `kinds` are those that they have.
    pub(super) fn wrong_part(part: &MeshPart, format: &'static str, kinds: &'static str) -> Self {
        Self::PartOfOtherFormat {
            format,
            kind: part.kind(),
            kinds,
        }
    }
}
