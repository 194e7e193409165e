//! What eight pairs of triangles may have, from the planes of both.
//!
//! Between finely tessellated surfaces a wide margin holds very many triangles that are near each other, and few of
//! them have a feature. A vertex lies over a face only if the two overlap when projected along the face's normal. Edges
//! form a feature only if their faces point at each other. Pairs that can neither have a feature nor cross are dropped
//! here.

use super::feature_bits::{CROSSING, FeatureBits, corner_features, edge_features};
use super::precision::AROUND_ERROR;
use super::search::Limits;
use super::small_triangle::EightTriangles;
use crate::simd::lanes::{
    Points, Simd, SimdBase, SimdFloat, add, bitmask, boxes_meet, cross, dot, each, f32x8, heights, largest, least,
    mask32x8, max, min, scale, splat, sub, widen,
};
use crate::triangle_test::cpu::interval_test::decide_by;

/// A reach is wide if it exceeds this multiple of the distance of triangles that may cross.
const WIDE: f32 = 4.0;

/// Lanes of pairs of triangles, and what they may have.
#[derive(Clone, Copy, Default)]
pub struct NearLanes {
    /// Lanes whose triangles may cross.
    pub crossing: u32,
    /// For each corner of the first triangle, lanes in which it may be over the second; and the other way round.
    corners: [[u32; 3]; 2],
    /// For each edge of the first triangle, lanes in which it may have a feature with an edge of the second; and the
    /// other way round.
    edges: [[u32; 3]; 2],
    /// Lanes in which a vertex or an edge of one may be nearest to one of the other.
    pub nearest: u32,
    /// Lower bounds of the distances in the lanes of `nearest`.
    pub gaps: [f32; 8],
}

impl NearLanes {
    /// What eight pairs of triangles may have whose boxes are within the reach. A pair that the plane of one of its
    /// triangles separates by more than the reach has nothing. `crossings` says whether crossings are wanted.
    #[inline(always)]
    pub fn of<S: Simd>([a, b]: [&EightTriangles<S>; 2], crossings: bool, limits: &Limits) -> Self {
        let simd = a.tilt.simd;
        let (far, close) = (splat(simd, limits.reach), splat(simd, limits.crossing));
        // Upper bound of the distance between any two points of two triangles whose boxes are near.
        let spread = a.sides + b.sides + far;
        let [over_a, over_b] = [Heights::over(a, b, spread), Heights::over(b, a, spread)];
        let near = bitmask(!(over_a.beyond(far) | over_b.beyond(far)));
        let mut found = Self::default();
        if crossings {
            found.crossing = near;
            if limits.crossing < limits.reach {
                let apart = over_a.beyond(close) | over_b.beyond(close);
                found.crossing &= bitmask(boxes_are_within(a, b, close) & !apart);
            }
            if !limits.has_slack {
                // With slack, triangles are compared with each other's edges later, which also gives their distance.
                found.crossing &= may_cross([a, b], [&over_a, &over_b], limits.pad);
            }
        }
        let corners = [over_b.corners(limits, near), over_a.corners(limits, near)];
        let directions = [a.direction(), b.direction()];
        let turn = splat(simd, limits.rotation);
        let rotation = a.edge_rotation + b.edge_rotation + turn;
        let sum = add(directions[0], directions[1]);
        let apart = dot(sum, sum);
        // Edges have a feature only if their triangles face each other.
        let edges = near & bitmask(apart.simd_le(rotation * rotation));
        if crossings {
            let rotation = a.nearest_rotation.abs() + b.nearest_rotation.abs() + turn;
            // Triangles whose normals are not known may face anywhere.
            let known = a.has_direction() & b.has_direction();
            found.nearest = near & bitmask(!known | apart.simd_le(rotation * rotation));
            found.gaps = over_a.gap().max(over_b.gap()).into();
        }
        let [[p, q, r], [s, t, u]] = corners;
        if p | q | r | s | t | u | edges == 0 {
            // Most triangles that cross have no feature.
            return found;
        }
        let mut near_features = [0xff; 3];
        // With a narrow reach, triangles that neither plane separates are next to each other in all directions.
        if limits.reach > WIDE * limits.crossing {
            near_features = may_have_features([a, b], directions, limits);
        }
        let [first, second, near_edges] = near_features;
        found.corners = [each(|k| corners[0][k] & first), each(|k| corners[1][k] & second)];
        let edges = edges & near_edges;
        found.edges = [over_b.edges(far, edges), over_a.edges(far, edges)];
        found
    }

    /// Lanes in which the triangles may have features.
    #[inline(always)]
    pub fn features(&self) -> u32 {
        let any = |[p, q, r]: [u32; 3]| p | q | r;
        let [first, second] = self.corners;
        let [own, other] = self.edges;
        any(first) | any(second) | any(own) & any(other)
    }

    /// [`CROSSING`] if the pair in this lane may cross.
    #[inline(always)]
    pub fn crossing_bit(&self, lane: usize) -> FeatureBits {
        ((self.crossing >> lane & 1) * u32::from(CROSSING)) as FeatureBits
    }

    /// The features that the pair in this lane may have.
    #[inline(always)]
    pub fn feature_bits(&self, lane: usize) -> FeatureBits {
        let bit = |lanes: u32| lanes >> lane & 1;
        let set = |[p, q, r]: [u32; 3]| bit(p) | bit(q) << 1 | bit(r) << 2;
        let [first, second] = self.corners;
        let [own, other] = self.edges;
        corner_features([set(first), set(second)]) | edge_features([set(own), set(other)])
    }
}

/// Lanes in which the triangles may cross where they are. `pad` bounds the errors of coordinates.
#[inline(always)]
fn may_cross<S: Simd>([a, b]: [&EightTriangles<S>; 2], [over_a, over_b]: [&Heights<S>; 2], pad: f32) -> u32 {
    let error = splat(a.tilt.simd, pad);
    let a = a.with_error(over_a.error + error, error);
    let b = b.with_error(over_b.error + error, error);
    let verdicts = decide_by([&a, &b], &over_b.heights, &over_a.heights);
    verdicts.hit | verdicts.unsure
}

/// Lanes in which the boxes of both triangles are no farther apart than `most`.
#[inline(always)]
fn boxes_are_within<S: Simd>(a: &EightTriangles<S>, b: &EightTriangles<S>, most: f32x8<S>) -> mask32x8<S> {
    let ([p, q, r], [s, t, u]) = (a.corners, b.corners);
    let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
    boxes_meet(
        widen(low, -most),
        widen(high, most),
        min(s, min(t, u)),
        max(s, max(t, u)),
    )
}

/// Lanes in which the triangles may have features of separation up to the reach: a corner of the first over the second,
/// a corner of the second over the first, or two edges. The points of a feature lie on a line along its normal, which
/// is a face's, or within [`EightTriangles::edge_rotation`] of the normals of the faces at both edges.
#[inline(always)]
fn may_have_features<S: Simd>(
    [a, b]: [&EightTriangles<S>; 2],
    [direction_a, direction_b]: [Points<S>; 2],
    limits: &Limits,
) -> [u32; 3] {
    let simd = a.tilt.simd;
    let ((middle_a, radius_a), (middle_b, radius_b)) = (sphere(a), sphere(b));
    let way = sub(middle_b, middle_a);
    // Squared lateral distance of the centres, perpendicular to the normal of either. It is zero if the normal is
    // unknown.
    let (across_a, across_b) = (cross(way, direction_a), cross(way, direction_b));
    let (lateral_a, lateral_b) = (dot(across_a, across_a), dot(across_b, across_b));
    let around = (radius_a + radius_b) * splat(simd, AROUND_ERROR) + splat(simd, limits.lateral);
    let square = around * around;
    let (reach, one) = (splat(simd, limits.reach), splat(simd, 1.0));
    let most_a = around + reach * a.edge_rotation.min(one);
    let most_b = around + reach * b.edge_rotation.min(one);
    let edges = lateral_a.simd_le(most_a * most_a) & lateral_b.simd_le(most_b * most_b);
    [
        bitmask(lateral_b.simd_le(square)),
        bitmask(lateral_a.simd_le(square)),
        bitmask(edges),
    ]
}

/// The centre and radius of a sphere around each triangle.
#[inline(always)]
fn sphere<S: Simd>(of: &EightTriangles<S>) -> (Points<S>, f32x8<S>) {
    let [p, q, r] = of.corners;
    let middle = scale(add(add(p, q), r), splat(of.tilt.simd, 1.0 / 3.0));
    let [p, q, r] = each(
        #[inline(always)]
        |k| sub(of.corners[k], middle),
    );
    let squares = [dot(p, p), dot(q, q), dot(r, r)];
    (middle, largest(squares).sqrt())
}

/// Heights of the corners of triangles over planes.
struct Heights<S: Simd> {
    /// Positive outside.
    heights: [f32x8<S>; 3],
    /// Error bound.
    error: f32x8<S>,
}

impl<S: Simd> Heights<S> {
    /// Heights of the corners of `other` over `face`. `spread` bounds the distance of any two points of both.
    #[inline(always)]
    fn over(face: &EightTriangles<S>, other: &EightTriangles<S>, spread: f32x8<S>) -> Self {
        Self {
            heights: heights(&other.corners, face.corners[0], face.normal),
            error: spread * face.tilt,
        }
    }

    /// Lower bounds of the corners' distances from the plane, on one side.
    #[inline(always)]
    fn gap(&self) -> f32x8<S> {
        least(self.heights).max(-largest(self.heights)) - self.error
    }

    /// Lanes whose corners are all farther from the plane than `most`, on one side.
    #[inline(always)]
    fn beyond(&self, most: f32x8<S>) -> mask32x8<S> {
        let most = most + self.error;
        least(self.heights).simd_gt(most) | largest(self.heights).simd_lt(-most)
    }

    /// For each corner, the `lanes` in which its height may be the separation of a feature.
    #[inline(always)]
    fn corners(&self, limits: &Limits, lanes: u32) -> [u32; 3] {
        let simd = self.error.simd;
        let lowest = splat(simd, limits.lowest) - self.error;
        let highest = splat(simd, limits.highest) + self.error;
        each(
            #[inline(always)]
            |k| {
                let height = self.heights[k];
                lanes & !bitmask(height.simd_lt(lowest) | height.simd_gt(highest))
            },
        )
    }

    /// For each edge, the `lanes` in which it may come as near to the plane as `most`.
    #[inline(always)]
    fn edges(&self, most: f32x8<S>, lanes: u32) -> [u32; 3] {
        let most = most + self.error;
        each(
            #[inline(always)]
            |k| {
                let (start, end) = (self.heights[k], self.heights[(k + 1) % 3]);
                lanes & !bitmask(start.min(end).simd_gt(most) | start.max(end).simd_lt(-most))
            },
        )
    }
}
