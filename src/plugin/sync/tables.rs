//! Face tables that are baked while the simulation runs, for bodies that need one and whose mesh has none.

use crate::asset::CollisionMesh;
use crate::plugin::assets::LoadError;
use crate::plugin::assets::jobs::on_bake_pool;
use crate::projection::BakeSettings;
use bevy::platform::cell::SyncCell;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::futures::check_ready;
use bevy::tasks::futures_lite::future::Boxed;

/// One entry for each mesh without a table.
#[derive(Default)]
pub(crate) struct Tables(HashMap<AssetId<CollisionMesh>, Entry>);

struct Entry {
    /// The name of the mesh in the log.
    name: String,
    /// The asset when it was requested. After a hot reload the asset with the same id is another mesh.
    source: CollisionMesh,
    state: State,
}

enum State {
    /// Dropping it cancels the bake.
    Baking(SyncCell<Boxed<Result<CollisionMesh, LoadError>>>),
    /// The source with its table.
    Baked(CollisionMesh),
    Failed,
}

impl Tables {
    /// Starts to bake a table for `mesh` and logs it, unless that was done before.
    pub fn request(&mut self, id: AssetId<CollisionMesh>, mesh: &CollisionMesh, name: impl FnOnce() -> String) {
        if self.0.get(&id).is_some_and(|entry| entry.source.is_same(mesh)) {
            return;
        }
        let name = name();
        warn!(
            "the mesh {name} has no face table; one is baked in the background, and until it is ready \
             its bodies use Culling::Exact. To have it from the start, set `faces: true` in the mesh's BakeSettings"
        );
        let settings = BakeSettings {
            faces: true,
            ..mesh.settings
        };
        let source = mesh.clone();
        let bake = on_bake_pool(move |pool, progress| Ok(source.rebake(settings, pool, progress)?));
        let mut entry = Entry {
            name,
            source: mesh.clone(),
            state: State::Baking(SyncCell::new(Box::pin(bake))),
        };
        // The bake starts when the future is polled first.
        entry.poll();
        self.0.insert(id, entry);
    }

    /// Stores finished tables. It does not wait.
    pub fn poll(&mut self) {
        self.0.values_mut().for_each(Entry::poll);
    }

    /// `mesh` with its table if that was baked here, else unchanged.
    pub fn best<'a>(&'a self, id: AssetId<CollisionMesh>, mesh: &'a CollisionMesh) -> &'a CollisionMesh {
        match self.0.get(&id) {
            Some(Entry {
                source,
                state: State::Baked(baked),
                ..
            }) if source.is_same(mesh) => baked,
            _ => mesh,
        }
    }

    /// Number of running bakes.
    pub fn in_bake(&self) -> usize {
        let baking = |entry: &&Entry| matches!(entry.state, State::Baking(_));
        self.0.values().filter(baking).count()
    }

    /// Drops the tables, baked or not, of meshes that no longer exist.
    pub fn retain(&mut self, keep: impl Fn(AssetId<CollisionMesh>) -> bool) {
        self.0.retain(|&id, _| keep(id));
    }
}

impl Entry {
    fn poll(&mut self) {
        let State::Baking(bake) = &mut self.state else {
            return;
        };
        match check_ready(bake.get()) {
            Some(Ok(mesh)) => {
                info!("the face table of the mesh {} is baked", self.name);
                self.state = State::Baked(mesh);
            }
            Some(Err(error)) => {
                error!(
                    "the mesh {} continues with Culling::Exact: its face table could not be baked: \
                     {error}",
                    self.name
                );
                self.state = State::Failed;
            }
            None => {}
        }
    }
}
