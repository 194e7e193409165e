//! Ray casts from inside a body to where the ray leaves it.

use super::side::Side;
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{SimdBase, bitmask, bits, each, load_points, splat, splat_point, sub};
use crate::simd::level::baseline;
use crate::simd::levels::visit;
use crate::simd::line::may_meet;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::BoxGroup;
use glam::DVec3;
use std::cell::Cell;

/// Tolerance of a hit in barycentric coordinates, so that no ray slips through an edge.
const SLACK: f64 = 1.0e-9;

/// Distance and triangle of the first hit of the ray from `start` along the unit vector `direction`, if it is no
/// farther than `most` and the ray leaves the body there.
pub fn exit(side: &Side, start: DVec3, direction: DVec3, most: f64) -> Option<(f64, u32)> {
    let mesh = &side.mesh.mesh;
    let lanes = side.mesh.lanes();
    let (from, way) = (side.to_mesh(start), side.direction_to_mesh(direction));
    // Boxes are tested in single precision, relative to the centre of mass, with the normalised direction.
    let length = way.length();
    let center = side.mesh.mass.center.as_dvec3();
    let simd = baseline();
    let local = splat_point(simd, (from - center).as_vec3());
    let unit = way / length;
    let inverse = each(|axis| {
        // Keeps the reciprocal finite.
        let d = if unit[axis].abs() < 1.0e-12 {
            1.0e-12
        } else {
            unit[axis]
        };
        splat(simd, d.recip() as f32)
    });
    let pad = splat(simd, PAD * (lanes.aabb.max - lanes.aabb.min).length());
    let nearest = Cell::new((most, None));
    let met = |group: &BoxGroup| {
        let longest = (nearest.get().0 * length * 1.000_001) as f32;
        let (mut enter, mut leave) = (splat(simd, 0.0), splat(simd, longest));
        let apart = sub(load_points(simd, &group.center), local);
        let half = load_points(simd, &group.half);
        let mut held = splat(simd, 0.0).simd_le(half[0]);
        for i in 0..3 {
            let half = half[i] + pad;
            let (s, t) = ((apart[i] - half) * inverse[i], (apart[i] + half) * inverse[i]);
            enter = enter.max(s.min(t));
            leave = leave.min(s.max(t));
        }
        // Rounding allowance of the products.
        let slack = (enter.abs() + leave.abs()) * splat(simd, 1.0e-6) + pad;
        held &= enter.simd_le(leave + slack);
        bitmask(held)
    };
    visit(&lanes.levels, &met, &mut |cluster| {
        let first = cluster as usize * CLUSTER;
        for t in bits(may_meet(simd, &lanes.clusters[cluster as usize], from, unit)).map(|lane| first + lane) {
            let corners = mesh.corners(t);
            if let Some(distance) = meets(each(|k| corners[k].as_dvec3() - from), way)
                && distance < nearest.get().0
            {
                nearest.set((distance, Some(t as u32)));
            }
        }
        true
    });
    let (distance, triangle) = nearest.get();
    let leaves = |t: &u32| way.dot(side.features.normals[*t as usize].as_dvec3()) > 0.0;
    Some((distance, triangle.filter(leaves)?))
}

/// Distance along `way` at which the ray from the origin hits the triangle.
fn meets([a, b, c]: [DVec3; 3], way: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let slope = way.dot(normal);
    if slope * slope <= 1.0e-18 * way.length_squared() * normal.length_squared() {
        return None;
    }
    let moment = a.cross(way);
    let (v, w) = (moment.dot(ac) / slope, -moment.dot(ab) / slope);
    let distance = a.dot(normal) / slope;
    (v >= -SLACK && w >= -SLACK && v + w <= 1.0 + SLACK && distance >= 0.0).then_some(distance)
}
