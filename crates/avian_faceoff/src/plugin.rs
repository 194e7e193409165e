//! The plugins.

use crate::narrow_phase::ExactNarrowPhase;
use crate::{contacts::ExactContacts, joints, memory, meshes};
use avian3d::PhysicsPluginsWithHooks;
use avian3d::prelude::*;
use bevy::app::PluginGroupBuilder;
use bevy::asset::AssetLoadFailedEvent;
use bevy::ecs::system::SystemParamItem;
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::plugin::assets;

/// Adds exact meshes to Avian's plugins.
pub trait WithExactMeshes {
    /// Avian's plugins with a narrow phase that makes exact contacts between colliders with an
    /// [`ExactCollider`](crate::meshes::ExactCollider). All others keep Avian's contacts.
    fn with_exact_meshes(self) -> PluginGroupBuilder;
}

impl WithExactMeshes for PhysicsPlugins {
    fn with_exact_meshes(self) -> PluginGroupBuilder {
        exact::<()>(self.build())
    }
}

impl<H: CollisionHooks + 'static> WithExactMeshes for PhysicsPluginsWithHooks<H>
where
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    fn with_exact_meshes(self) -> PluginGroupBuilder {
        exact::<H>(self.build())
    }
}

fn exact<H: CollisionHooks + 'static>(plugins: PluginGroupBuilder) -> PluginGroupBuilder
where
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    plugins
        .disable::<NarrowPhasePlugin<Collider, H>>()
        .add(NarrowPhasePlugin::<ExactNarrowPhase, H>::default())
        .add(ExactMeshPlugin)
}

/// All but the narrow phase: components, assets, settings. [`WithExactMeshes`] adds it.
pub struct ExactMeshPlugin;

impl Plugin for ExactMeshPlugin {
    fn build(&self, app: &mut App) {
        if !assets::register(app) {
            // The error is logged. The app goes on without mesh files.
            app.init_resource::<Assets<CollisionMesh>>()
                .add_message::<AssetEvent<CollisionMesh>>()
                .add_message::<AssetLoadFailedEvent<CollisionMesh>>();
        }
        if let Err(error) = app.try_register_required_components::<Collider, ExactNarrowPhase>() {
            error!("add Avian's plugins before you spawn colliders: {error}");
        }
        app.init_resource::<ExactContacts>()
            .register_type::<ExactContacts>()
            .register_type::<ExactNarrowPhase>()
            .add_plugins((meshes::plugin, memory::plugin, joints::plugin));
    }
}
