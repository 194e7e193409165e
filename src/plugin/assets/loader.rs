//! The asset loader of [`CollisionMesh`].
//!
//! Usually you load a bake recipe. The recipe `knot.bake.ron` names a mesh and the settings of its bake:
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
//! The loader registers the extensions `bake.ron` and `faceoff`. It does not register the extensions of other meshes:
//! for each extension Bevy uses the loader that was registered last, so `obj` or `glb` would no longer reach other
//! loaders. Load these files by the type of the handle, as above.
//!
//! Reading and baking do not run on Bevy's IO pool, so other assets load in the meantime. Both stop when the last
//! handle is dropped. Face tables are baked one after the other. Bevy keeps the file of a waiting load open, and a
//! thousand open files are more than some systems allow: bake so many tables ahead of time.
//!
//! A `.faceoff` file holds the hash of its source. If a recipe of the same name lies beside it, and what the recipe
//! names has changed since, a warning says so and the mesh is baked anew. Without a recipe there is only a warning, if
//! a mesh file of the same name is not the one that was baked. So keep the recipe beside the baked file while you work
//! on the mesh. A game that is shipped with baked files alone reads nothing else.
//!
//! This describes `AssetMode::Unprocessed`, Bevy's default. For `AssetMode::Processed` see
//! [`processor`](super::processor).
//!
//! # Pitfalls of Bevy's asset server
//! * A path is loaded once. Two loads of one path with different settings give one handle, with the settings of the
//!   first load. To bake a mesh in two ways, write two recipes.
//! * A `.meta` file that names this loader hides the mesh from all other loaders, so its scene can no longer be drawn.
//!   Write `.meta` files only for meshes that serve collisions alone, and recipes for all others.
//! * Bevy chooses the loader of a labelled path by its extension, so `machine.glb#Mesh0` is never a collision mesh. To
//!   bake one mesh or node of a glTF file, write a recipe: `(mesh: "machine.glb", part: (node: "Arm"))`.
//! * Other files that a mesh names are read from its own folder and those below. For one elsewhere write a recipe with
//!   `read_outside: true`; it must be in the asset folder all the same.
//! * Bevy takes everything after the first dot as the extension, so `knot.v2.bake.ron` loads only by type.

use super::error::LoadError;
use super::jobs::{on_bake_pool, on_compute_pool};
use super::stale;
use crate::asset::MeshPart;
use crate::asset::collision_mesh::CollisionMesh;
use crate::asset::format::{self, Header, MAGIC};
use crate::asset::import::{Imported, Source};
use crate::asset::recipe::{Recipe, is_recipe};
use crate::projection::BakeSettings;
use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AssetPath, LoadContext};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Loads `.faceoff` and `.bake.ron` files by extension, and other meshes by type; see the [module](self).
#[derive(Default, TypePath)]
pub struct CollisionMeshLoader;

/// Settings of a load, given in code or in a `.meta` file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CollisionMeshSettings {
    /// Settings of the bake. They override the recipe, and a `.faceoff` file with other settings is baked again. By
    /// default the recipe or the `.faceoff` file decides, and other meshes are baked with the default settings.
    pub bake: Option<BakeSettings>,
    /// Which part of the mesh file to bake. Overrides the recipe. By default the recipe decides, or the whole scene is
    /// baked.
    pub part: Option<MeshPart>,
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
        let bake = settings.bake;
        if let Some(settings) = &bake {
            settings.validate()?;
        }
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let path = context.path().clone();
        let name = path.path().to_string_lossy().into_owned();
        let part = settings.part.clone();
        let mut warnings = Vec::new();
        // A processed recipe keeps its name, but its content is a baked mesh.
        let mesh = if is_recipe(&name) && !bytes.starts_with(&MAGIC) {
            let recipe = Recipe::parse(&bytes)?;
            let mesh_path = mesh_path(&path, &recipe.mesh)?;
            let bytes = read_file(context, &mesh_path).await?;
            let settings = ImportSettings {
                bake: bake.or(Some(recipe.settings)),
                part: part.or(recipe.part),
                read_outside: recipe.read_outside,
            };
            load_mesh(context, &mesh_path, bytes, settings, &mut warnings)
                .await
                .map_err(|source| LoadError::InMesh {
                    path: mesh_path,
                    source: Box::new(source),
                })?
        } else {
            let header = format::read_header(&bytes).ok().filter(|_| part.is_none());
            let settings = ImportSettings {
                bake,
                part,
                read_outside: false,
            };
            let fresh = match header {
                Some(header) => load_fresh(context, &path, &header, bake, &mut warnings).await,
                None => None,
            };
            match fresh {
                Some(mesh) => mesh,
                None => load_mesh(context, &path, bytes, settings, &mut warnings).await?,
            }
        };
        // Warnings search the mesh for open edges, which takes too long for the IO pool.
        let checked = mesh.clone();
        warnings.extend(on_compute_pool(move || Ok(checked.warnings())).await?);
        for warning in warnings {
            tracing::warn!("{path}: {warning}");
        }
        Ok(mesh)
    }

    fn extensions(&self) -> &[&str] {
        &["faceoff", "bake.ron"]
    }
}

/// A fresh bake of a baked file that is older than its source. `None` if the baked file is good. Adds to `warnings`
/// what is wrong with the file.
async fn load_fresh(
    context: &mut LoadContext<'_>,
    path: &AssetPath<'static>,
    header: &Header,
    bake: Option<BakeSettings>,
    warnings: &mut Vec<String>,
) -> Option<CollisionMesh> {
    match stale::state(context, path, header.source_hash).await {
        stale::State::Fresh => None,
        stale::State::Other(source) => {
            warnings.push(format!(
                "it was not baked from {source} as that file is now. If that is its source, bake it again: `faceoff bake` \
                 with {source}. Else write a recipe beside it that names its source, or rename one of them"
            ));
            None
        }
        stale::State::Recipe {
            recipe_path,
            recipe,
            mesh_path,
            mesh,
        } => {
            // The options of a bake override the recipe, so the file's settings count.
            let settings = ImportSettings {
                bake: bake.or(Some(header.settings)),
                part: recipe.part,
                read_outside: recipe.read_outside,
            };
            let fresh = load_mesh(context, &mesh_path, mesh, settings, warnings).await;
            let fresh = fresh.map_err(|error| {
                warnings.push(format!(
                    "{mesh_path} has changed since this file was baked, but cannot be baked: {error}. The old mesh is used"
                ));
            });
            let fresh = fresh.ok()?;
            warnings.push(format!(
                "{mesh_path} has changed since this file was baked, so the mesh is baked anew at each start. Bake it once: \
                 `faceoff bake` with {recipe_path}"
            ));
            Some(fresh)
        }
    }
}

/// The asset path of a recipe's mesh.
pub(super) fn mesh_path(recipe: &AssetPath<'static>, mesh: &str) -> Result<AssetPath<'static>, LoadError> {
    let path = recipe.resolve_embed_str(mesh).map_err(|source| LoadError::MeshPath {
        path: mesh.into(),
        source,
    })?;
    // Bevy checks this for loads, but not when a loader reads bytes.
    if path.is_unapproved() {
        return Err(LoadError::OutsideFolder(path));
    }
    Ok(path)
}

/// The asset path of a file that a mesh refers to. `file` is relative and normalised.
pub(super) fn path_beside(mesh: &AssetPath<'static>, file: &str) -> Result<AssetPath<'static>, LoadError> {
    let mut path = mesh.path().to_path_buf();
    path.pop();
    for part in file.split('/') {
        // A path that leads out of the folder keeps its `..` and is rejected below.
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

/// Reads another file and makes it a dependency of the loaded one.
pub(super) async fn read_file(context: &mut LoadContext<'_>, path: &AssetPath<'static>) -> Result<Vec<u8>, LoadError> {
    context
        .read_asset_bytes(path)
        .await
        .map_err(|source| LoadError::ReadFile {
            path: path.clone(),
            source: Box::new(source),
        })
}

/// Settings of the load, or of the recipe.
struct ImportSettings {
    bake: Option<BakeSettings>,
    part: Option<MeshPart>,
    read_outside: bool,
}

/// Parses and bakes a mesh, not on the IO pool. Adds to `warnings` those about its file.
///
/// Only face tables are baked on the pool for bakes, one after the other. There a mesh without a table would wait for
/// tables that take seconds.
async fn load_mesh(
    context: &mut LoadContext<'_>,
    path: &AssetPath<'static>,
    bytes: Vec<u8>,
    options: ImportSettings,
    warnings: &mut Vec<String>,
) -> Result<CollisionMesh, LoadError> {
    let name = path.path().to_string_lossy().into_owned();
    let source = on_compute_pool(move || Ok(Source::open(&name, bytes)?)).await?;
    let mut files = Vec::new();
    for file in source.files(options.read_outside)? {
        files.push(read_file(context, &path_beside(path, file)?).await?);
    }
    let (mesh, settings, of_file) = on_compute_pool(move || {
        let imported = source.read(options.part.as_ref(), &files)?;
        let of_file = imported.warnings().to_vec();
        Ok(match imported {
            Imported::Mesh { mesh, settings, .. } => {
                let settings = options.bake.unwrap_or(settings);
                (CollisionMesh::without_faces(&mesh, settings), settings, of_file)
            }
            Imported::Baked { mesh, .. } => {
                let settings = options.bake.unwrap_or(mesh.settings);
                (mesh, settings, of_file)
            }
        })
    })
    .await?;
    warnings.extend(of_file);
    if mesh.settings == settings {
        return Ok(mesh);
    }
    on_bake_pool(move |pool, progress| Ok(mesh.rebake(settings, pool, progress)?)).await
}
