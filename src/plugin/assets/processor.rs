//! Bakes recipes ahead of time, with Bevy's asset processor.
//!
//! Where `AssetPlugin::mode` is `AssetMode::Processed` and Bevy's feature `asset_processor` is on, every `.bake.ron` of the
//! asset folder is baked once, into the folder of imported assets. A baked recipe keeps its name, so programs go on to load
//! `knot.bake.ron`, which is then a `.faceoff` file by content. A released game, built without that feature, loads what was
//! imported. Nothing has to be set up: [`register`](super::register) knows whether there is a processor.
//!
//! Processed assets have one loader each, which Bevy chooses by extension. So only recipes and `.faceoff` files are collision
//! meshes there: a `.glb` or `.obj` file cannot be loaded as one, write a recipe that names it.
//!
//! Bevy bakes again what has changed: a recipe, a file that it names, the settings in its `.meta` file. It finds out while the
//! app runs, and hands out what was baked before until then; [`register`](super::register) sees to it that the app then goes on
//! with the new mesh. Bevy 0.19 sometimes never ends a load that it was asked for while it bakes the same file; loads that begin
//! once [`AssetProcessor::get_state`] is `Finished` are safe from that, and get the new mesh at once. Of a newer version of
//! this library it knows nothing, so the version is one of the settings. A recipe without `.meta` file always has that of
//! the running build and is baked again after an update; in a `.meta` file, write the version and raise it yourself:
//!
//! ```ron
//! (
//!     meta_format_version: "1.0",
//!     asset: Process(
//!         processor: "bevy_faceoff::plugin::assets::processor::CollisionMeshProcessor",
//!         settings: (baker_version: 2, bake: Some((faces: true)), part: None),
//!     ),
//! )
//! ```

use super::jobs::on_compute_pool;
use super::loader::{CollisionMeshLoader, CollisionMeshSettings};
use crate::asset::collision_mesh::CollisionMesh;
use crate::asset::format::{self, BAKER_VERSION};
use crate::asset::gltf::MeshPart;
use crate::projection::BakeSettings;
use async_channel::{Receiver, Sender};
use bevy::asset::io::{AssetWriterError, Writer};
use bevy::asset::processor::{AssetProcessor, Process, ProcessContext, ProcessError, ProcessorState};
use bevy::asset::{AssetLoadError, AssetLoadFailedEvent, AssetPath, AssetServerMode, AsyncWriteExt, LoadState};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::block_on;
use bevy::tasks::futures_lite::future::poll_once;
use serde::{Deserialize, Serialize};

/// Turns `.bake.ron` files into baked ones; see the [module](self).
#[derive(TypePath)]
pub struct CollisionMeshProcessor {
    /// Where the app learns of what is baked.
    baked: Sender<(AssetPath<'static>, CollisionMesh)>,
}

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
        // Nobody listens once the app ends.
        let _ = self.baked.try_send((path.clone(), mesh.clone()));
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

/// Makes Bevy's asset processor, if there is one, bake recipes, and the app go on with what it bakes.
pub(super) fn register(app: &mut App) {
    if app.world().contains_resource::<AssetProcessor>() {
        let (baked, news) = async_channel::unbounded();
        app.register_asset_processor(CollisionMeshProcessor { baked })
            .set_default_asset_processor::<CollisionMeshProcessor>("bake.ron")
            .insert_resource(Baked {
                news,
                meshes: HashMap::default(),
            })
            .add_systems(PreUpdate, swap_in);
    }
    if app.world().resource::<AssetServer>().mode() == AssetServerMode::Processed {
        app.add_systems(PreUpdate, explain);
    }
}

/// What was baked since the app began, until it is known whether the app has it.
#[derive(Resource)]
struct Baked {
    news: Receiver<(AssetPath<'static>, CollisionMesh)>,
    meshes: HashMap<AssetPath<'static>, CollisionMesh>,
}

/// Loads again what was loaded before it was baked. At the start that is what a recipe names and somebody has changed: Bevy
/// looks at the recipe first, finds it as it was, and hands out what was baked before.
fn swap_in(
    mut baked: ResMut<Baked>,
    processor: Res<AssetProcessor>,
    server: Res<AssetServer>,
    loaded: Res<Assets<CollisionMesh>>,
) {
    let Baked { news, meshes } = &mut *baked;
    while let Ok((path, mesh)) = news.try_recv() {
        meshes.insert(path, mesh);
    }
    // Until then it may fail to read what is being written, and Bevy 0.19 may wait for itself: a load locks a file twice, and a
    // bake that comes between the two waits for the first lock and holds the second one up.
    if block_on(poll_once(processor.get_state())) != Some(ProcessorState::Finished) {
        return;
    }
    meshes.retain(|path, mesh| {
        // Who asks for it from now on gets the new one.
        let Some(handle) = server.get_handle::<CollisionMesh>(path) else {
            return false;
        };
        match server.load_state(&handle) {
            LoadState::Loading => return true,
            LoadState::Loaded if loaded.get(&handle) == Some(mesh) => {}
            _ => {
                info!("{path} was baked again: the app goes on with the new mesh");
                server.reload(path);
            }
        }
        false
    });
}

/// Says what to do where Bevy says that a mesh is configured to be ignored, though nobody has configured it.
fn explain(mut failures: MessageReader<AssetLoadFailedEvent<CollisionMesh>>) {
    for failure in failures.read() {
        if matches!(failure.error, AssetLoadError::CannotLoadIgnoredAsset { .. }) {
            let path = &failure.path;
            let name = path.path().file_name().unwrap_or_default();
            error!(
                "{path}: processed assets are collision meshes through recipes only; write a recipe beside it, a file with an \
                 ending .bake.ron that reads (mesh: {name:?}), and load that"
            );
        }
    }
}
