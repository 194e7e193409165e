//! [`LoadError`]: why a collision mesh was not loaded.

use crate::asset::import::ImportError;
use crate::asset::recipe::RecipeError;
use crate::projection::{Cancelled, SettingsError};
use bevy::asset::{AssetPath, ParseAssetPathError, ReadAssetBytesError};
use thiserror::Error;

/// Why a file was not loaded. In the log Bevy prefixes it with the path.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file could not be read.
    #[error("{0}")]
    Read(#[from] std::io::Error),
    /// The file is not a valid mesh.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The file is not a valid recipe.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The settings of the load are invalid.
    #[error("the load's settings are impossible: {0}")]
    Settings(#[from] SettingsError),
    /// The path of the recipe's mesh is not an asset path.
    #[error("mesh: {path:?} is not an asset path ({source})")]
    MeshPath {
        /// The path as it is in the recipe.
        path: String,
        /// The reason.
        source: ParseAssetPathError,
    },
    /// A path in a recipe or a glTF file leads out of the asset folder.
    #[error("it names {0}, which is outside the asset folder; move that file into it")]
    OutsideFolder(AssetPath<'static>),
    /// The recipe's mesh, or a file that a glTF file refers to, could not be read.
    #[error("it names {path}, which cannot be read: {source}")]
    ReadFile {
        /// The file.
        path: AssetPath<'static>,
        /// The reason.
        source: Box<ReadAssetBytesError>,
    },
    /// The recipe's mesh is not a valid mesh.
    #[error("the recipe names {path}: {source}")]
    InMesh {
        /// The mesh.
        path: AssetPath<'static>,
        /// The reason.
        source: Box<LoadError>,
    },
    /// The load was cancelled because its last handle was dropped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The bake panicked, which is a bug.
    #[error("the bake panicked: {0}; please report this with the mesh")]
    Panicked(String),
}
