//! Triangles in single precision, one at a time in memory and eight at a time in registers.

use super::precision::DIRECTION_ERROR;
use crate::simd::lanes::{
    Points, Simd, SimdBase, SimdFloat, columns, each, each_lane, f32x8, mask32x8, pick, rows, splat,
};
use crate::triangle_test::cpu::interval_test::TriangleLanes;
#[cfg(test)]
use glam::Vec3;

/// A triangle in single precision, relative to the first body's centre of mass.
#[derive(Clone, Copy, Default)]
#[repr(align(16))]
pub struct SmallTriangle {
    /// A corner and a coordinate of the outward unit normal each. The normal is zero if the triangle has no area.
    corners: [[f32; 4]; 3],
    measures: [f32; 4],
    pub number: u32,
    /// What it owns, as bits: see [`owned_features`](super::feature_bits::owned_features).
    pub owned: u32,
}

/// Eight triangles, one per lane.
pub struct EightTriangles<S: Simd> {
    pub corners: [Points<S>; 3],
    /// Outward unit normal; zero if the triangle has no area.
    pub normal: Points<S>,
    /// Error bound of a height over the plane, per distance to the corner.
    pub tilt: f32x8<S>,
    /// Largest angle between the triangle's normal and a contact normal at an edge that it owns, radians.
    pub edge_rotation: f32x8<S>,
    /// Sum of the sides of the triangle's box.
    pub sides: f32x8<S>,
    /// Largest angle between the triangle's normal and the way to a point to which it is nearest at a vertex or edge
    /// that it owns, radians; negative if the corners are clockwise seen from outside.
    pub nearest_rotation: f32x8<S>,
}

impl SmallTriangle {
    /// Corner `k`, with one more number that only fills up four.
    #[inline(always)]
    pub fn corner(&self, k: usize) -> &[f32; 4] {
        &self.corners[k]
    }

    /// The ends of edge `k`, as [`SmallTriangle::corner`].
    #[inline(always)]
    pub fn edge(&self, k: usize) -> [&[f32; 4]; 2] {
        [self.corner(k), self.corner((k + 1) % 3)]
    }

    /// A triangle of which only the corners are known.
    #[cfg(test)]
    pub fn of_corners(corners: [Vec3; 3]) -> Self {
        Self {
            corners: corners.map(|p| [p.x, p.y, p.z, 0.0]),
            ..Self::default()
        }
    }

    #[cfg(test)]
    pub fn points(&self) -> [Vec3; 3] {
        self.corners.map(|[x, y, z, _]| Vec3::new(x, y, z))
    }
}

impl<S: Simd> EightTriangles<S> {
    /// Loads eight triangles from memory.
    #[inline(always)]
    pub fn gather(simd: S, from: [&SmallTriangle; 8]) -> Self {
        let [[a, b, c, x], [d, e, f, y], [g, h, i, z]] = each(
            #[inline(always)]
            |k| columns(simd, each_lane(|lane| from[lane].corner(k))),
        );
        let [tilt, edge_rotation, sides, nearest_rotation] = columns(simd, each_lane(|lane| &from[lane].measures));
        Self {
            corners: [[a, b, c], [d, e, f], [g, h, i]],
            normal: [x, y, z],
            tilt,
            edge_rotation,
            sides,
            nearest_rotation,
        }
    }

    /// Lanes whose normal's direction is known well enough for angles.
    #[inline(always)]
    pub fn has_direction(&self) -> mask32x8<S> {
        // Also false for NaN.
        self.tilt.simd_lt(splat(self.tilt.simd, DIRECTION_ERROR))
    }

    /// 1 if the corners are counter-clockwise seen from outside, else -1.
    #[inline(always)]
    pub fn winding(&self) -> f32x8<S> {
        splat(self.tilt.simd, 1.0).copysign(self.nearest_rotation)
    }

    /// Outward unit normals; zero where single precision does not determine them.
    #[inline(always)]
    pub fn direction(&self) -> Points<S> {
        let (known, zero) = (self.has_direction(), splat(self.tilt.simd, 0.0));
        pick(known, self.normal, [zero; 3])
    }

    /// These triangles for the interval test, with error bounds of heights over their planes and of coordinates.
    #[inline(always)]
    pub fn with_error(&self, tolerance: f32x8<S>, error: f32x8<S>) -> TriangleLanes<S> {
        TriangleLanes {
            corners: self.corners,
            normal: self.normal,
            tolerance,
            error,
        }
    }

    /// Writes these triangles to memory.
    #[inline(always)]
    pub fn scatter(&self, to: &mut [SmallTriangle; 8]) {
        let [first, second, third] = each(
            #[inline(always)]
            |k| {
                let [x, y, z] = self.corners[k];
                rows([x, y, z, self.normal[k]])
            },
        );
        let measures = rows([self.tilt, self.edge_rotation, self.sides, self.nearest_rotation]);
        for (lane, to) in to.iter_mut().enumerate() {
            to.corners = [first[lane], second[lane], third[lane]];
            to.measures = measures[lane];
        }
    }
}
