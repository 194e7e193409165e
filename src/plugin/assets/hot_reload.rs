//! Hot reload of processed meshes: assets that were loaded before they were baked again are loaded again.
//!
//! Without the asset processor Bevy's asset server reloads meshes itself. In either case the bodies of a reloaded asset
//! get the new mesh when the next step collects them.

use crate::asset::CollisionMesh;
use async_channel::{Receiver, Sender};
use bevy::asset::processor::{AssetProcessor, ProcessorState};
use bevy::asset::{AssetPath, LoadState};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::block_on;
use bevy::tasks::futures_lite::future::poll_once;

/// Adds the system that reloads meshes, and returns the channel to which the processor sends the meshes that it baked.
pub(super) fn register(app: &mut App) -> Sender<(AssetPath<'static>, CollisionMesh)> {
    let (baked, news) = async_channel::unbounded();
    app.insert_resource(Baked {
        news,
        meshes: HashMap::default(),
    })
    .add_systems(PreUpdate, reload);
    baked
}

/// Meshes that were baked since the app started, and that the app may not have loaded yet.
#[derive(Resource)]
struct Baked {
    news: Receiver<(AssetPath<'static>, CollisionMesh)>,
    meshes: HashMap<AssetPath<'static>, CollisionMesh>,
}

/// Reloads assets that were loaded before they were baked again.
///
/// At startup these are recipes that name a changed file: Bevy checks the recipe first, finds it unchanged, and loads
/// the old mesh.
fn reload(
    mut baked: ResMut<Baked>,
    processor: Res<AssetProcessor>,
    server: Res<AssetServer>,
    loaded: Res<Assets<CollisionMesh>>,
) {
    let Baked { news, meshes } = &mut *baked;
    while let Ok((path, mesh)) = news.try_recv() {
        meshes.insert(path, mesh);
    }
    // Before that a load may fail to read a file that is being written. It may also deadlock in Bevy 0.19: a load locks
    // a file twice, and a bake in between waits for the first lock and blocks the second one.
    if block_on(poll_once(processor.get_state())) != Some(ProcessorState::Finished) {
        return;
    }
    meshes.retain(|path, mesh| {
        // Later loads get the new mesh.
        let Some(handle) = server.get_handle::<CollisionMesh>(path) else {
            return false;
        };
        match server.load_state(&handle) {
            LoadState::Loading => return true,
            LoadState::Loaded if loaded.get(&handle) == Some(mesh) => {}
            _ => {
                info!("{path} was baked again: the app uses the new mesh from now on");
                server.reload(path);
            }
        }
        false
    });
}
