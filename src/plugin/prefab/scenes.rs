//! Whether Bevy has spawned the scenes of a hierarchy.

use bevy::asset::{AssetLoadError, AssetPath, LoadState};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::world_serialization::{WorldInstance, WorldInstanceSpawner};
use std::sync::Arc;
use std::task::Poll;

/// Entities below which Bevy spawns scenes.
#[derive(SystemParam)]
pub(super) struct Scenes<'w, 's> {
    spawner: Option<Res<'w, WorldInstanceSpawner>>,
    server: Res<'w, AssetServer>,
    roots: Query<
        'w,
        's,
        (
            Option<&'static WorldAssetRoot>,
            Option<&'static DynamicWorldRoot>,
            Option<&'static WorldInstance>,
        ),
        Or<(With<WorldAssetRoot>, With<DynamicWorldRoot>)>,
    >,
}

impl Scenes<'_, '_> {
    /// Whether the scene of this entity is spawned, if it has one, or why it never will be.
    pub fn state(&self, entity: Entity) -> Poll<Result<(), Arc<AssetLoadError>>> {
        let Ok((world, dynamic, instance)) = self.roots.get(entity) else {
            return Poll::Ready(Ok(()));
        };
        let is_spawned = |instance: &WorldInstance| {
            let spawner = self.spawner.as_ref();
            spawner.is_some_and(|spawner| spawner.instance_is_ready(**instance))
        };
        if instance.is_some_and(is_spawned) {
            return Poll::Ready(Ok(()));
        }
        let state = match (world, dynamic) {
            // No scene will ever come.
            (Some(world), _) if world.0 == Handle::default() => return Poll::Ready(Ok(())),
            (Some(world), _) => self.server.load_state(&world.0),
            (None, Some(dynamic)) => self.server.load_state(&dynamic.0),
            (None, None) => LoadState::NotLoaded,
        };
        match state {
            LoadState::Failed(error) => Poll::Ready(Err(error)),
            _ => Poll::Pending,
        }
    }

    /// The file of the scene of this entity.
    pub fn file(&self, entity: Entity) -> Option<AssetPath<'static>> {
        let (world, dynamic, _) = self.roots.get(entity).ok()?;
        let world = world.and_then(|world| world.0.path());
        let path = world.or_else(|| dynamic.and_then(|dynamic| dynamic.0.path()))?;
        Some(path.without_label().into_owned())
    }
}
