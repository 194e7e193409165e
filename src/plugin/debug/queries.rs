//! Gizmos of casters: their rays and shapes, and what these hit.

use super::outlines::{Drawn, draw_box, draw_hit, draw_wireframe};
use crate::asset::CollisionMesh;
use crate::plugin::inspect::poses::WorldPoses;
use crate::plugin::queries::{CasterShape, RayCaster, RayHits, ShapeCaster, ShapeHits};
use bevy::math::DAffine3;
use bevy::prelude::*;

/// How far an infinite ray is drawn, metres.
const SHOWN_OF_INFINITE: f32 = 1000.0;

pub(super) fn draw_rays(mut gizmos: Drawn, casters: Query<(Entity, &RayCaster, &RayHits)>, poses: WorldPoses) {
    let (rays, hit_color) = (gizmos.config_ext.rays, gizmos.config_ext.hits);
    if (rays.is_none() && hit_color.is_none()) || !gizmos.config.enabled {
        return;
    }
    for (entity, caster, hits) in casters.iter().filter(|(_, caster, _)| caster.enabled) {
        let Some((start, way)) = caster.in_world(&poses.to_world(entity)) else {
            continue;
        };
        if let Some(color) = rays {
            let end = match hits.last() {
                Some(last) if hits.len() >= caster.max_hits => last.distance,
                _ => caster.max_distance.min(SHOWN_OF_INFINITE),
            };
            gizmos.line(start, start + way * end, color);
        }
        if let Some(color) = hit_color {
            for hit in hits.iter() {
                draw_hit(&mut gizmos, hit.point, hit.normal, color);
            }
        }
    }
}

pub(super) fn draw_shapes(
    mut gizmos: Drawn,
    casters: Query<(Entity, &ShapeCaster, &ShapeHits)>,
    poses: WorldPoses,
    meshes: Option<Res<Assets<CollisionMesh>>>,
) {
    let (shapes, hit_color) = (gizmos.config_ext.shapes, gizmos.config_ext.hits);
    if (shapes.is_none() && hit_color.is_none()) || !gizmos.config.enabled {
        return;
    }
    for (entity, caster, hits) in casters.iter().filter(|(_, caster, _)| caster.enabled) {
        let Some((start, way)) = caster.in_world(&poses.to_world(entity)) else {
            continue;
        };
        if let Some(color) = shapes {
            let mut draw = |distance: f32| {
                let translation = Vec3::from(start.translation) + way * distance;
                let pose = Isometry3d::new(translation, start.rotation);
                draw_shape(&mut gizmos, &caster.shape, pose, meshes.as_deref(), color);
                translation
            };
            let from = draw(0.0);
            let mut end = caster.max_distance.min(SHOWN_OF_INFINITE);
            for hit in hits.iter() {
                draw(hit.distance);
                end = hit.distance;
            }
            gizmos.line(from, from + way * end, color);
        }
        if let Some(color) = hit_color {
            for hit in hits.iter() {
                draw_hit(&mut gizmos, hit.point, hit.normal, color);
            }
        }
    }
}

fn draw_shape(
    gizmos: &mut Drawn,
    shape: &CasterShape,
    pose: Isometry3d,
    meshes: Option<&Assets<CollisionMesh>>,
    color: Color,
) {
    match shape {
        &CasterShape::Ball { radius } => {
            gizmos.sphere(pose, radius, color);
        }
        &CasterShape::Box { half_size } => draw_box(gizmos, pose, half_size, color),
        &CasterShape::Capsule { radius, half_length } => {
            gizmos.primitive_3d(&Capsule3d { radius, half_length }, pose, color);
        }
        CasterShape::Mesh { mesh, scale } => {
            if let Some(mesh) = meshes.and_then(|meshes| meshes.get(mesh)) {
                let (rotation, translation) = (pose.rotation.as_dquat(), Vec3::from(pose.translation));
                let to_world =
                    DAffine3::from_scale_rotation_translation(scale.as_dvec3(), rotation, translation.as_dvec3());
                draw_wireframe(gizmos, mesh, &to_world, color);
            }
        }
    }
}
