//! The plugin groups of a game and of a headless app.

use super::assets;
use super::diagnostics::FaceoffDiagnosticsPlugin;
use super::step_plugin::StepPlugin;
use bevy::app::PluginGroupBuilder;
use bevy::prelude::*;

/// Everything of bevy_faceoff, to be added after `DefaultPlugins` or whatever else brings Bevy's `AssetPlugin`.
///
/// With the feature `bevy_render` the stages share the device of the app's renderer: see [`backend`](crate::plugin::backend).
///
/// Parts can be replaced or disabled like those of any plugin group.
#[derive(Default)]
pub struct FaceoffPlugins {
    /// How the step runs.
    pub step: StepPlugin,
}

impl PluginGroup for FaceoffPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(CollisionMeshPlugin)
            .add(self.step)
            .add(FaceoffDiagnosticsPlugin);
        #[cfg(feature = "bevy_mesh")]
        let group = group.add(crate::plugin::mesh_collider_from::MeshColliderFromPlugin);
        group
    }
}

/// [`FaceoffPlugins`] and `AssetPlugin`, to be added after `MinimalPlugins`: no window, no renderer, no GPU needed.
///
/// Add Bevy's `LogPlugin` too: without it nobody hears why a body is left out, or where the stages run. It is not part of this
/// group since a process has one log, and tests build many apps.
#[derive(Default)]
pub struct FaceoffHeadlessPlugins {
    /// How the step runs.
    pub step: StepPlugin,
    /// Where assets lie.
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
/// When it is added without Bevy's `AssetPlugin` before it; the message says what to add.
pub struct CollisionMeshPlugin;

impl Plugin for CollisionMeshPlugin {
    fn build(&self, app: &mut App) {
        assert!(
            app.is_plugin_added::<AssetPlugin>(),
            "FaceoffPlugins needs Bevy's AssetPlugin: add DefaultPlugins before FaceoffPlugins, \
             or use FaceoffHeadlessPlugins, which brings it"
        );
        assets::register(app);
    }
}
