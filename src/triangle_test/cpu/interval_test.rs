//! The triangle-triangle interval test (Moeller 1997) in single precision, eight pairs at a time, with a bound on every
//! error.
//!
//! It decides only where the bounds allow. The few other pairs, among them all that are coplanar or touch in a point,
//! are left to [`intersect`](crate::geometry::triangle::intersect).

use crate::simd::lanes::{cross, dot, each, lane_of, norm1, pick, sub};
use crate::state::mesh_arena::Points;
use glam::Vec3;
use wide::f32x8;

/// Least 1-norm of the cross product of two normals for which their planes have a common line.
pub(crate) const MIN_LINE: f32 = 1.0e-30;

/// Eight triangles with their planes and error bounds.
pub struct Eight {
    pub corners: [Points; 3],
    pub normal: Points,
    /// Error bound of a height over the plane, times the normal's length.
    pub tolerance: f32x8,
    /// Error bound of a coordinate.
    pub error: f32x8,
}

/// The results of eight pairs, one bit per lane.
pub struct Verdicts {
    /// Certain intersections.
    pub hit: u32,
    /// Undecided.
    pub unsure: u32,
    start: Points,
    end: Points,
}

impl Verdicts {
    /// The common segment of an intersecting pair, along the cross product of the normals.
    pub fn segment(&self, lane: usize) -> [Vec3; 2] {
        [lane_of(&self.start, lane), lane_of(&self.end, lane)]
    }
}

/// Tests eight pairs of triangles, all in the same coordinates.
#[inline(always)]
pub fn decide([a, b]: &[Eight; 2]) -> Verdicts {
    let heights_a = heights(&a.corners, b.corners[0], b.normal);
    let heights_b = heights(&b.corners, a.corners[0], a.normal);
    decide_by([a, b], &heights_a, &heights_b)
}

/// Heights of corners over the plane through `origin`, times the length of its normal.
#[inline(always)]
pub fn heights(corners: &[Points; 3], origin: Points, normal: Points) -> [f32x8; 3] {
    each(|k| dot(sub(corners[k], origin), normal))
}

/// Lanes in which all heights lie beyond the tolerance on one side.
#[inline(always)]
pub fn beside(heights: &[f32x8; 3], tolerance: f32x8) -> u32 {
    let lowest = heights[0].fast_min(heights[1]).fast_min(heights[2]);
    let highest = heights[0].fast_max(heights[1]).fast_max(heights[2]);
    (lowest.simd_gt(tolerance) | highest.simd_lt(-tolerance)).to_bitmask()
}

/// [`decide`] with given heights of each triangle's corners over the other's plane.
#[inline(always)]
pub fn decide_by([a, b]: [&Eight; 2], heights_a: &[f32x8; 3], heights_b: &[f32x8; 3]) -> Verdicts {
    let side_a = Side::of(heights_a, b.tolerance);
    let side_b = Side::of(heights_b, a.tolerance);

    let line = cross(a.normal, b.normal);
    let chord_a = Chord::new(&a.corners, heights_a, &side_a, b.tolerance, line);
    let chord_b = Chord::new(&b.corners, heights_b, &side_b, a.tolerance, line);
    let first = chord_a.low_at.simd_ge(chord_b.low_at);
    let last = chord_a.high_at.simd_le(chord_b.high_at);
    let start_at = first.bitselect(chord_a.low_at, chord_b.low_at);
    let end_at = last.bitselect(chord_a.high_at, chord_b.high_at);
    let overlap = end_at - start_at;
    // The error of the end points comes from the heights, from their own coordinates and from the sums along the line.
    let bound = norm1(line) * (chord_a.error + chord_b.error + f32x8::splat(4.0) * a.error);

    let apart = side_a.one | side_b.one;
    // Nearly parallel planes and tiny faces have no reliable common line.
    let clear = side_a.clear & side_b.clear & norm1(line).simd_gt(f32x8::splat(MIN_LINE));
    let hit = clear & overlap.simd_gt(bound);
    let miss = apart | (clear & overlap.simd_lt(-bound));
    let hit = hit.to_bitmask() & !apart.to_bitmask();
    Verdicts {
        hit,
        unsure: !(hit | miss.to_bitmask()) & 0xff,
        start: pick(first, chord_a.low, chord_b.low),
        end: pick(last, chord_a.high, chord_b.high),
    }
}

/// The sides of the other plane on which the corners lie.
struct Side {
    /// All corners are certainly on one side.
    one: f32x8,
    /// The side of each corner is certain.
    clear: f32x8,
    above: [f32x8; 3],
}

impl Side {
    #[inline(always)]
    fn of(heights: &[f32x8; 3], tolerance: f32x8) -> Self {
        let above = each(|i| heights[i].simd_gt(tolerance));
        let below = each(|i| heights[i].simd_lt(-tolerance));
        Self {
            one: (above[0] & above[1] & above[2]) | (below[0] & below[1] & below[2]),
            clear: (above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2]),
            above,
        }
    }
}

/// Where a triangle crosses the other's plane: two points, in order along the common line.
struct Chord {
    low: Points,
    high: Points,
    low_at: f32x8,
    high_at: f32x8,
    /// Error bound of the points, apart from that of the coordinates.
    error: f32x8,
}

impl Chord {
    #[inline(always)]
    fn new(t: &[Points; 3], heights: &[f32x8; 3], side: &Side, tolerance: f32x8, line: Points) -> Self {
        // Selects the corner that is alone on its side: the third if the first two agree, else the second if first and
        // third agree.
        let third = !(side.above[0] ^ side.above[1]);
        let second = !(side.above[0] ^ side.above[2]) & !third;
        let either = third | second;
        let select = |x: [f32x8; 3]| {
            let alone = third.bitselect(x[2], second.bitselect(x[1], x[0]));
            [alone, either.bitselect(x[0], x[1]), third.bitselect(x[1], x[2])]
        };
        let axes = each(|axis| select([t[0][axis], t[1][axis], t[2][axis]]));
        let [p, q, r] = each(|k| [axes[0][k], axes[1][k], axes[2][k]]);
        let [hp, hq, hr] = select(*heights);

        let cross_at = |to: Points, h: f32x8| {
            let across = f32x8::ONE / (hp - h);
            let edge = sub(to, p);
            let along = hp * across;
            // Both heights may err by the tolerance.
            let error = norm1(edge) * (tolerance * across).abs() * f32x8::splat(2.0);
            let point = each(|i| p[i] + edge[i] * along);
            (point, error)
        };
        let ((x, error_x), (y, error_y)) = (cross_at(q, hq), cross_at(r, hr));
        let (at_x, at_y) = (dot(x, line), dot(y, line));
        let ordered = at_x.simd_le(at_y);
        Self {
            low: pick(ordered, x, y),
            high: pick(ordered, y, x),
            low_at: at_x.fast_min(at_y),
            high_at: at_x.fast_max(at_y),
            error: error_x.fast_max(error_y),
        }
    }
}
