//! Loads [`CollisionMesh`]es through Bevy's asset server.
//!
//! The normal way is a recipe beside the mesh, `knot.bake.ron`, which names the mesh and how to bake it:
//!
//! ```no_run
//! # use bevy::prelude::*;
//! # use bevy_faceoff::asset::CollisionMesh;
//! # fn load(assets: Res<AssetServer>) {
//! let baked: Handle<CollisionMesh> = assets.load("knot.bake.ron");
//! let faster: Handle<CollisionMesh> = assets.load("knot.faceoff");
//! let without_recipe: Handle<CollisionMesh> = assets.load("knot.obj");
//! # }
//! ```
//!
//! Recipes and `.faceoff` files are known by their extension. Other meshes are not, on purpose: Bevy asks the loader registered
//! last for an extension, so claiming `obj` or `glb` would take scenes away from other loaders. They are reached by the type of the
//! handle instead, as above. Reading and baking happen off the IO pool, so that other assets load meanwhile, and stop when
//! the last handle is dropped.
//!
//! # Two traps of Bevy's
//! * A path is loaded once. Two loads of one path with different settings give one handle, with the settings of the first.
//!   To bake a mesh in two ways write two recipes.
//! * A `.meta` file that names this loader hides the mesh from every other loader, so its scene can no longer be shown.
//!   Write `.meta` files only for meshes that are for collision alone, and recipes for all others.
//!
//! Bevy matches extensions from the first dot on: `knot.v2.bake.ron` is loaded by type, or not at all.

use super::collision_mesh::CollisionMesh;
use super::import::{ImportError, Imported, import};
use super::jobs::{on_bake_pool, on_compute_pool};
use super::recipe::{Recipe, RecipeError, is_recipe};
use crate::projection::{BakeSettings, Cancelled, SettingsError};
use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AssetPath, LoadContext, ParseAssetPathError, ReadAssetBytesError};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Loads `.faceoff` and `.bake.ron` files, and other meshes by type; see the [module](self).
#[derive(Default, TypePath)]
pub struct CollisionMeshLoader;

/// Settings of one load, in code or in a `.meta` file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CollisionMeshSettings {
    /// How to bake. Outranks the recipe; a `.faceoff` file that was baked otherwise gets a new face table. Without it, the
    /// recipe or the file decides, and any other mesh is baked by the default settings.
    pub bake: Option<BakeSettings>,
}

/// Why a file was not loaded. Bevy puts the path before it.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The bytes could not be read.
    #[error("{0}")]
    Read(#[from] std::io::Error),
    /// The bytes are no mesh.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The bytes are no recipe.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The settings of the load are impossible.
    #[error("the load's settings are impossible: {0}")]
    Settings(#[from] SettingsError),
    /// The recipe's path is not an asset path.
    #[error("mesh: {path:?} is not an asset path ({source})")]
    MeshPath {
        /// As the recipe has it.
        path: String,
        /// What is wrong.
        source: ParseAssetPathError,
    },
    /// The recipe's path leaves the asset folder.
    #[error("the recipe names {0}, which is outside the asset folder; move the mesh into it")]
    OutsideFolder(AssetPath<'static>),
    /// The recipe's mesh could not be read.
    #[error("the recipe names {path}, which cannot be read: {source}")]
    ReadMesh {
        /// The mesh.
        path: AssetPath<'static>,
        /// Why.
        source: Box<ReadAssetBytesError>,
    },
    /// The recipe's mesh is no mesh.
    #[error("the recipe names {path}: {source}")]
    InMesh {
        /// The mesh.
        path: AssetPath<'static>,
        /// What is wrong with it.
        source: Box<LoadError>,
    },
    /// Nobody wanted it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A bug in the bake.
    #[error("the bake panicked: {0}; please report this with the mesh")]
    Panicked(String),
}

impl AssetLoader for CollisionMeshLoader {
    type Asset = CollisionMesh;
    type Settings = CollisionMeshSettings;
    type Error = LoadError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        settings: &CollisionMeshSettings,
        context: &mut LoadContext<'_>,
    ) -> Result<CollisionMesh, LoadError> {
        let wanted = settings.bake;
        if let Some(settings) = &wanted {
            settings.validate()?;
        }
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let path = context.path().clone();
        let name = path.path().to_string_lossy().into_owned();
        let mesh = if is_recipe(&name) {
            let recipe = Recipe::parse(&bytes)?;
            let mesh_path = mesh_path(&path, &recipe.mesh)?;
            let bytes = context
                .read_asset_bytes(&mesh_path)
                .await
                .map_err(|source| LoadError::ReadMesh {
                    path: mesh_path.clone(),
                    source: Box::new(source),
                })?;
            load_mesh(recipe.mesh, bytes, wanted.or(Some(recipe.settings)))
                .await
                .map_err(|source| LoadError::InMesh {
                    path: mesh_path,
                    source: Box::new(source),
                })?
        } else {
            load_mesh(name, bytes, wanted).await?
        };
        for warning in mesh.warnings() {
            tracing::warn!("{path}: {warning}");
        }
        Ok(mesh)
    }

    fn extensions(&self) -> &[&str] {
        &["faceoff", "bake.ron"]
    }
}

/// The asset path of a recipe's mesh.
fn mesh_path(recipe: &AssetPath<'static>, mesh: &str) -> Result<AssetPath<'static>, LoadError> {
    let path = recipe.resolve_embed_str(mesh).map_err(|source| LoadError::MeshPath {
        path: mesh.into(),
        source,
    })?;
    // Bevy checks this for loads, but not where a loader reads bytes.
    if path.is_unapproved() {
        return Err(LoadError::OutsideFolder(path));
    }
    Ok(path)
}

/// Parses and bakes off the IO pool. Only the face table goes to the pool for bakes, which serves one table after the other:
/// a mesh without a table would wait there behind tables that take seconds.
async fn load_mesh(name: String, bytes: Vec<u8>, wanted: Option<BakeSettings>) -> Result<CollisionMesh, LoadError> {
    let (mesh, settings) = on_compute_pool(move || {
        Ok(match import(&name, &bytes)? {
            Imported::Mesh { mesh, settings, .. } => (CollisionMesh::new(&mesh), wanted.unwrap_or(settings)),
            Imported::Baked { mesh, .. } => {
                let settings = wanted.unwrap_or(mesh.settings);
                (mesh, settings)
            }
        })
    })
    .await?;
    if mesh.settings == settings {
        return Ok(mesh);
    }
    on_bake_pool(move |pool, progress| Ok(mesh.rebake(settings, pool, progress)?)).await
}

/// Registers the asset and its loader. Returns whether that was possible: without Bevy's `AssetPlugin` it is not, and an
/// error that says so is logged. A second call does nothing.
pub fn register(app: &mut App) -> bool {
    if !app.world().contains_resource::<AssetServer>() {
        tracing::error!(
            "collision meshes are assets: add bevy's AssetPlugin (or DefaultPlugins) before the plugins of bevy_faceoff"
        );
        return false;
    }
    if !app.world().contains_resource::<Assets<CollisionMesh>>() {
        app.init_asset::<CollisionMesh>()
            .register_asset_loader(CollisionMeshLoader);
    }
    true
}
