//! Bakes recipes ahead of time, with Bevy's asset processor.
//!
//! Where `AssetPlugin::mode` is `AssetMode::Processed` and Bevy's feature `asset_processor` is on, every `.bake.ron` of the
//! asset folder is baked once, into the folder of imported assets. A baked recipe keeps its name, so programs go on to load
//! `knot.bake.ron`, which is then a `.faceoff` file by content. A released game, built without that feature, loads what was
//! imported. Nothing has to be set up: [`register`](super::register) knows whether there is a processor.
//!
//! Bevy bakes again what has changed: a recipe, a file that it names, the settings in its `.meta` file. Of a newer version of
//! this library it knows nothing, so the version is one of the settings. A recipe without `.meta` file always has that of
//! the running build and is baked again after an update; in a `.meta` file, write the version and raise it yourself:
//!
//! ```ron
//! (
//!     meta_format_version: "1.0",
//!     asset: Process(
//!         processor: "bevy_faceoff::asset::processor::CollisionMeshProcessor",
//!         settings: (baker_version: 2, bake: Some((faces: true)), part: None),
//!     ),
//! )
//! ```

use super::collision_mesh::CollisionMesh;
use super::format::{self, BAKER_VERSION};
use super::gltf::MeshPart;
use super::jobs::on_compute_pool;
use super::loader::{CollisionMeshLoader, CollisionMeshSettings};
use crate::projection::BakeSettings;
use bevy::asset::AsyncWriteExt;
use bevy::asset::io::{AssetWriterError, Writer};
use bevy::asset::processor::{AssetProcessor, Process, ProcessContext, ProcessError};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Turns `.bake.ron` files into baked ones; see the [module](self).
#[derive(Default, TypePath)]
pub struct CollisionMeshProcessor;

/// How to process one recipe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProcessorSettings {
    /// Has no effect but to make Bevy bake again when it changes.
    pub baker_version: u32,
    /// How to bake. Outranks the recipe.
    pub bake: Option<BakeSettings>,
    /// Which part of a glTF file to bake. Outranks the recipe.
    pub part: Option<MeshPart>,
}

impl Default for ProcessorSettings {
    fn default() -> Self {
        Self {
            baker_version: BAKER_VERSION,
            bake: None,
            part: None,
        }
    }
}

impl Process for CollisionMeshProcessor {
    type Settings = ProcessorSettings;
    type OutputLoader = CollisionMeshLoader;

    async fn process(
        &self,
        context: &mut ProcessContext<'_>,
        settings: &ProcessorSettings,
        writer: &mut Writer,
    ) -> Result<CollisionMeshSettings, ProcessError> {
        let settings = CollisionMeshSettings {
            bake: settings.bake,
            part: settings.part.clone(),
        };
        // Loading, not reading: it notes the files that the recipe names as dependencies.
        let mesh = context
            .load_source_asset::<CollisionMeshLoader>(&settings)
            .await?
            .take::<CollisionMesh>()
            .ok_or(ProcessError::WrongMetaType)?;
        let path = context.path().clone();
        let failed = |error: std::io::Error| ProcessError::AssetWriterError {
            path,
            err: AssetWriterError::Io(error),
        };
        // Whether the file is up to date is Bevy's business, so that no hash of its source is needed.
        match on_compute_pool(move || Ok(format::to_bytes(&mesh, format::Hash::default()))).await {
            Ok(bytes) => writer.write_all(&bytes).await.map_err(failed)?,
            Err(error) => return Err(failed(std::io::Error::other(error))),
        }
        // All settings are in the file itself.
        Ok(CollisionMeshSettings::default())
    }
}

/// Makes Bevy's asset processor, if there is one, bake recipes.
pub(super) fn register(app: &mut App) {
    if app.world().contains_resource::<AssetProcessor>() {
        app.register_asset_processor(CollisionMeshProcessor)
            .set_default_asset_processor::<CollisionMeshProcessor>("bake.ron");
    }
}
