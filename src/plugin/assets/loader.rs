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
//! let of_a_scene: Handle<CollisionMesh> = assets.load("machine.glb");
//! # }
//! ```
//!
//! Recipes and `.faceoff` files are known by their extension. Other meshes are not, on purpose: Bevy asks the loader registered
//! last for an extension, so claiming `obj` or `glb` would take scenes away from other loaders. They are reached by the type of the
//! handle instead, as above. Reading and baking happen off the IO pool, so that other assets load meanwhile, and stop when
//! the last handle is dropped. Tables of faces of collision are baked one after the other. A load that waits for one keeps
//! its file open, which is Bevy's doing: a thousand at once are more than some systems allow, so bake so many ahead of time.
//!
//! All this is `AssetMode::Unprocessed`, Bevy's default; for the other one see [`processor`](super::processor).
//!
//! # Two traps of Bevy's
//! * A path is loaded once. Two loads of one path with different settings give one handle, with the settings of the first.
//!   To bake a mesh in two ways write two recipes.
//! * A `.meta` file that names this loader hides the mesh from every other loader, so its scene can no longer be shown.
//!   Write `.meta` files only for meshes that are for collision alone, and recipes for all others.
//!
//! A label is the business of the loader that registered the extension: `machine.glb#Mesh0` is never a collision mesh. To bake
//! one mesh of a glTF file, choose it in the recipe, `(mesh: "machine.glb", part: (mesh: "Gear"))`.
//!
//! Bevy matches extensions from the first dot on: `knot.v2.bake.ron` is loaded by type, or not at all.

use super::jobs::{on_bake_pool, on_compute_pool};
use crate::asset::collision_mesh::CollisionMesh;
use crate::asset::format::MAGIC;
use crate::asset::gltf::MeshPart;
use crate::asset::import::{ImportError, Imported, Source};
use crate::asset::recipe::{Recipe, RecipeError, is_recipe};
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CollisionMeshSettings {
    /// How to bake. Outranks the recipe; a `.faceoff` file that was baked otherwise is baked anew. Without it, the
    /// recipe or the file decides, and any other mesh is baked by the default settings.
    pub bake: Option<BakeSettings>,
    /// Which part of a glTF file to bake. Outranks the recipe; without it, the recipe decides, and else it is the whole scene.
    pub part: Option<MeshPart>,
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
    /// A path in a recipe or a glTF file leaves the asset folder.
    #[error("it names {0}, which is outside the asset folder; move that file into it")]
    OutsideFolder(AssetPath<'static>),
    /// The recipe's mesh, or a file that a glTF file needs, could not be read.
    #[error("it names {path}, which cannot be read: {source}")]
    ReadFile {
        /// The file.
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
        let part = settings.part.clone();
        // A recipe that was baked in place keeps its name.
        let mesh = if is_recipe(&name) && !bytes.starts_with(&MAGIC) {
            let recipe = Recipe::parse(&bytes)?;
            let mesh_path = mesh_path(&path, &recipe.mesh)?;
            let bytes = read_file(context, &mesh_path).await?;
            let wanted = Wanted {
                bake: wanted.or(Some(recipe.settings)),
                part: part.or(recipe.part),
            };
            load_mesh(context, &mesh_path, bytes, wanted)
                .await
                .map_err(|source| LoadError::InMesh {
                    path: mesh_path,
                    source: Box::new(source),
                })?
        } else {
            load_mesh(context, &path, bytes, Wanted { bake: wanted, part }).await?
        };
        // To find out where a mesh is open is no work for the IO pool either.
        let told = mesh.clone();
        for warning in on_compute_pool(move || Ok(told.warnings())).await? {
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

/// The asset path of a file that a mesh names. `file` is relative and has no detours.
fn path_beside(mesh: &AssetPath<'static>, file: &str) -> Result<AssetPath<'static>, LoadError> {
    let mut path = mesh.path().to_path_buf();
    path.pop();
    for part in file.split('/') {
        // A path that leads out of the folder keeps its dots, and is refused.
        if part != ".." || !path.pop() {
            path.push(part);
        }
    }
    let path = AssetPath::from_path_buf(path).with_source(mesh.source().clone_owned());
    if path.is_unapproved() {
        return Err(LoadError::OutsideFolder(path));
    }
    Ok(path)
}

/// Reads another file than the one that is loaded, which from then on depends on it.
async fn read_file(context: &mut LoadContext<'_>, path: &AssetPath<'static>) -> Result<Vec<u8>, LoadError> {
    context
        .read_asset_bytes(path)
        .await
        .map_err(|source| LoadError::ReadFile {
            path: path.clone(),
            source: Box::new(source),
        })
}

/// What the load or the recipe asks for.
struct Wanted {
    bake: Option<BakeSettings>,
    part: Option<MeshPart>,
}

/// Parses and bakes off the IO pool. Only the face table goes to the pool for bakes, which serves one table after the other:
/// a mesh without a table would wait there behind tables that take seconds.
async fn load_mesh(
    context: &mut LoadContext<'_>,
    path: &AssetPath<'static>,
    bytes: Vec<u8>,
    wanted: Wanted,
) -> Result<CollisionMesh, LoadError> {
    let name = path.path().to_string_lossy().into_owned();
    let source = on_compute_pool(move || Ok(Source::open(&name, bytes)?)).await?;
    let mut files = Vec::new();
    for file in source.files() {
        files.push(read_file(context, &path_beside(path, file)?).await?);
    }
    let (mesh, settings) = on_compute_pool(move || {
        Ok(match source.read(wanted.part.as_ref(), &files)? {
            Imported::Mesh { mesh, settings, .. } => {
                let settings = wanted.bake.unwrap_or(settings);
                (CollisionMesh::without_faces(&mesh, settings), settings)
            }
            Imported::Baked { mesh, .. } => {
                let settings = wanted.bake.unwrap_or(mesh.settings);
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

/// Registers the asset, its loader, and its [processor](super::processor) where Bevy processes assets. Returns whether that was possible: without Bevy's `AssetPlugin` it is not, and an
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
        super::processor::register(app);
    }
    true
}
