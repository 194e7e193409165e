//! Import of mesh files of all supported formats. The format is recognised by content or by file name.
//!
//! A mesh file may name others, as a `.gltf` file its buffers. Those in its own folder and the folders below are read;
//! one elsewhere only if a recipe says so with [`Recipe::read_outside`], so that a mesh from a stranger cannot reach
//! for other data. This is a rule about names: links in the folder are followed, for whoever can place a link there can
//! place the file.
//!
//! Files that break the rules of their format in a way that leaves no doubt are read with a
//! [warning](Imported::warnings), if other readers accept them too. A file that may have been cut off is an error,
//! although some readers take what is there, as of a text STL file without `endsolid`: the hole would be noticed late.
//!
//! # Why not 3MF
//! No crate reads it as well as these readers read the other formats (November 2026). `lib3mf` 0.1 is careful: millions
//! of damaged files did not make it panic. But it gives the triangles of a package's first model only, while Bambu
//! Studio and OrcaSlicer write each object into a model of its own, and it unpacks up to a gigabyte of any file,
//! however short. `lib3mf-core` 0.4, `threemf` 0.8 and `threemf2` 0.4 unpack without any limit: a file of 3 MB made the
//! last two take 0.5 GB and 1 GB. Programs that write 3MF write STL or OBJ too.

use super::collision_mesh::CollisionMesh;
use super::format::{self, Hash, Header};
use super::gltf::{self, GltfError};
pub use super::import_error::ImportError;
use super::part::MeshPart;
use super::recipe::{Recipe, is_recipe};
use super::{obj, off, ply, stl};
use crate::geometry::TriMesh;
use crate::projection::BakeSettings;
use std::borrow::Cow;
use std::path::Path;

/// The content of a mesh file.
#[derive(Clone, Debug)]
pub enum Imported {
    /// A mesh that is not baked.
    Mesh {
        /// The mesh.
        mesh: TriMesh,
        /// The settings of the recipe; the default if there is no recipe.
        settings: BakeSettings,
        /// [`format::source_hash`] of the mesh file. For a glTF file it also covers the chosen part and the other
        /// files.
        source_hash: Hash,
        /// See [`Imported::warnings`].
        warnings: Vec<String>,
    },
    /// A baked mesh from a `.faceoff` file.
    Baked {
        /// The baked mesh.
        mesh: CollisionMesh,
        /// The source and settings of the bake.
        header: Header,
    },
}

impl Imported {
    /// The triangle mesh, baked or not. The triangles of a baked one are in cluster order, with the face ids of the
    /// source.
    pub fn mesh(&self) -> &TriMesh {
        match self {
            Self::Mesh { mesh, .. } => mesh,
            Self::Baked { mesh, .. } => &mesh.mesh,
        }
    }

    /// What is wrong with the file, although it was read. [`BakedMesh::warnings`](super::BakedMesh::warnings) are those
    /// about the mesh.
    pub fn warnings(&self) -> &[String] {
        match self {
            Self::Mesh { warnings, .. } => warnings,
            Self::Baked { .. } => &[],
        }
    }
}

/// Reads a mesh from the bytes of a glTF, OBJ, STL, PLY, OFF or `.faceoff` file. For glTF this is the whole scene.
///
/// `name` is the file name. Its extension decides the format if the bytes do not. The file need not exist.
///
/// # Errors
/// If the format is unknown, the bytes are invalid, or a glTF file refers to other files.
pub fn import_bytes(name: &str, bytes: &[u8]) -> Result<TriMesh, ImportError> {
    import_part(name, bytes, None)
}

/// Reads a mesh as [`import_bytes`] does, or only a part of a glTF or OBJ file if `part` is given.
///
/// Logs [warnings](Imported::warnings) with `tracing`.
///
/// # Errors
/// As for [`import_bytes`]; also if there is no such part.
pub fn import_part(name: &str, bytes: &[u8], part: Option<&MeshPart>) -> Result<TriMesh, ImportError> {
    let source = Source::open(name, bytes)?;
    if let Some(file) = source.files(true)?.first() {
        return Err(GltfError::OtherFiles(file.clone()).into());
    }
    let imported = source.read(part, &[])?;
    for warning in imported.warnings() {
        tracing::warn!("{name}: {warning}");
    }
    match imported {
        Imported::Mesh { mesh, .. } => Ok(mesh),
        Imported::Baked { mesh, .. } => Ok(mesh.mesh.clone()),
    }
}

/// Reads a mesh file or a `.bake.ron` recipe from disk, and the files it refers to.
///
/// # Errors
/// If a file cannot be read or is invalid. Errors contain the path of the file. Pipes and devices are rejected.
pub fn import_file(path: impl AsRef<Path>) -> Result<Imported, ImportError> {
    let path = path.as_ref();
    let bytes = read_file(path)?;
    // A recipe that was baked in place keeps its name.
    if !is_recipe(&path.to_string_lossy()) || bytes.starts_with(&format::MAGIC) {
        return import_mesh_file(path, bytes, None, false);
    }
    let recipe = Recipe::parse(&bytes).map_err(|e| in_file(path, e))?;
    if recipe.mesh.contains("://") {
        return Err(in_file(path, ImportError::AssetSource(recipe.mesh)));
    }
    let mesh_path = path.with_file_name("").join(&recipe.mesh);
    let bytes = read_file(&mesh_path)?;
    let baked_hash = format::source_hash(&bytes);
    let imported = import_mesh_file(&mesh_path, bytes, recipe.part.as_ref(), recipe.read_outside)?;
    Ok(match imported {
        Imported::Mesh {
            mesh,
            source_hash,
            warnings,
            ..
        } => Imported::Mesh {
            mesh,
            settings: recipe.settings,
            source_hash,
            warnings,
        },
        // The settings of the recipe count, so the mesh is baked again.
        Imported::Baked { mesh, .. } => Imported::Mesh {
            mesh: mesh.mesh.clone().as_input(),
            settings: recipe.settings,
            source_hash: baked_hash,
            warnings: Vec::new(),
        },
    })
}

fn import_mesh_file(
    path: &Path,
    bytes: Vec<u8>,
    part: Option<&MeshPart>,
    read_outside: bool,
) -> Result<Imported, ImportError> {
    let source = Source::open(&path.to_string_lossy(), bytes).map_err(|e| in_file(path, e))?;
    let files = source.read_files(path, read_outside)?;
    source.read(part, &files).map_err(|e| in_file(path, e))
}

/// A mesh file of known format, parsed as far as possible without other files.
pub(crate) struct Source<'a> {
    bytes: Cow<'a, [u8]>,
    format: Format,
}

enum Format {
    Baked,
    Gltf(Box<gltf::Document>),
    Obj,
    Off,
    Ply,
    Stl,
}

impl<'a> Source<'a> {
    /// Recognises the format; parses a glTF document.
    pub(crate) fn open(name: &str, bytes: impl Into<Cow<'a, [u8]>>) -> Result<Self, ImportError> {
        let bytes = bytes.into();
        let format = Format::of(name, &bytes)?;
        Ok(Self { bytes, format })
    }

    /// The other files it needs, as paths relative to the mesh file, without `..` except at their start.
    ///
    /// # Errors
    /// If one is outside the folder of the mesh file, unless `read_outside` allows that.
    pub(crate) fn files(&self, read_outside: bool) -> Result<&[String], ImportError> {
        let files: &[String] = match &self.format {
            Format::Gltf(document) => &document.files,
            _ => &[],
        };
        match files.iter().find(|file| file.split('/').next() == Some("..")) {
            Some(file) if !read_outside => Err(ImportError::Outside(file.clone())),
            _ => Ok(files),
        }
    }

    /// Reads [`Source::files`] from disk, for the mesh file at `path`.
    pub(super) fn read_files(&self, path: &Path, read_outside: bool) -> Result<Vec<Vec<u8>>, ImportError> {
        let files = self.files(read_outside).map_err(|e| in_file(path, e))?;
        let read = |file: &String| read_file(&path.with_file_name("").join(file)).map_err(|e| in_file(path, e));
        files.iter().map(read).collect()
    }

    /// Reads the triangles. `files` holds the contents of [`Source::files`].
    pub(crate) fn read(&self, part: Option<&MeshPart>, files: &[Vec<u8>]) -> Result<Imported, ImportError> {
        let bytes = &*self.bytes;
        if part.is_some() && !matches!(self.format, Format::Gltf(_) | Format::Obj) {
            return Err(ImportError::NoParts);
        }
        let mut warnings = Vec::new();
        let mesh = match &self.format {
            Format::Baked => {
                let (mesh, header) = format::from_bytes(bytes)?;
                return Ok(Imported::Baked { mesh, header });
            }
            Format::Gltf(document) => {
                warnings.clone_from(&document.warnings);
                document.read(bytes, part, files)?
            }
            Format::Obj => obj::read(bytes, part, &mut warnings)?,
            Format::Off => off::read(bytes, &mut warnings)?,
            Format::Ply => ply::read(bytes, &mut warnings)?,
            Format::Stl => stl::read(bytes, &mut warnings)?,
        };
        Ok(Imported::Mesh {
            mesh,
            settings: BakeSettings::default(),
            source_hash: source_hash(bytes, part, files),
            warnings,
        })
    }
}

/// The hash of all input that the mesh depends on.
pub(crate) fn source_hash(bytes: &[u8], part: Option<&MeshPart>, files: &[Vec<u8>]) -> Hash {
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
        let format = Self::recognised(name, bytes)?;
        let is_text = match format {
            Self::Obj | Self::Off => true,
            Self::Stl => stl::is_text(bytes),
            Self::Baked | Self::Gltf(_) | Self::Ply => false,
        };
        if is_text && has_old_line_ends(bytes) {
            return Err(ImportError::OldLineEnds);
        }
        Ok(format)
    }

    fn recognised(name: &str, bytes: &[u8]) -> Result<Self, ImportError> {
        // A pointer of Git LFS may have any name.
        if bytes.starts_with(LFS_POINTER) {
            return Err(ImportError::LfsPointer);
        }
        if is_utf16(bytes) {
            return Err(ImportError::Utf16);
        }
        let extension = Path::new(name)
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase())
            .unwrap_or_default();
        if bytes.starts_with(&format::MAGIC) || extension == "faceoff" {
            return Ok(Self::Baked);
        }
        if is_recipe(name) {
            return Err(ImportError::RecipeNotMesh);
        }
        let unsupported = match extension.as_str() {
            _ if bytes.starts_with(b"Kaydara FBX") => Some("FBX"),
            "fbx" => Some("FBX"),
            "dae" => Some("Collada"),
            "blend" => Some("Blender"),
            "3mf" => Some("3MF"),
            _ if is_3mf(bytes) => Some("3MF"),
            _ => None,
        };
        if let Some(format) = unsupported {
            return Err(ImportError::Unsupported(format));
        }
        Ok(match extension.as_str() {
            "gltf" | "glb" => Self::Gltf(Box::new(gltf::Document::open(bytes)?)),
            _ if bytes.starts_with(b"glTF") => Self::Gltf(Box::new(gltf::Document::open(bytes)?)),
            "ply" => Self::Ply,
            _ if ply::is_likely(bytes) => Self::Ply,
            "obj" => Self::Obj,
            "off" => Self::Off,
            "stl" => Self::Stl,
            _ if gltf::is_likely(bytes) => Self::Gltf(Box::new(gltf::Document::open(bytes)?)),
            _ if off::is_likely(bytes) => Self::Off,
            _ if looks_like_obj(bytes) => Self::Obj,
            _ if stl::is_likely(bytes) => Self::Stl,
            _ => return Err(ImportError::Unknown),
        })
    }
}

/// How the text begins that Git LFS leaves in place of a file.
const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";

/// Whether the bytes are text in UTF-16: they begin with its byte order mark, and every other byte near it is zero.
fn is_utf16(bytes: &[u8]) -> bool {
    let zero = match bytes {
        [0xff, 0xfe, ..] => 1,
        [0xfe, 0xff, ..] => 0,
        _ => return false,
    };
    let start = &bytes[2..bytes.len().min(32)];
    start.len() >= 2 && start.chunks_exact(2).all(|unit| unit[zero] == 0)
}

/// Whether the lines of a text end with a carriage return alone, as on computers of the last century.
fn has_old_line_ends(bytes: &[u8]) -> bool {
    !bytes.contains(&b'\n') && bytes.trim_ascii().contains(&b'\r')
}

/// Whether the bytes are a ZIP file with the usual name of a 3MF model.
fn is_3mf(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 12)];
    start.starts_with(b"PK\x03\x04") && start.windows(8).any(|name| name.eq_ignore_ascii_case(b"3dmodel."))
}

/// Whether a line near the start of the file begins with a vertex.
fn looks_like_obj(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1 << 16)];
    !start.contains(&0) && start.split(|&b| b == b'\n').any(|line| line.starts_with(b"v "))
}

/// Reads a regular file. A recipe or a malicious mesh could refer to a device, which may be endless, or to a pipe,
/// which may block.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, ImportError> {
    match std::fs::metadata(path) {
        Ok(there) if !there.is_file() => Err(in_file(path, ImportError::NotAFile)),
        Ok(_) => std::fs::read(path).map_err(|e| in_file(path, e)),
        Err(e) => Err(in_file(path, e)),
    }
}

pub(super) fn in_file(path: &Path, error: impl Into<ImportError>) -> ImportError {
    ImportError::InFile {
        path: path.to_owned(),
        source: Box::new(error.into()),
    }
}
