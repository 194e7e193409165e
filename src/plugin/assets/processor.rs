//! The asset processor, which bakes recipes ahead of time.
//!
//! If `AssetPlugin::mode` is `AssetMode::Processed` and Bevy's feature `asset_processor` is on, every `.bake.ron` file
//! of the asset folder is baked once, into the folder of imported assets. A baked recipe keeps its name: programs still
//! load `knot.bake.ron`, which then has the content of a `.faceoff` file. A released game, built without that feature,
//! loads the imported files. No setup is needed: [`register`](super::register) registers the processor if there is one.
//!
//! A processed asset has one loader, which Bevy chooses by extension. So only recipes and `.faceoff` files can be
//! loaded as collision meshes in this mode. For a `.glb` or `.obj` file write a recipe that names it.
//!
//! Bevy bakes again when a recipe, a file that it names, or its `.meta` file changes. It checks this while the app
//! runs, and loads the old mesh until the new one is baked. Then the app's mesh is replaced. Bevy 0.19 sometimes never
//! finishes a load that begins while the same file is baked. Loads that begin once [`AssetProcessor::get_state`] is
//! `Finished` do not have this problem, and get the new mesh at once.
//!
//! Bevy does not notice a new version of this library, so the version is one of the settings. A recipe without a
//! `.meta` file has the version of the running build and is baked again after an update. In a `.meta` file write the
//! version, and raise it yourself:
//!
//! ```ron
//! (
//!     meta_format_version: "1.0",
//!     asset: Process(
//!         processor: "bevy_faceoff::plugin::assets::processor::CollisionMeshProcessor",
//!         settings: (baker_version: 3, bake: Some((faces: true)), part: None),
//!     ),
//! )
//! ```

use super::hot_reload::{self, Bake};
use super::jobs::on_compute_pool;
use super::loader::{CollisionMeshLoader, CollisionMeshSettings};
use crate::asset::MeshPart;
use crate::asset::collision_mesh::CollisionMesh;
use crate::asset::format::{self, BAKER_VERSION};
use crate::projection::BakeSettings;
use async_channel::Sender;
use bevy::asset::io::{AssetWriterError, Writer};
use bevy::asset::processor::{AssetProcessor, Process, ProcessContext, ProcessError};
use bevy::asset::{AssetLoadError, AssetLoadFailedEvent, AssetPath, AssetServerMode, AsyncWriteExt};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Bakes `.bake.ron` files; see the [module](self).
#[derive(TypePath)]
pub struct CollisionMeshProcessor {
    /// Reports bakes to the app.
    baked: Sender<(AssetPath<'static>, Bake)>,
}

/// Settings for processing a recipe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProcessorSettings {
    /// Makes Bevy bake again when it changes. It has no other effect. Default [`BAKER_VERSION`].
    pub baker_version: u32,
    /// Settings of the bake. Overrides the recipe.
    pub bake: Option<BakeSettings>,
    /// Which part of the mesh file to bake. Overrides the recipe.
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
        // Loads the recipe instead of reading it, so that Bevy records the files that it names as dependencies.
        let mesh = context
            .load_source_asset::<CollisionMeshLoader>(&settings)
            .await?
            .take::<CollisionMesh>()
            .ok_or(ProcessError::WrongMetaType)?;
        let path = context.path().clone();
        // The receiver is gone when the app has ended.
        let _ = self.baked.try_send((path.clone(), Bake::of(&mesh)));
        let failed = |error: std::io::Error| ProcessError::AssetWriterError {
            path,
            err: AssetWriterError::Io(error),
        };
        // Bevy tracks whether the file is up to date, so it needs no hash of its source.
        match on_compute_pool(move || Ok(format::to_bytes(&mesh, format::Hash::default()))).await {
            Ok(bytes) => writer.write_all(&bytes).await.map_err(failed)?,
            Err(error) => return Err(failed(std::io::Error::other(error))),
        }
        // The baked file contains all settings.
        Ok(CollisionMeshSettings::default())
    }
}

/// Registers the processor with Bevy's asset processor, if there is one.
pub(super) fn register(app: &mut App) {
    if app.world().contains_resource::<AssetProcessor>() {
        let baked = hot_reload::register(app);
        app.register_asset_processor(CollisionMeshProcessor { baked })
            .set_default_asset_processor::<CollisionMeshProcessor>("bake.ron");
    }
    if app.world().resource::<AssetServer>().mode() == AssetServerMode::Processed {
        app.add_systems(PreUpdate, explain);
    }
}

/// Explains Bevy's error that a mesh is configured to be ignored, which it logs although the user did not configure
/// that.
fn explain(mut failures: MessageReader<AssetLoadFailedEvent<CollisionMesh>>) {
    for failure in failures.read() {
        if matches!(failure.error, AssetLoadError::CannotLoadIgnoredAsset { .. }) {
            let path = &failure.path;
            let name = path.path().file_name().unwrap_or_default();
            error!(
                "{path}: with processed assets only recipes load as collision meshes; write a recipe beside it, a file \
                 with the extension .bake.ron and the content (mesh: {name:?}), and load that file"
            );
        }
    }
}
