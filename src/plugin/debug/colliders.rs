//! Gizmos of colliders: wireframes, boxes, bounding spheres, faces of collision.

use super::config::FaceoffGizmos;
use super::outlines::{Drawn, draw_box, draw_wireframe};
use crate::plugin::inspect::islands::{IslandFinder, Islands};
use crate::plugin::inspect::poses::{ColliderState, PlacedCollider, WorldPoses};
use crate::queries::Placed;
use bevy::prelude::*;

/// Outlines the *faces of collision* of this body towards another one: the faces that
/// [`Culling::FacesOfCollision`](crate::types::settings::Culling::FacesOfCollision) would test if the two were near
/// each other.
///
/// Nothing is drawn if the body's mesh has no face table.
#[derive(Component, Reflect, FromTemplate, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, PartialEq)]
pub struct ShowFacesTowards(#[entities] pub Entity);

pub(super) fn draw_colliders(mut gizmos: Drawn, poses: WorldPoses, finder: IslandFinder) {
    let config = gizmos.config_ext;
    let kinds = [config.wireframes, config.boxes, config.bounding_spheres];
    if kinds.iter().all(Option::is_none) || !gizmos.config.enabled {
        return;
    }
    let islands = config.islands.map(|color| (color, finder.find(&poses)));
    for collider in poses.colliders() {
        let [wireframe, around, sphere] = kinds.map(|color| color_of(config, color?, &collider, islands.as_ref()));
        if let Some(color) = wireframe {
            draw_wireframe(&mut gizmos, collider.mesh, &collider.to_world, color);
        }
        if let Some(color) = around
            && let Some([center, half_size]) = box_of(&collider)
        {
            draw_box(&mut gizmos, Isometry3d::from_translation(center), half_size, color);
        }
        if let Some(color) = sphere {
            gizmos.sphere(collider.in_world(collider.mesh.mass.center), collider.radius(), color);
        }
    }
}

/// The colour of a collider. `None` hides it.
fn color_of(
    config: &FaceoffGizmos,
    awake: Color,
    collider: &PlacedCollider,
    islands: Option<&(Color, Islands)>,
) -> Option<Color> {
    let root = |(color, islands): &(Color, Islands)| Some((*color, *islands.root_of.get(&collider.body)?));
    match (collider.state, islands.and_then(root)) {
        (ColliderState::Awake | ColliderState::Asleep, Some((color, root))) => {
            Some(FaceoffGizmos::color_of_island(color, root))
        }
        (state, _) => config.color_of(awake, state),
    }
}

/// Centre and half size of the box of a collider in the tree of spatial queries.
fn box_of(collider: &PlacedCollider) -> Option<[Vec3; 2]> {
    let (pose, scale) = (collider.placed.pose, collider.placed.scale);
    let placed = Placed::new(collider.mesh, pose.translation, pose.rotation, scale).ok()?;
    Some(placed.outer_box().map(|corner| corner.as_vec3()))
}

pub(super) fn draw_faces(mut gizmos: Drawn, lit: Query<(Entity, &ShowFacesTowards)>, poses: WorldPoses) {
    let Some(color) = gizmos.config_ext.faces.filter(|_| gizmos.config.enabled) else {
        return;
    };
    for (entity, towards) in &lit {
        let (Some(own), Some(other)) = (poses.collider(entity), poses.collider(towards.0)) else {
            continue;
        };
        let (pose, scale) = (own.placed.pose, own.placed.scale);
        let pose = Transform {
            translation: pose.translation.as_vec3(),
            rotation: pose.rotation.as_quat(),
            scale,
        };
        let center = other.in_world(other.mesh.mass.center);
        for t in own.mesh.faces_towards(&pose, center).into_iter().flatten() {
            let corners = own.mesh.mesh.corners(t as usize);
            gizmos.lineloop(corners.map(|corner| own.in_world(corner)), color);
        }
    }
}
