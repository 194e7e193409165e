//! Ray casts from inside a body to where the ray leaves it.

use super::side::Side;
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{Points, Simd, SimdBase, bitmask, bits, each, f32x8, load_points, splat, splat_point, sub};
use crate::simd::level::with_simd;
use crate::simd::levels::visit;
use crate::simd::line::may_meet;
use crate::simd::rounding::PAD;
use crate::state::mesh_arena::BoxGroup;
use glam::DVec3;
use std::cell::Cell;

/// Tolerance of a hit in barycentric coordinates, so that no ray slips through an edge.
const SLACK: f64 = 1.0e-9;

/// Distance and triangle of the first hit of each ray from `starts` along the unit vector `direction`, if it is no
/// farther than `most` and the ray leaves the body there. Rays without a start hit nothing.
pub fn exits<const N: usize>(
    side: &Side,
    starts: [Option<DVec3>; N],
    direction: DVec3,
    most: f64,
) -> [Option<(f64, u32)>; N] {
    with_simd!(simd => {
        let rays = Rays::new(simd, side, direction);
        let mut hits = [None; N];
        for (hit, start) in hits.iter_mut().zip(starts) {
            if let Some(start) = start {
                *hit = rays.exit(start, most);
            }
        }
        hits
    })
}

/// Parallel rays through a body, in the space of its mesh.
struct Rays<'a, S: Simd> {
    simd: S,
    side: &'a Side<'a>,
    way: DVec3,
    /// The length of `way`.
    length: f64,
    unit: DVec3,
    /// The reciprocals of `unit`.
    inverse: Points<S>,
    /// Rounding allowance of boxes.
    pad: f32x8<S>,
}

impl<'a, S: Simd> Rays<'a, S> {
    #[inline(always)]
    fn new(simd: S, side: &'a Side<'a>, direction: DVec3) -> Self {
        let way = side.direction_to_mesh(direction);
        let length = way.length();
        let unit = way / length;
        let inverse = each(
            #[inline(always)]
            |axis| {
                // Keeps the reciprocal finite.
                let d = if unit[axis].abs() < 1.0e-12 {
                    1.0e-12
                } else {
                    unit[axis]
                };
                splat(simd, d.recip() as f32)
            },
        );
        let aabb = side.mesh.lanes().aabb;
        Self {
            simd,
            side,
            way,
            length,
            unit,
            inverse,
            pad: splat(simd, PAD * (aabb.max - aabb.min).length()),
        }
    }

    /// The hit of the ray from `start`.
    #[inline(always)]
    fn exit(&self, start: DVec3, most: f64) -> Option<(f64, u32)> {
        let from = self.side.to_mesh(start);
        // Boxes are tested in single precision, relative to the centre of mass, with the normalised direction.
        let center = self.side.mesh.mass.center.as_dvec3();
        let local = splat_point(self.simd, (from - center).as_vec3());
        let nearest = Cell::new((most, None));
        let levels = &self.side.mesh.lanes().levels;
        visit(
            levels,
            #[inline(always)]
            |group: &BoxGroup| self.met(local, group, nearest.get().0),
            #[inline(always)]
            |cluster| {
                nearest.set(self.nearer(from, cluster, nearest.get()));
                true
            },
        );
        let (distance, triangle) = nearest.get();
        let leaves = |t: &u32| self.way.dot(self.side.features.normals[*t as usize].as_dvec3()) > 0.0;
        Some((distance, triangle.filter(leaves)?))
    }

    /// Lanes whose boxes the ray from `local` meets no farther than `most`.
    #[inline(always)]
    fn met(&self, local: Points<S>, group: &BoxGroup, most: f64) -> u32 {
        let Self { simd, inverse, pad, .. } = *self;
        let longest = (most * self.length * 1.000_001) as f32;
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
    }

    /// The nearest hit of the ray from `from`, if the nearest outside this cluster is `nearest`.
    #[inline(always)]
    fn nearer(&self, from: DVec3, cluster: u32, mut nearest: (f64, Option<u32>)) -> (f64, Option<u32>) {
        let first = cluster * CLUSTER as u32;
        let triangles = &self.side.mesh.lanes().clusters[cluster as usize];
        for t in bits(may_meet(self.simd, triangles, from, self.unit)).map(|lane| first + lane as u32) {
            let [a, b, c] = self.side.mesh.mesh.corners(t as usize);
            let corners = [a.as_dvec3() - from, b.as_dvec3() - from, c.as_dvec3() - from];
            if let Some(distance) = meets(corners, self.way)
                && distance < nearest.0
            {
                nearest = (distance, Some(t));
            }
        }
        nearest
    }
}

/// Distance along `way` at which the ray from the origin hits the triangle.
#[inline(always)]
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
