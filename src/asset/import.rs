//! Mesh files of any kind we read, recognised by magic or by name.

use super::collision_mesh::CollisionMesh;
use super::format::{self, FormatError, Hash, Header};
use super::obj;
use super::recipe::{Recipe, RecipeError, is_recipe};
use super::stl;
use crate::geometry::{MeshError, TriMesh};
use crate::projection::BakeSettings;
use std::path::{Path, PathBuf};
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
    /// A format that is not read.
    #[error(
        "{0} files are not read; export the mesh as OBJ or STL, or build a TriMesh from its vertices and faces in code"
    )]
    Foreign(&'static str),
    /// Neither the name nor the first bytes tell what it is.
    #[error("the format is unknown; mesh files end in .obj, .stl, .faceoff or .bake.ron")]
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

/// What a mesh file holds.
#[derive(Clone, Debug)]
pub enum Imported {
    /// A mesh yet to be baked.
    Mesh {
        /// The mesh.
        mesh: TriMesh,
        /// What the recipe asks for; the default if there is no recipe.
        settings: BakeSettings,
        /// [`format::source_hash`] of the mesh file.
        source_hash: Hash,
    },
    /// A `.faceoff` file.
    Baked {
        /// The baked mesh.
        mesh: CollisionMesh,
        /// What it was made from.
        header: Header,
    },
}

impl Imported {
    /// The mesh as such, baked or not. A baked one has its triangles in cluster order, with the face ids of its source.
    pub fn mesh(&self) -> &TriMesh {
        match self {
            Self::Mesh { mesh, .. } => mesh,
            Self::Baked { mesh, .. } => &mesh.mesh,
        }
    }
}

/// Reads a mesh from the bytes of an OBJ, STL or `.faceoff` file. `name` is its file name; its ending decides where the bytes do
/// not, and it need not name a file that exists.
pub fn import_bytes(name: &str, bytes: &[u8]) -> Result<TriMesh, ImportError> {
    match import(name, bytes)? {
        Imported::Mesh { mesh, .. } => Ok(mesh),
        Imported::Baked { mesh, .. } => Ok(mesh.mesh.clone()),
    }
}

/// Reads an `.obj`, `.stl`, `.faceoff` or `.bake.ron` file from disk, the last with the mesh it names. Errors name the file.
pub fn import_file(path: impl AsRef<Path>) -> Result<Imported, ImportError> {
    let path = path.as_ref();
    let name = path.to_string_lossy();
    if !is_recipe(&name) {
        return in_file(path, |bytes| import(&name, bytes));
    }
    let recipe = in_file(path, |bytes| Ok(Recipe::parse(bytes)?))?;
    let mesh_path = path.with_file_name("").join(&recipe.mesh);
    in_file(&mesh_path, |bytes| {
        Ok(Imported::Mesh {
            mesh: import_bytes(&recipe.mesh, bytes)?,
            settings: recipe.settings,
            source_hash: format::source_hash(bytes),
        })
    })
}

/// As [`import_bytes`], keeping what is baked.
pub(super) fn import(name: &str, bytes: &[u8]) -> Result<Imported, ImportError> {
    let extension = Path::new(name)
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default();
    if bytes.starts_with(&format::MAGIC) || extension == "faceoff" {
        let (mesh, header) = format::from_bytes(bytes)?;
        return Ok(Imported::Baked { mesh, header });
    }
    if is_recipe(name) {
        return Err(ImportError::RecipeIsNoMesh);
    }
    let foreign = match extension.as_str() {
        _ if bytes.starts_with(b"glTF") => Some("glTF"),
        _ if bytes.starts_with(b"Kaydara FBX") => Some("FBX"),
        _ if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") => Some("PLY"),
        "glb" | "gltf" => Some("glTF"),
        "fbx" => Some("FBX"),
        "ply" => Some("PLY"),
        "dae" => Some("Collada"),
        "blend" => Some("Blender"),
        _ => None,
    };
    if let Some(format) = foreign {
        return Err(ImportError::Foreign(format));
    }
    let mesh = match extension.as_str() {
        "obj" => obj::read(bytes)?,
        "stl" => stl::read(bytes)?,
        _ if looks_like_obj(bytes) => obj::read(bytes)?,
        _ if stl::is_likely(bytes) => stl::read(bytes)?,
        _ => return Err(ImportError::Unknown),
    };
    Ok(Imported::Mesh {
        mesh,
        settings: BakeSettings::default(),
        source_hash: format::source_hash(bytes),
    })
}

/// Whether a vertex stands at the beginning of a line early in the file.
fn looks_like_obj(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    !start.contains(&0) && start.split(|&b| b == b'\n').any(|line| line.starts_with(b"v "))
}

fn in_file<T>(path: &Path, read: impl FnOnce(&[u8]) -> Result<T, ImportError>) -> Result<T, ImportError> {
    std::fs::read(path)
        .map_err(ImportError::Io)
        .and_then(|bytes| read(&bytes))
        .map_err(|source| ImportError::InFile {
            path: path.to_owned(),
            source: Box::new(source),
        })
}
