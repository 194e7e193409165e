//! Outlines of shapes.

use super::config::FaceoffGizmos;
use crate::asset::CollisionMesh;
use bevy::math::DAffine3;
use bevy::prelude::*;

/// The gizmos of this plugin.
pub(super) type Drawn<'w, 's> = Gizmos<'w, 's, FaceoffGizmos>;

/// Draws each edge of a mesh once, of a rounded one those of its core. A ball and a capsule are drawn as they are.
pub(super) fn draw_wireframe(gizmos: &mut Drawn, mesh: &CollisionMesh, to_world: &DAffine3, color: Color) {
    // Each line converts its colour; for a linear colour that is free.
    let color = Color::from(color.to_linear());
    if mesh.mesh.is_thin() {
        draw_round(gizmos, mesh, to_world, color);
        return;
    }
    let features = mesh.features();
    let in_world = |vertex: &Vec3| to_world.transform_point3(vertex.as_dvec3()).as_vec3();
    let points: Vec<Vec3> = features.vertices.iter().map(in_world).collect();
    for (from, &start) in (0..).zip(&points) {
        for &to in features.neighbors_of(from).iter().filter(|&&to| from < to) {
            gizmos.line(start, points[to as usize], color);
        }
    }
}

/// Draws a ball or a capsule.
fn draw_round(gizmos: &mut Drawn, mesh: &CollisionMesh, to_world: &DAffine3, color: Color) {
    let [start, _, end] = mesh
        .mesh
        .corners(0)
        .map(|p| to_world.transform_point3(p.as_dvec3()).as_vec3());
    let matrix = to_world.matrix3;
    let scales = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.length());
    let radius = mesh.settings.rounding * scales.into_iter().fold(f64::INFINITY, f64::min) as f32;
    let way = end - start;
    let turn = Quat::from_rotation_arc(Vec3::Y, way.normalize_or(Vec3::Y));
    let pose = Isometry3d::new(0.5 * (start + end), turn);
    if way == Vec3::ZERO {
        gizmos.sphere(pose, radius, color);
    } else {
        gizmos.primitive_3d(&Capsule3d::new(radius, way.length()), pose, color);
    }
}

/// Draws a box along the axes of its pose.
pub(super) fn draw_box(gizmos: &mut Drawn, pose: Isometry3d, half_size: Vec3, color: Color) {
    let cube = Transform::from_isometry(pose).with_scale(2.0 * half_size);
    gizmos.cube(cube, color);
}

/// Draws a cross and a normal.
pub(super) fn draw_hit(gizmos: &mut Drawn, point: Vec3, normal: Vec3, color: Color) {
    let size = gizmos.config_ext.marker_size;
    gizmos.cross(point, size, color);
    gizmos.arrow(point, point + 5.0 * size * normal, color);
}
