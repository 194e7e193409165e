//! Gizmos that show what the step sees: [`FaceoffGizmosPlugin`]. Needs the feature `debug_gizmos`.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_faceoff::plugin::debug::{FaceoffGizmos, FaceoffGizmosPlugin};
//! use bevy_faceoff::prelude::*;
//!
//! /// Shows and hides wireframes and velocities while the game runs.
//! fn switch(mut store: ResMut<GizmoConfigStore>) {
//!     let gizmos = store.config_mut::<FaceoffGizmos>().1;
//!     let (on, off) = (FaceoffGizmos::all(), FaceoffGizmos::none());
//!     let change = if gizmos.wireframes.is_some() { off } else { on };
//!     gizmos.wireframes = change.wireframes;
//!     gizmos.linear_velocities = change.linear_velocities;
//! }
//!
//! # let mut app = App::new();
//! app.add_plugins((DefaultPlugins, FaceoffPlugins::default(), FaceoffGizmosPlugin));
//! app.add_systems(Update, switch.run_if(bevy::input::common_conditions::input_just_pressed(KeyCode::KeyG)));
//! ```
//!
//! | to see | set | drawn at first |
//! |---|---|---|
//! | what collides, and where | [`wireframes`](FaceoffGizmos::wireframes), [`boxes`](FaceoffGizmos::boxes), [`bounding_spheres`](FaceoffGizmos::bounding_spheres), [`planes`](FaceoffGizmos::planes) | no |
//! | how bodies move | [`linear_velocities`](FaceoffGizmos::linear_velocities), [`angular_velocities`](FaceoffGizmos::angular_velocities), [`centers_of_mass`](FaceoffGizmos::centers_of_mass) | no |
//! | which bodies sleep and wake together | [`islands`](FaceoffGizmos::islands) | no |
//! | what touches | [`contacts`](FaceoffGizmos::contacts), [`intersections`](FaceoffGizmos::intersections) | yes |
//! | which points push, and how much | [`contact_points`](FaceoffGizmos::contact_points), [`impulses`](FaceoffGizmos::impulses) | no |
//! | what casters ask and hit | [`rays`](FaceoffGizmos::rays), [`shapes`](FaceoffGizmos::shapes), [`hits`](FaceoffGizmos::hits) | no |
//! | characters | [`characters`](FaceoffGizmos::characters) | no |
//! | faces of collision | [`faces`](FaceoffGizmos::faces), on bodies with [`ShowFacesTowards`] | yes |
//!
//! Colliders and bodies are drawn where their `Transform`s place them, by the same arithmetic as in the step: with the
//! scale and shear of all entities above. With `interpolation` that is where their meshes are drawn, up to one step
//! behind the contacts.
//!
//! The `GizmoConfig` of [`FaceoffGizmos`] sets line width and render layers. Set its `enabled` to `false` to hide all
//! gizmos. A hidden kind of gizmo costs nothing.

mod bodies;
mod characters;
mod colliders;
mod config;
mod contacts;
mod outlines;
mod planes;
mod queries;

pub use colliders::ShowFacesTowards;
pub use config::FaceoffGizmos;

use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;

/// Draws [`FaceoffGizmos`] in every frame, after the steps.
///
/// Add it after `DefaultPlugins`. Without Bevy's `GizmoPlugin`, for example in an app without a renderer, it does
/// nothing.
pub struct FaceoffGizmosPlugin;

impl Plugin for FaceoffGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<ShowFacesTowards>();
        if !app.is_plugin_added::<GizmoPlugin>() {
            debug!("no gizmos of collisions are drawn: the app has no GizmoPlugin");
            return;
        }
        let config = GizmoConfig {
            // Draws the lines in front of the surfaces on which they lie.
            depth_bias: -0.002,
            ..default()
        };
        let draw = (
            colliders::draw_colliders,
            colliders::draw_faces,
            planes::draw_planes,
            bodies::draw_motion,
            bodies::draw_islands,
            contacts::draw_contacts,
            queries::draw_rays,
            queries::draw_shapes,
            characters::draw_characters,
        );
        app.insert_gizmo_config(FaceoffGizmos::default(), config)
            .add_systems(PostUpdate, draw.after(TransformSystems::Propagate));
    }
}
