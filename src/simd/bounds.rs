//! Bounds for the boxes of a mesh's tree, eight at a time, in single precision.

use crate::geometry::lanes::{BoxGroup, Cluster};
use crate::simd::lanes::{
    Points, Simd, SimdBase, SimdFloat, abs, add, bitmask, dot, each, load_points, max, min, mul, scale, splat,
    splat_point, sub,
};
use glam::{DVec3, Vec3};

/// Relative rounding error of a bound.
const ROUNDING: f32 = 2.0e-6;

/// Eight boxes about the mesh's centre of mass, along its axes.
pub struct Boxes<S: Simd> {
    center: Points<S>,
    half: Points<S>,
    /// Lanes that hold a box.
    held: u32,
}

impl<S: Simd> Boxes<S> {
    /// Boxes of a mesh that is not scaled.
    #[inline(always)]
    pub fn of(simd: S, group: &BoxGroup) -> Self {
        let half = load_points(simd, &group.half);
        Self {
            center: load_points(simd, &group.center),
            half,
            // Unused lanes have a half size of minus infinity.
            held: bitmask(splat(simd, 0.0).simd_le(half[0])),
        }
    }

    /// Boxes of the triangles of a cluster. `center` is the mesh's centre of mass.
    #[inline(always)]
    pub fn of_triangles(simd: S, cluster: &Cluster, center: Vec3) -> Self {
        let [p, q, r] = each(|k| load_points(simd, &cluster.corners[k]));
        let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
        let origin = splat_point(simd, (cluster.origin.as_dvec3() - center.as_dvec3()).as_vec3());
        let half = splat(simd, 0.5);
        Self {
            center: add(scale(add(low, high), half), origin),
            half: scale(sub(high, low), half),
            held: cluster.lanes,
        }
    }

    /// A copy of the boxes after scaling.
    #[inline(always)]
    pub fn scaled(self, by: Points<S>) -> Self {
        Self {
            center: mul(self.center, by),
            half: mul(self.half, abs(by)),
            ..self
        }
    }
}

/// A box whose distance from others is asked for.
pub struct Near<S: Simd> {
    center: Points<S>,
    half: Points<S>,
}

impl<S: Simd> Near<S> {
    /// `pad` is the allowance for the rounding of positions.
    #[inline(always)]
    pub fn new(simd: S, center: DVec3, half: DVec3, pad: f32) -> Self {
        Self {
            center: splat_point(simd, center.as_vec3()),
            half: splat_point(simd, half.as_vec3() + pad),
        }
    }

    /// Lower bounds of the distances to other boxes, and the lanes of those that may be no farther than `most`.
    #[inline(always)]
    pub fn bounds(&self, boxes: &Boxes<S>, most: f32) -> ([f32; 8], u32) {
        let simd = self.center[0].simd;
        let apart = abs(sub(boxes.center, self.center));
        let outside = max(sub(apart, add(boxes.half, self.half)), splat_point(simd, Vec3::ZERO));
        let bound = dot(outside, outside).sqrt() * splat(simd, 1.0 - ROUNDING);
        (bound.into(), bitmask(bound.simd_le(splat(simd, most))) & boxes.held)
    }
}

/// A box that moves along a line, or a ray.
pub struct Swept<S: Simd> {
    start: Points<S>,
    /// Half its size, and the allowance for the rounding of positions.
    half: Points<S>,
    /// Reciprocals of the unit direction.
    inverse: Points<S>,
    pad: f32,
}

impl<S: Simd> Swept<S> {
    /// A box that moves from `start` along the unit vector `way`.
    #[inline(always)]
    pub fn new(simd: S, start: DVec3, half: DVec3, way: Vec3, pad: f32) -> Self {
        Self {
            start: splat_point(simd, start.as_vec3()),
            half: splat_point(simd, half.as_vec3() + pad),
            inverse: each(|i| {
                // Keeps the reciprocal finite.
                let d = way[i];
                splat(simd, if d.abs() < 1.0e-12 { 1.0e12 } else { d.recip() })
            }),
            pad,
        }
    }

    /// Lower bounds of the distances at which it meets other boxes, and the lanes of those that it may meet no later
    /// than at `most`.
    #[inline(always)]
    pub fn bounds(&self, boxes: &Boxes<S>, most: f32) -> ([f32; 8], u32) {
        let simd = self.start[0].simd;
        let apart = sub(boxes.center, self.start);
        let half = add(boxes.half, self.half);
        let (mut enter, mut leave) = (splat(simd, 0.0), splat(simd, most));
        for i in 0..3 {
            let (s, t) = (
                (apart[i] - half[i]) * self.inverse[i],
                (apart[i] + half[i]) * self.inverse[i],
            );
            enter = enter.max(s.min(t));
            leave = leave.min(s.max(t));
        }
        let bound = enter * splat(simd, 1.0 - ROUNDING) - splat(simd, self.pad);
        let until = leave + leave.abs() * splat(simd, ROUNDING) + splat(simd, self.pad);
        (bound.into(), bitmask(bound.simd_le(until)) & boxes.held)
    }
}
