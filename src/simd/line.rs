//! Which of eight triangles a line may meet.

use super::lanes::{Simd, all_le, bitmask, cross, dot, each, largest, load_points, norm1, splat, splat_point, sub};
use crate::geometry::lanes::Cluster;
use glam::DVec3;

/// Relative rounding error of a product of three vectors in single precision.
const ERROR: f32 = 4.0e-6;

/// Lanes whose triangles the line through `start` along the unit vector `way` may meet, in the space of the mesh: its
/// triple products with all three edges have the same sign.
#[inline(always)]
pub fn may_meet<S: Simd>(simd: S, cluster: &Cluster, start: DVec3, way: DVec3) -> u32 {
    // Relative to the point of the line that is nearest to the cluster, single precision is at its best.
    let apart = start - cluster.origin.as_dvec3();
    let from = splat_point(simd, (apart - way * apart.dot(way)).as_vec3());
    let way = splat_point(simd, way.as_vec3());
    let corners = each(
        #[inline(always)]
        |k| sub(load_points(simd, &cluster.corners[k]), from),
    );
    let volumes = each(
        #[inline(always)]
        |k| dot(way, cross(corners[k], corners[(k + 1) % 3])),
    );
    // Positions are rounded relative to the cluster. A corner near the line is no more precise than the others, and the
    // exact test has a tolerance.
    let size = largest([norm1(corners[0]), norm1(corners[1]), norm1(corners[2])]) + norm1(from);
    let error = size * size * splat(simd, ERROR);
    let (left, right) = (all_le([-error; 3], volumes), all_le(volumes, [error; 3]));
    bitmask(left | right) & cluster.lanes
}
