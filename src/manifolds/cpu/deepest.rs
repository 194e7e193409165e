//! The vertex of a body that is farthest along a direction.

use super::side::Side;
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{SimdBase, bitmask, bits, dot, load_points, splat, splat_point};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::BoxGroup;
use glam::{DVec3, Vec3};
use std::cell::Cell;

/// The vertex of `side` that is farthest along the unit vector `direction`, in single precision, if it is farther than
/// `beyond`.
pub fn farthest(side: &Side, direction: DVec3, beyond: f64) -> Option<u32> {
    let lanes = side.mesh.lanes();
    let local = side.direction_from(direction);
    let simd = baseline();
    let along = splat_point(simd, local.as_vec3());
    let size = splat_point(simd, local.as_vec3().abs());
    let pad = PAD * (lanes.aabb.max - lanes.aabb.min).length() * local.length() as f32;
    let beyond = (beyond - direction.dot(side.place(Vec3::ZERO))) as f32;
    let best = Cell::new((beyond - pad, None));
    let pad = splat(simd, pad);
    let reaches = |group: &BoxGroup| {
        let (center, half) = (load_points(simd, &group.center), load_points(simd, &group.half));
        let highest = dot(center, along) + dot(half, size) + pad;
        bitmask(highest.simd_ge(splat(simd, best.get().0)) & splat(simd, 0.0).simd_le(half[0]))
    };
    visit(&lanes.vertex_levels, reaches, |group| {
        let (eight, held) = &lanes.vertices[group as usize];
        let heights = dot(load_points(simd, eight), along);
        for lane in bits(*held) {
            if heights[lane] > best.get().0 {
                best.set((heights[lane], Some(group * CLUSTER as u32 + lane as u32)));
            }
        }
        true
    });
    best.get().1
}
