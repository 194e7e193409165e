//! Plugin groups: [`FaceoffPlugins`] for games, [`FaceoffHeadlessPlugins`] for tests, tools and servers.

use super::assets;
use super::character::CharacterPlugin;
use super::diagnostics::FaceoffDiagnosticsPlugin;
use super::queries::SpatialQueryPlugin;
use super::shapes::ShapePlugin;
use super::step_plugin::StepPlugin;
use bevy::app::PluginGroupBuilder;
use bevy::prelude::*;

/// All plugins of bevy_faceoff. Add them after `DefaultPlugins`, or after other plugins that contain Bevy's
/// `AssetPlugin`.
///
/// With the feature `bevy_render` the stages share the device of the app's renderer: see
/// [`backend`](crate::plugin::backend).
///
/// Plugins can be replaced or disabled as in any plugin group.
#[derive(Default)]
pub struct FaceoffPlugins {
    /// Backend and threads of the step.
    pub step: StepPlugin,
}

impl PluginGroup for FaceoffPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(CollisionMeshPlugin)
            .add(ShapePlugin)
            .add(self.step)
            .add(SpatialQueryPlugin)
            .add(CharacterPlugin)
            .add(FaceoffDiagnosticsPlugin);
        #[cfg(feature = "bevy_mesh")]
        let group = group.add(crate::plugin::mesh_collider_from::MeshColliderFromPlugin);
        #[cfg(feature = "bevy_gltf")]
        let group = group.add(crate::plugin::prefab::MeshColliderHierarchyPlugin);
        #[cfg(feature = "interpolation")]
        let group = group.add(crate::plugin::interpolation::InterpolationPlugin::default());
        group
    }
}

/// [`FaceoffPlugins`] with Bevy's `AssetPlugin`, for apps without a window or renderer. Add them after
/// `MinimalPlugins`.
///
/// Add Bevy's `LogPlugin` too. Without it you do not see why a body is rejected, or where the stages run. It is not
/// part of this group because a process has one logger, while a test process builds many apps.
#[derive(Default)]
pub struct FaceoffHeadlessPlugins {
    /// Backend and threads of the step.
    pub step: StepPlugin,
    /// The asset folder.
    pub assets: AssetPlugin,
}

impl PluginGroup for FaceoffHeadlessPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(self.assets)
            .add_group(FaceoffPlugins { step: self.step })
    }
}

/// Registers [`CollisionMesh`](crate::asset::CollisionMesh) and its loader.
///
/// # Panics
/// If Bevy's `AssetPlugin` was not added before. The message says what to add.
pub struct CollisionMeshPlugin;

impl Plugin for CollisionMeshPlugin {
    fn build(&self, app: &mut App) {
        assert!(
            app.is_plugin_added::<AssetPlugin>(),
            "FaceoffPlugins needs Bevy's AssetPlugin: add DefaultPlugins before FaceoffPlugins, \
             or use FaceoffHeadlessPlugins, which contains it"
        );
        assets::register(app);
    }
}
