//! Mesh files of any kind we read, recognised by magic or by name.

use super::collision_mesh::CollisionMesh;
use super::format::{self, Hash, Header};
use super::gltf::{self, GltfError, MeshPart};
pub use super::import_error::ImportError;
use super::obj;
use super::recipe::{Recipe, is_recipe};
use super::stl;
use crate::geometry::TriMesh;
use crate::projection::BakeSettings;
use std::borrow::Cow;
use std::path::Path;

/// What a mesh file holds.
#[derive(Clone, Debug)]
pub enum Imported {
    /// A mesh yet to be baked.
    Mesh {
        /// The mesh.
        mesh: TriMesh,
        /// What the recipe asks for; the default if there is no recipe.
        settings: BakeSettings,
        /// [`format::source_hash`] of the mesh file; of a glTF file with a chosen part or other files, of these too.
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

/// Reads a mesh from the bytes of a glTF, OBJ, STL or `.faceoff` file. `name` is its file name; its ending decides where the
/// bytes do not, and it need not name a file that exists. Of a glTF file this is the whole scene.
pub fn import_bytes(name: &str, bytes: &[u8]) -> Result<TriMesh, ImportError> {
    import_part(name, bytes, None)
}

/// As [`import_bytes`], but a part of a glTF file, if `part` names one.
pub fn import_part(name: &str, bytes: &[u8], part: Option<&MeshPart>) -> Result<TriMesh, ImportError> {
    let source = Source::open(name, bytes)?;
    if let Some(file) = source.files().first() {
        return Err(GltfError::OtherFiles(file.clone()).into());
    }
    match source.read(part, &[])? {
        Imported::Mesh { mesh, .. } => Ok(mesh),
        Imported::Baked { mesh, .. } => Ok(mesh.mesh.clone()),
    }
}

/// Reads a mesh file or a `.bake.ron` recipe from disk, with the files it names. Errors name the file. Pipes and devices are
/// refused.
pub fn import_file(path: impl AsRef<Path>) -> Result<Imported, ImportError> {
    let path = path.as_ref();
    let bytes = read_file(path)?;
    // A recipe that was baked in place keeps its name.
    if !is_recipe(&path.to_string_lossy()) || bytes.starts_with(&format::MAGIC) {
        return import_mesh_file(path, bytes, None);
    }
    let recipe = Recipe::parse(&bytes).map_err(|e| in_file(path, e))?;
    if recipe.mesh.contains("://") {
        return Err(in_file(path, ImportError::AssetSource(recipe.mesh)));
    }
    let mesh_path = path.with_file_name("").join(&recipe.mesh);
    let bytes = read_file(&mesh_path)?;
    let baked_hash = format::source_hash(&bytes);
    Ok(match import_mesh_file(&mesh_path, bytes, recipe.part.as_ref())? {
        Imported::Mesh { mesh, source_hash, .. } => Imported::Mesh {
            mesh,
            settings: recipe.settings,
            source_hash,
        },
        // What the recipe asks for is baked anew, from the mesh alone.
        Imported::Baked { mesh, .. } => Imported::Mesh {
            mesh: mesh.mesh.clone(),
            settings: recipe.settings,
            source_hash: baked_hash,
        },
    })
}

fn import_mesh_file(path: &Path, bytes: Vec<u8>, part: Option<&MeshPart>) -> Result<Imported, ImportError> {
    let source = Source::open(&path.to_string_lossy(), bytes).map_err(|e| in_file(path, e))?;
    let mut files = Vec::new();
    for file in source.files() {
        let file = path.with_file_name("").join(file);
        files.push(read_file(&file).map_err(|e| in_file(path, e))?);
    }
    source.read(part, &files).map_err(|e| in_file(path, e))
}

/// A mesh file of known format, with all that is read of it before other files.
pub(crate) struct Source<'a> {
    bytes: Cow<'a, [u8]>,
    format: Format,
}

enum Format {
    Baked,
    Gltf(Box<gltf::Document>),
    Obj,
    Stl,
}

impl<'a> Source<'a> {
    /// Recognises the format.
    pub(crate) fn open(name: &str, bytes: impl Into<Cow<'a, [u8]>>) -> Result<Self, ImportError> {
        let bytes = bytes.into();
        let format = Format::of(name, &bytes)?;
        Ok(Self { bytes, format })
    }

    /// The other files it needs, relative to its own.
    pub(crate) fn files(&self) -> &[String] {
        match &self.format {
            Format::Gltf(document) => &document.files,
            _ => &[],
        }
    }

    /// Reads the triangles. `files` holds the contents of [`Source::files`].
    pub(crate) fn read(&self, part: Option<&MeshPart>, files: &[Vec<u8>]) -> Result<Imported, ImportError> {
        let bytes = &*self.bytes;
        if part.is_some() && !matches!(self.format, Format::Gltf(_)) {
            return Err(ImportError::NoParts);
        }
        let mesh = match &self.format {
            Format::Baked => {
                let (mesh, header) = format::from_bytes(bytes)?;
                return Ok(Imported::Baked { mesh, header });
            }
            Format::Gltf(document) => document.read(bytes, part, files)?,
            Format::Obj => obj::read(bytes)?,
            Format::Stl => stl::read(bytes)?,
        };
        Ok(Imported::Mesh {
            mesh,
            settings: BakeSettings::default(),
            source_hash: source_hash(bytes, part, files),
        })
    }
}

/// The hash of everything that the mesh depends on.
fn source_hash(bytes: &[u8], part: Option<&MeshPart>, files: &[Vec<u8>]) -> Hash {
    let hash = format::source_hash(bytes);
    if part.is_none() && files.is_empty() {
        return hash;
    }
    let mut all = hash.to_vec();
    for file in files {
        all.extend(format::source_hash(file));
    }
    if let Some(part) = part {
        all.extend(part.to_string().as_bytes());
    }
    format::source_hash(&all)
}

impl Format {
    fn of(name: &str, bytes: &[u8]) -> Result<Self, ImportError> {
        let extension = Path::new(name)
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default();
        if bytes.starts_with(&format::MAGIC) || extension == "faceoff" {
            return Ok(Self::Baked);
        }
        if is_recipe(name) {
            return Err(ImportError::RecipeIsNoMesh);
        }
        let foreign = match extension.as_str() {
            _ if bytes.starts_with(b"Kaydara FBX") => Some("FBX"),
            _ if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") => Some("PLY"),
            "fbx" => Some("FBX"),
            "ply" => Some("PLY"),
            "dae" => Some("Collada"),
            "blend" => Some("Blender"),
            _ => None,
        };
        if let Some(format) = foreign {
            return Err(ImportError::Foreign(format));
        }
        Ok(match extension.as_str() {
            "gltf" | "glb" => Self::Gltf(Box::new(gltf::Document::open(bytes)?)),
            _ if bytes.starts_with(b"glTF") => Self::Gltf(Box::new(gltf::Document::open(bytes)?)),
            "obj" => Self::Obj,
            "stl" => Self::Stl,
            _ if gltf::is_likely(bytes) => Self::Gltf(Box::new(gltf::Document::open(bytes)?)),
            _ if looks_like_obj(bytes) => Self::Obj,
            _ if stl::is_likely(bytes) => Self::Stl,
            _ => return Err(ImportError::Unknown),
        })
    }
}

/// Whether a vertex stands at the beginning of a line early in the file.
fn looks_like_obj(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    !start.contains(&0) && start.split(|&b| b == b'\n').any(|line| line.starts_with(b"v "))
}

/// A device, which a recipe or a hostile mesh might name, has no end, and a pipe may never begin.
fn read_file(path: &Path) -> Result<Vec<u8>, ImportError> {
    match std::fs::metadata(path) {
        Ok(there) if !there.is_file() => Err(in_file(path, ImportError::NoFile)),
        Ok(_) => std::fs::read(path).map_err(|e| in_file(path, e)),
        Err(e) => Err(in_file(path, e)),
    }
}

fn in_file(path: &Path, error: impl Into<ImportError>) -> ImportError {
    ImportError::InFile {
        path: path.to_owned(),
        source: Box::new(error.into()),
    }
}
