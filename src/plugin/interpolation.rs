//! Motion that looks smooth although frames and steps have different rates: the crate `bevy_transform_interpolation`,
//! with what it must know of this plugin. Needs the feature `interpolation`.
//!
//! Steps run at a fixed rate, 64 times a second by default; frames are drawn at another. Without interpolation a body
//! that flies straight is drawn up to twice at one place, and then jumps. With it, `Transform` is between the poses
//! before and after the last step in every frame, so bodies are drawn up to one step late. Before each step it is exact
//! again.
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
//! * **Jumps.** A body that is placed with [`Teleport`], that gets another parent, or whose `Transform` a system
//!   outside of fixed time writes, appears at its new place at once. Without a `Teleport` it moves smoothly to where a
//!   system of fixed time, for example of `FixedLast`, puts it. Translation, rotation and scale count by themselves: a
//!   body that a system of `Update` turns in every frame flies on smoothly.
//! * **What systems read.** In `FixedUpdate` a `Transform` is the pose after the last step. In `Update` it is the one
//!   that is drawn; questions through [`SpatialQuery`](crate::plugin::queries::SpatialQuery) are about the poses after
//!   the last step, unless [`update_spatial_queries`](crate::plugin::queries::update_spatial_queries) runs there.
//! * **A GPU.** With `Readback::Lockstep` and `Readback::Latent` as on the CPU. With `Readback::Resident` components do
//!   not follow the bodies. Blend the poses before and after the last step where you draw: `plugin::poses` has them,
//!   `plugin::drawn_part` tells at which part of the way, and `plugin::Poses::WGSL` has the functions.
//! * **Bodies under other entities.** Their `Transform` is interpolated relative to the parent.

use crate::plugin::components::Teleport;
use crate::plugin::schedule::{FaceoffStep, FaceoffSystems};
use crate::plugin::sync::publish;
use crate::types::body::RigidBody;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use bevy_transform_interpolation::TransformEasingSystems;

pub use bevy_transform_interpolation::{
    NoRotationEasing, NoScaleEasing, NoTransformEasing, NoTranslationEasing, RotationEasingState, ScaleEasingState,
    TranslationEasingState,
    interpolation::{
        RotationInterpolation, ScaleInterpolation, TransformInterpolation, TransformInterpolationPlugin,
        TranslationInterpolation,
    },
};

/// Interpolates bodies that have a [`TransformInterpolation`]. [`FaceoffPlugins`](crate::plugin::FaceoffPlugins)
/// contain it.
#[derive(Debug, Default)]
pub struct InterpolationPlugin {
    /// Whether every entity with a [`RigidBody`] gets a [`TransformInterpolation`]. A [`NoTransformEasing`] switches it
    /// off for an entity. Default false.
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
        require_for::<TranslationInterpolation>(app);
        require_for::<RotationInterpolation>(app);
        require_for::<ScaleInterpolation>(app);
        let keep = publish::keep_poses.after(publish::write_back);
        let before_steps = leave_drawn
            .after(RunFixedMainLoopSystems::BeforeFixedMainLoop)
            .before(RunFixedMainLoopSystems::FixedMainLoop);
        let set_ends = (show_teleports_at_once, show_reparented_at_once, set_ends)
            .chain()
            .before(TransformEasingSystems::Ease);
        let keep_drawn = keep_drawn
            .after(TransformEasingSystems::Ease)
            .before(TransformEasingSystems::UpdateEasingTick);
        let after_steps = (set_ends, keep_drawn).in_set(RunFixedMainLoopSystems::AfterFixedMainLoop);
        app.add_systems(FaceoffStep, show_teleports_at_once.in_set(FaceoffSystems::Collect))
            .add_systems(FaceoffStep, keep.in_set(FaceoffSystems::Publish).ambiguous_with_all())
            .add_systems(RunFixedMainLoop, (before_steps, after_steps))
            // Some games run fixed time by hand.
            .add_systems(FixedFirst, leave_drawn.before(TransformEasingSystems::Reset))
            .add_systems(FixedLast, forget_ends.after(TransformEasingSystems::UpdateEnd))
            // What is published between two steps is not interpolated.
            .configure_sets(
                RunFixedMainLoop,
                FaceoffStep.after(TransformEasingSystems::UpdateEasingTick),
            );
    }
}

/// Requires what this plugin keeps of an interpolated body.
fn require_for<Interpolation: Component>(app: &mut App) {
    app.register_required_components::<Interpolation, publish::PoseOfStep>()
        .register_required_components::<Interpolation, Drawn>();
}

/// What is drawn in place of the exact `Transform`. `None` while the component is exact.
#[derive(Component, Default)]
struct Drawn(Option<Blend>);

struct Blend {
    drawn: Transform,
    exact: Transform,
}

/// From where to where a body is interpolated. It has ends only while they are blended: otherwise the next step would
/// begin there, although others may have written the `Transform` since.
#[derive(QueryData)]
#[query_data(mutable)]
struct Easing {
    translation: Option<&'static mut TranslationEasingState>,
    rotation: Option<&'static mut RotationEasingState>,
    scale: Option<&'static mut ScaleEasingState>,
}

impl EasingItem<'_, '_> {
    /// Nothing is interpolated without a start.
    fn forget_start(&mut self) {
        self.forget_start_of([true; 3]);
    }

    /// Forgets the start of translation, rotation and scale.
    fn forget_start_of(&mut self, [translation, rotation, scale]: [bool; 3]) {
        if let Some(state) = self.translation.as_mut().filter(|_| translation) {
            state.start = None;
        }
        if let Some(state) = self.rotation.as_mut().filter(|_| rotation) {
            state.start = None;
        }
        if let Some(state) = self.scale.as_mut().filter(|_| scale) {
            state.start = None;
        }
    }

    fn set_end(&mut self, end: Option<Transform>) {
        if let Some(state) = &mut self.translation {
            state.end = end.map(|end| end.translation);
        }
        if let Some(state) = &mut self.rotation {
            state.end = end.map(|end| end.rotation);
        }
        if let Some(state) = &mut self.scale {
            state.end = end.map(|end| end.scale);
        }
    }
}

fn leave_drawn(mut bodies: Query<(&mut Transform, &mut Drawn, Easing)>) {
    for (transform, drawn, mut easing) in &mut bodies {
        leave(transform, drawn, &mut easing);
    }
}

/// Makes each part of a `Transform` exact that is as it was drawn. The others were written since: these appear at once.
fn leave(mut transform: Mut<Transform>, mut drawn: Mut<Drawn>, easing: &mut EasingItem) {
    let Some(Blend { drawn, exact }) = drawn.0.take() else {
        return;
    };
    let mut pose = *transform;
    let written = [
        make_exact(&mut pose.translation, drawn.translation, exact.translation),
        make_exact(&mut pose.rotation, drawn.rotation, exact.rotation),
        make_exact(&mut pose.scale, drawn.scale, exact.scale),
    ];
    transform.set_if_neq(pose);
    easing.forget_start_of(written);
}

/// Makes a part exact that is as it was drawn. Otherwise it was written, which this returns.
fn make_exact<Part: PartialEq>(part: &mut Part, drawn: Part, exact: Part) -> bool {
    let is_written = *part != drawn;
    if !is_written {
        *part = exact;
    }
    is_written
}

/// Interpolates to what all systems of fixed time have left, in whatever order they ran.
fn set_ends(mut bodies: Query<(&Transform, &mut Drawn, Easing)>) {
    for (&exact, mut drawn, mut easing) in &mut bodies {
        easing.set_end(Some(exact));
        drawn.0 = Some(Blend { drawn: exact, exact });
    }
}

fn keep_drawn(mut bodies: Query<(&Transform, &mut Drawn, Easing)>) {
    for (transform, mut drawn, mut easing) in &mut bodies {
        if let Some(blend) = &mut drawn.0 {
            blend.drawn = *transform;
        }
        easing.set_end(None);
    }
}

fn forget_ends(mut bodies: Query<Easing, With<Drawn>>) {
    for mut easing in &mut bodies {
        easing.set_end(None);
    }
}

/// A [`Teleport`] of `FixedLast` is still there when the frame is drawn, one of `FixedUpdate` no longer.
fn show_teleports_at_once(mut teleported: Query<Easing, With<Teleport>>) {
    for mut easing in &mut teleported {
        easing.forget_start();
    }
}

/// The start of a body with a new parent is in the coordinates of the old one.
fn show_reparented_at_once(
    adopted: Query<Entity, (With<Drawn>, Changed<ChildOf>)>,
    mut released: RemovedComponents<ChildOf>,
    mut bodies: Query<Easing, With<Drawn>>,
) {
    for entity in adopted.iter().chain(released.read()) {
        if let Ok(mut easing) = bodies.get_mut(entity) {
            easing.forget_start();
        }
    }
}

/// Makes the `Transform` of a body exact. What is written to it now appears at once, even if it is what was drawn.
pub(crate) fn show_exact(body: &mut EntityWorldMut) {
    if let Ok((transform, drawn, mut easing)) = body.get_components_mut::<(&mut Transform, &mut Drawn, Easing)>() {
        leave(transform, drawn, &mut easing);
        easing.forget_start();
    }
}
