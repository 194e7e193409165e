//! Gizmos of bodies: centres of mass, velocities, islands.

use super::config::FaceoffGizmos;
use super::outlines::Drawn;
use crate::plugin::inspect::islands::IslandFinder;
use crate::plugin::inspect::poses::WorldPoses;
use crate::types::body::{AngularVelocity, ComputedCenterOfMass, LinearVelocity, RigidBody};
use bevy::prelude::*;

pub(super) fn draw_motion(
    mut gizmos: Drawn,
    bodies: Query<
        (
            Entity,
            &ComputedCenterOfMass,
            Option<&LinearVelocity>,
            Option<&AngularVelocity>,
        ),
        With<RigidBody>,
    >,
    poses: WorldPoses,
) {
    let &FaceoffGizmos {
        centers_of_mass,
        linear_velocities,
        angular_velocities,
        velocity_scale,
        marker_size,
        ..
    } = gizmos.config_ext;
    let kinds = [centers_of_mass, linear_velocities, angular_velocities];
    if kinds.iter().all(Option::is_none) || !gizmos.config.enabled {
        return;
    }
    for (entity, center, linear, angular) in &bodies {
        let center = center_in_world(&poses, entity, center);
        if !center.is_finite() {
            continue;
        }
        if let Some(color) = centers_of_mass {
            gizmos.cross(center, marker_size, color);
        }
        let arrows = [
            (linear_velocities, linear.map(|velocity| velocity.0)),
            (angular_velocities, angular.map(|velocity| velocity.0)),
        ];
        for (color, velocity) in arrows {
            if let (Some(color), Some(velocity)) = (color, velocity)
                && velocity != Vec3::ZERO
                && velocity.is_finite()
            {
                gizmos.arrow(center, center + velocity_scale * velocity, color);
            }
        }
    }
}

pub(super) fn draw_islands(
    mut gizmos: Drawn,
    centers: Query<&ComputedCenterOfMass>,
    finder: IslandFinder,
    poses: WorldPoses,
) {
    let Some(color) = gizmos.config_ext.islands.filter(|_| gizmos.config.enabled) else {
        return;
    };
    let islands = finder.find(&poses);
    for &pair in &islands.links {
        let center = |body| Some(center_in_world(&poses, body, centers.get(body).ok()?));
        if let ([Some(start), Some(end)], Some(&root)) = (pair.map(center), islands.root_of.get(&pair[0]))
            && start.is_finite()
            && end.is_finite()
        {
            gizmos.line(start, end, FaceoffGizmos::color_of_island(color, root));
        }
    }
}

fn center_in_world(poses: &WorldPoses, body: Entity, center: &ComputedCenterOfMass) -> Vec3 {
    let to_world = poses.body_to_world(body);
    to_world.transform_point3(center.0.as_dvec3()).as_vec3()
}
