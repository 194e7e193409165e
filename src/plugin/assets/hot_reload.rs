//! Hot reload of processed meshes: assets that were loaded before they were baked again are loaded again.
//!
//! Without the asset processor Bevy's asset server reloads meshes itself. In either case the bodies of a reloaded asset
//! get the new mesh when the next step collects them.

use crate::asset::CollisionMesh;
use crate::projection::BakeSettings;
use async_channel::{Receiver, Sender};
use bevy::asset::processor::{AssetProcessor, ProcessorState};
use bevy::asset::{AssetPath, LoadState};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::block_on;
use bevy::tasks::futures_lite::future::poll_once;

/// Adds the system that reloads meshes, and returns the channel to which the processor sends the meshes that it baked.
pub(super) fn register(app: &mut App) -> Sender<(AssetPath<'static>, Bake)> {
    let (baked, news) = async_channel::unbounded();
    app.insert_resource(Baked {
        news,
        bakes: HashMap::default(),
    })
    .add_systems(PreUpdate, reload);
    baked
}

/// What tells a bake from others. Thousands of these may wait until all is processed, so they hold no mesh.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Bake {
    /// Fingerprint of the surface and its mass.
    fingerprint: u64,
    /// The settings, which decide all else, such as the face table.
    settings: BakeSettings,
}

impl Bake {
    pub(super) fn of(mesh: &CollisionMesh) -> Self {
        Self {
            fingerprint: mesh.fingerprint(),
            settings: mesh.settings,
        }
    }
}

/// What was baked since the app started, and what the app may not have loaded yet.
#[derive(Resource)]
struct Baked {
    news: Receiver<(AssetPath<'static>, Bake)>,
    bakes: HashMap<AssetPath<'static>, Bake>,
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
    let Baked { news, bakes } = &mut *baked;
    while let Ok((path, bake)) = news.try_recv() {
        bakes.insert(path, bake);
    }
    // Before that a load may fail to read a file that is being written. It may also deadlock in Bevy 0.19: a load locks
    // a file twice, and a bake in between waits for the first lock and blocks the second one.
    if block_on(poll_once(processor.get_state())) != Some(ProcessorState::Finished) {
        return;
    }
    bakes.retain(|path, bake| {
        // Later loads get the new mesh.
        let Some(handle) = server.get_handle::<CollisionMesh>(path) else {
            return false;
        };
        match server.load_state(&handle) {
            LoadState::Loading => return true,
            LoadState::Loaded if loaded.get(&handle).map(Bake::of) == Some(*bake) => {}
            _ => {
                info!("{path} was baked again: the app uses the new mesh from now on");
                server.reload(path);
            }
        }
        false
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;

    /// What waits for the processor to finish takes as much memory for a mesh of a million triangles as for a cube.
    #[test]
    fn what_waits_is_small_and_tells_bakes_apart() {
        assert!(size_of::<Bake>() <= 64 && !std::mem::needs_drop::<Bake>());
        let cube = CollisionMesh::new(&shapes::cube(1.0));
        let again = CollisionMesh::new(&shapes::cube(1.0));
        assert!(Bake::of(&cube) == Bake::of(&again) && !cube.is_same(&again));
        assert!(Bake::of(&cube) != Bake::of(&CollisionMesh::new(&shapes::cube(1.1))));
        let (pool, progress) = (crate::projection::bake_pool(), crate::projection::Progress::default());
        let with_table = BakeSettings {
            faces: true,
            degrees: 90,
            image: 16,
            ..cube.settings
        };
        let with_table = cube.rebake(with_table, pool, &progress).unwrap();
        assert!(Bake::of(&cube) != Bake::of(&with_table));
    }
}
