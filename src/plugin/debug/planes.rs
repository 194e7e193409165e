//! Gizmos of planes.

use super::outlines::Drawn;
use crate::plugin::inspect::poses::{ColliderState, WorldPoses};
use crate::plugin::sync::planes::{IsPlane, PlaneComponents};
use bevy::prelude::*;

/// Lines of a grid in each direction.
const CELLS: u32 = 10;

pub(super) fn draw_planes(mut gizmos: Drawn, planes: Query<PlaneComponents, IsPlane>, poses: WorldPoses) {
    let Some(color) = gizmos.config_ext.planes.filter(|_| gizmos.config.enabled) else {
        return;
    };
    let spacing = gizmos.config_ext.plane_size / CELLS as f32;
    for plane in &planes {
        let to_world = poses.to_world(plane.entity);
        let Ok(half_space) = plane.half_space(Some(to_world)) else {
            continue;
        };
        let state = if half_space.sensor {
            ColliderState::Sensor
        } else {
            ColliderState::Awake
        };
        let Some(color) = gizmos.config_ext.color_of(color, state) else {
            continue;
        };
        let (normal, place) = (half_space.normal, to_world.translation.as_vec3());
        let foot = place - normal * (normal.dot(place) - half_space.distance);
        let turn = Quat::from_rotation_arc(Vec3::Z, normal);
        gizmos
            .grid(
                Isometry3d::new(foot, turn),
                UVec2::splat(CELLS),
                Vec2::splat(spacing),
                color,
            )
            .outer_edges();
        gizmos.arrow(foot, foot + spacing * normal, color);
    }
}
