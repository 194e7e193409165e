//! Gizmos of contacts, intersections, bounding spheres and faces of collision: [`FaceoffGizmosPlugin`]. Needs the
//! feature `debug_gizmos`.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_faceoff::plugin::debug::{FaceoffGizmos, FaceoffGizmosPlugin};
//! use bevy_faceoff::prelude::*;
//!
//! # let mut app = App::new();
//! app.add_plugins((DefaultPlugins, FaceoffPlugins::default(), FaceoffGizmosPlugin));
//! app.add_systems(Startup, |mut store: ResMut<GizmoConfigStore>| {
//!     store.config_mut::<FaceoffGizmos>().1.bounding_spheres = Some(Color::WHITE);
//! });
//! ```
//!
//! The `GizmoConfig` of [`FaceoffGizmos`] sets line width and render layers. Set its `enabled` to `false` to hide all
//! gizmos.

use crate::asset::CollisionMesh;
use crate::plugin::collisions::Collisions;
use crate::plugin::components::MeshCollider;
use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;

/// Draws [`FaceoffGizmos`] in every frame, after the steps.
///
/// Add it after `DefaultPlugins`. Without Bevy's `GizmoPlugin`, for example in an app without a renderer, it does
/// nothing.
pub struct FaceoffGizmosPlugin;

/// Which gizmos are drawn, and their colours. `None` hides a kind of gizmo.
#[derive(GizmoConfigGroup, Reflect, Clone, Debug)]
pub struct FaceoffGizmos {
    /// The bounding sphere of every collider, as the broad phase tests it. Default `None`.
    pub bounding_spheres: Option<Color>,
    /// An arrow for every touching pair, along the contact normal from the first body to the second. Default orange.
    pub contacts: Option<Color>,
    /// Length of these arrows in metres. Default 0.5.
    pub contact_length: f32,
    /// The segments along which faces intersect. Default yellow.
    pub intersections: Option<Color>,
    /// The edges of the faces that [`ShowFacesTowards`] selects. Default green.
    pub faces: Option<Color>,
}

impl Default for FaceoffGizmos {
    fn default() -> Self {
        Self {
            bounding_spheres: None,
            contacts: Some(Color::srgb(1.0, 0.4, 0.0)),
            contact_length: 0.5,
            intersections: Some(Color::srgb(1.0, 0.9, 0.1)),
            faces: Some(Color::srgb(0.2, 0.9, 0.3)),
        }
    }
}

/// Outlines the *faces of collision* of this body towards another one: the faces that
/// [`Culling::FacesOfCollision`](crate::types::settings::Culling::FacesOfCollision) would test if the two were near
/// each other.
///
/// Nothing is drawn if the body's mesh has no face table.
#[derive(Component, Reflect, FromTemplate, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, PartialEq)]
pub struct ShowFacesTowards(#[entities] pub Entity);

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
        app.insert_gizmo_config(FaceoffGizmos::default(), config).add_systems(
            PostUpdate,
            (spheres, contacts, faces).after(TransformSystems::Propagate),
        );
    }
}

fn spheres(
    mut gizmos: Gizmos<FaceoffGizmos>,
    colliders: Query<(&MeshCollider, &GlobalTransform)>,
    meshes: Res<Assets<CollisionMesh>>,
) {
    let Some(color) = gizmos.config_ext.bounding_spheres else {
        return;
    };
    for (collider, pose) in &colliders {
        if let Some(mesh) = meshes.get(&collider.0) {
            let radius = mesh.radius * pose.scale().abs().max_element();
            gizmos.sphere(pose.transform_point(mesh.mass.center), radius, color);
        }
    }
}

fn contacts(mut gizmos: Gizmos<FaceoffGizmos>, collisions: Option<Res<Collisions>>) {
    let Some(collisions) = collisions else { return };
    let FaceoffGizmos {
        contacts,
        contact_length,
        intersections,
        ..
    } = *gizmos.config_ext;
    for hit in collisions.iter() {
        if let Some(color) = contacts {
            let point = hit.contact.point;
            gizmos.arrow(point, point + contact_length * hit.contact.normal, color);
        }
        if let Some(color) = intersections {
            for pair in hit.faces {
                gizmos.line(pair.start, pair.end, color);
            }
        }
    }
}

fn faces(
    mut gizmos: Gizmos<FaceoffGizmos>,
    lit: Query<(&ShowFacesTowards, &MeshCollider, &GlobalTransform)>,
    others: Query<(&MeshCollider, &GlobalTransform)>,
    meshes: Res<Assets<CollisionMesh>>,
) {
    let Some(color) = gizmos.config_ext.faces else { return };
    for (towards, collider, pose) in &lit {
        let Some(mesh) = meshes.get(&collider.0) else { continue };
        let Ok((other, other_pose)) = others.get(towards.0) else {
            continue;
        };
        let Some(other) = meshes.get(&other.0) else { continue };
        let center = other_pose.transform_point(other.mass.center);
        for t in mesh
            .faces_towards(&pose.compute_transform(), center)
            .into_iter()
            .flatten()
        {
            gizmos.lineloop(mesh.mesh.corners(t as usize).map(|c| pose.transform_point(c)), color);
        }
    }
}
