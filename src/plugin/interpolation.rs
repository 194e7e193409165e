//! Motion that looks smooth although frames and steps have different rates: the crate `bevy_transform_interpolation`, with
//! what it must know of this plugin. Needs the feature `interpolation`.
//!
//! Steps run at a fixed rate, 64 times a second by default; frames are drawn at another. Without interpolation a body that
//! flies straight is drawn up to twice at one place, and then jumps. With it, `Transform` is between the poses before and
//! after the last step in every frame, so bodies are drawn up to one step late. Before each step it is exact again.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! # fn spawn(mut commands: Commands, torus: MeshCollider) {
//! commands.spawn((RigidBody::Dynamic, torus, TransformInterpolation));
//! # }
//! ```
//!
//! All bodies at once:
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_faceoff::prelude::*;
//!
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, AssetPlugin::default()));
//! app.add_plugins(FaceoffPlugins::default().set(InterpolationPlugin::interpolate_all()));
//! ```
//!
//! * **Jumps.** A body that is placed with [`Teleport`], or whose `Transform` a system outside of fixed time writes, appears at
//!   its new place at once.
//! * **What systems read.** In `FixedUpdate` a `Transform` is the pose after the last step. In `Update` it is the one that is
//!   drawn; questions through [`SpatialQuery`](crate::plugin::queries::SpatialQuery) are about the poses after the last
//!   step, unless [`update_spatial_queries`](crate::plugin::queries::update_spatial_queries) runs there.
//! * **A GPU.** With `Readback::Lockstep` and `Readback::Latent` as on the CPU. With `Readback::Resident` components do not
//!   follow the bodies. Blend the poses before and after the last step where you draw: `plugin::poses` has them, and
//!   `plugin::Poses::WGSL` the functions.
//! * **Bodies under other entities.** Their `Transform` is interpolated relative to the parent.

use crate::plugin::components::Teleport;
use crate::plugin::schedule::{FaceoffStep, FaceoffSystems};
use crate::plugin::sync::publish;
use crate::types::body::RigidBody;
use bevy::prelude::*;
use bevy_transform_interpolation::{TransformEasingSystems, reset_easing_states_on_transform_change};

pub use bevy_transform_interpolation::{
    NoRotationEasing, NoScaleEasing, NoTransformEasing, NoTranslationEasing, RotationEasingState, ScaleEasingState,
    TranslationEasingState,
    interpolation::{
        RotationInterpolation, ScaleInterpolation, TransformInterpolation, TransformInterpolationPlugin,
        TranslationInterpolation,
    },
};

/// Interpolates bodies that have a [`TransformInterpolation`]. [`FaceoffPlugins`](crate::plugin::FaceoffPlugins) contain it.
#[derive(Debug, Default)]
pub struct InterpolationPlugin {
    /// Whether every entity with a [`RigidBody`] gets a [`TransformInterpolation`]. A [`NoTransformEasing`] switches it off
    /// for an entity. Default false.
    pub interpolate_all: bool,
}

impl InterpolationPlugin {
    /// Interpolates all bodies.
    pub const fn interpolate_all() -> Self {
        Self { interpolate_all: true }
    }
}

impl Plugin for InterpolationPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<TransformInterpolationPlugin>() {
            app.add_plugins(TransformInterpolationPlugin::default());
        }
        if self.interpolate_all {
            app.register_required_components::<RigidBody, TransformInterpolation>();
        }
        app.register_type::<TransformInterpolation>()
            .register_type::<NoTransformEasing>();
        let keep = publish::keep_poses.after(publish::write_back);
        app.register_required_components::<TransformInterpolation, publish::PoseOfStep>();
        app.add_systems(FaceoffStep, show_teleports_at_once.in_set(FaceoffSystems::Collect))
            .add_systems(FaceoffStep, keep.in_set(FaceoffSystems::Publish).ambiguous_with_all())
            .configure_sets(
                RunFixedMainLoop,
                (
                    // What systems of `Update` wrote is recognised before the next step, which else would show the end of
                    // the last one again.
                    RunFixedMainLoopSystems::FixedMainLoop.after(reset_easing_states_on_transform_change),
                    // What is published between two steps is not interpolated.
                    FaceoffStep.after(TransformEasingSystems::UpdateEasingTick),
                ),
            );
    }
}

/// Forgets from where teleported bodies came. Nothing is interpolated without a start.
fn show_teleports_at_once(
    mut teleported: Query<
        (
            Option<&mut TranslationEasingState>,
            Option<&mut RotationEasingState>,
            Option<&mut ScaleEasingState>,
        ),
        With<Teleport>,
    >,
) {
    for (translation, rotation, scale) in &mut teleported {
        if let Some(mut translation) = translation {
            translation.start = None;
        }
        if let Some(mut rotation) = rotation {
            rotation.start = None;
        }
        if let Some(mut scale) = scale {
            scale.start = None;
        }
    }
}
