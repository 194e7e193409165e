//! The origin of a mesh file: what decides whether its bake is up to date, without its triangles.

use super::format::{self, Hash};
use super::import::{ImportError, Source, in_file, read_file, source_hash};
use super::part::MeshPart;
use super::recipe::{Recipe, is_recipe};
use crate::projection::BakeSettings;
use std::path::{Path, PathBuf};

/// What [`import_file`](super::import_file) would say of the origin of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// The hash of all input that the mesh depends on.
    pub source_hash: Hash,
    /// The settings of the recipe or of the baked file; the default for other meshes.
    pub settings: BakeSettings,
}

impl Origin {
    /// Reads a mesh file, and the files it refers to, but builds no mesh. This takes a fraction of the time of an
    /// import.
    ///
    /// # Errors
    /// If a file cannot be read, its format is unknown, or a recipe or a baked file is invalid. The content of other
    /// meshes is not checked: a mesh whose bake is up to date was valid when it was baked.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ImportError> {
        let path = path.as_ref();
        let bytes = read_file(path)?;
        if !is_recipe(&path.to_string_lossy()) || bytes.starts_with(&format::MAGIC) {
            return Self::of(path, bytes, None, false);
        }
        let recipe = Recipe::parse(&bytes).map_err(|e| in_file(path, e))?;
        if recipe.mesh.contains("://") {
            return Err(in_file(path, ImportError::AssetSource(recipe.mesh)));
        }
        let mesh = path.with_file_name("").join(&recipe.mesh);
        let bytes = read_file(&mesh)?;
        // A baked file is baked again with the settings of the recipe, so it is a source like any other.
        let whole = bytes.starts_with(&format::MAGIC).then(|| format::source_hash(&bytes));
        let origin = Self::of(&mesh, bytes, recipe.part.as_ref(), recipe.read_outside)?;
        Ok(Self {
            source_hash: whole.unwrap_or(origin.source_hash),
            settings: recipe.settings,
        })
    }

    fn of(path: &Path, bytes: Vec<u8>, part: Option<&MeshPart>, read_outside: bool) -> Result<Self, ImportError> {
        if bytes.starts_with(&format::MAGIC) {
            let (header, _) = format::verify(&bytes).map_err(|e| in_file(path, e))?;
            return Ok(Self {
                source_hash: header.source_hash,
                settings: header.settings,
            });
        }
        let source = Source::open(&path.to_string_lossy(), &bytes[..]).map_err(|e| in_file(path, e))?;
        let files = source.read_files(path, read_outside)?;
        Ok(Self {
            source_hash: source_hash(&bytes, part, &files),
            settings: BakeSettings::default(),
        })
    }
}

/// The files that [`import_file`](super::import_file) reads for a path: itself, the mesh that a recipe names, and the
/// buffers of a glTF file. A file that cannot be read names no others.
pub fn input_files(path: impl AsRef<Path>) -> Vec<PathBuf> {
    let mut files = vec![path.as_ref().to_owned()];
    if is_recipe(&files[0].to_string_lossy())
        && let Ok(bytes) = read_file(&files[0])
        && let Ok(recipe) = Recipe::parse(&bytes)
    {
        files.push(files[0].with_file_name("").join(recipe.mesh));
    }
    let mesh = files[files.len() - 1].clone();
    // Files of other formats name no files, and may be long.
    let is_gltf = |name: &str| {
        [".gltf", ".glb"]
            .iter()
            .any(|end| name.to_ascii_lowercase().ends_with(end))
    };
    if is_gltf(&mesh.to_string_lossy())
        && let Ok(bytes) = read_file(&mesh)
        && let Ok(source) = Source::open(&mesh.to_string_lossy(), bytes)
        && let Ok(buffers) = source.files(true)
    {
        files.extend(buffers.iter().map(|buffer| mesh.with_file_name("").join(buffer)));
    }
    files
}
