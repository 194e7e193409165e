//! The triangle-triangle interval test (Moeller 1997) in single precision, eight pairs at a time, with a bound on every
//! error.
//!
//! It decides only where the bounds allow. The few other pairs, among them all that are coplanar or touch in a point,
//! are left to [`intersect`](crate::geometry::triangle::intersect).

use crate::simd::lanes::{
    Points, Select, Simd, SimdBase, add, bitmask, cross, dot, f32x8, heights, largest, least, mask32x8, norm1, pick,
    scale, splat, sub,
};
use glam::Vec3;

/// Least 1-norm of the cross product of two normals for which their planes have a common line.
pub(crate) const MIN_LINE: f32 = 1.0e-30;

/// Eight triangles with their planes and error bounds.
pub struct TriangleLanes<S: Simd> {
    pub corners: [Points<S>; 3],
    pub normal: Points<S>,
    /// Error bound of a height over the plane, times the normal's length.
    pub tolerance: f32x8<S>,
    /// Error bound of a coordinate.
    pub error: f32x8<S>,
}

/// The results of eight pairs, one bit per lane.
pub struct Verdicts<S: Simd> {
    /// Certain intersections.
    pub hit: u32,
    /// Undecided.
    pub unsure: u32,
    start: Points<S>,
    end: Points<S>,
}

impl<S: Simd> Verdicts<S> {
    /// The common segment of an intersecting pair, along the cross product of the normals.
    #[inline(always)]
    pub fn segment(&self, lane: usize) -> [Vec3; 2] {
        [&self.start, &self.end].map(|[x, y, z]| Vec3::new(x[lane], y[lane], z[lane]))
    }
}

/// Tests eight pairs of triangles, all in the same coordinates.
#[inline(always)]
pub fn decide<S: Simd>([a, b]: &[TriangleLanes<S>; 2]) -> Verdicts<S> {
    let heights_a = heights(&a.corners, b.corners[0], b.normal);
    let heights_b = heights(&b.corners, a.corners[0], a.normal);
    decide_by([a, b], &heights_a, &heights_b)
}

/// Lanes in which all heights lie beyond the tolerance on one side.
#[inline(always)]
pub fn beside<S: Simd>(heights: &[f32x8<S>; 3], tolerance: f32x8<S>) -> u32 {
    let (lowest, highest) = (least(*heights), largest(*heights));
    bitmask(lowest.simd_gt(tolerance) | highest.simd_lt(-tolerance))
}

/// [`decide`] with given heights of each triangle's corners over the other's plane.
#[inline(always)]
pub fn decide_by<S: Simd>(
    [a, b]: [&TriangleLanes<S>; 2],
    heights_a: &[f32x8<S>; 3],
    heights_b: &[f32x8<S>; 3],
) -> Verdicts<S> {
    let simd = a.error.simd;
    let sides_a = CornerSides::of(heights_a, b.tolerance);
    let sides_b = CornerSides::of(heights_b, a.tolerance);

    let line = cross(a.normal, b.normal);
    let chord_a = Chord::new(&a.corners, heights_a, &sides_a, b.tolerance, line);
    let chord_b = Chord::new(&b.corners, heights_b, &sides_b, a.tolerance, line);
    let first = chord_a.low_at.simd_ge(chord_b.low_at);
    let last = chord_a.high_at.simd_le(chord_b.high_at);
    let start_at = first.select(chord_a.low_at, chord_b.low_at);
    let end_at = last.select(chord_a.high_at, chord_b.high_at);
    let overlap = end_at - start_at;
    // The error of the end points comes from the heights, from their own coordinates and from the sums along the line.
    let bound = norm1(line) * (chord_a.error + chord_b.error + splat(simd, 4.0) * a.error);

    let apart = sides_a.one | sides_b.one;
    // Nearly parallel planes and tiny faces have no reliable common line.
    let clear = sides_a.clear & sides_b.clear & norm1(line).simd_gt(splat(simd, MIN_LINE));
    let hit = clear & overlap.simd_gt(bound);
    let miss = apart | (clear & overlap.simd_lt(-bound));
    let hit = bitmask(hit) & !bitmask(apart);
    Verdicts {
        hit,
        unsure: !(hit | bitmask(miss)) & 0xff,
        start: pick(first, chord_a.low, chord_b.low),
        end: pick(last, chord_a.high, chord_b.high),
    }
}

/// The sides of the other plane on which the corners lie.
struct CornerSides<S: Simd> {
    /// All corners are certainly on one side.
    one: mask32x8<S>,
    /// The side of each corner is certain.
    clear: mask32x8<S>,
    above: [mask32x8<S>; 3],
}

impl<S: Simd> CornerSides<S> {
    #[inline(always)]
    fn of([p, q, r]: &[f32x8<S>; 3], tolerance: f32x8<S>) -> Self {
        let above = [p.simd_gt(tolerance), q.simd_gt(tolerance), r.simd_gt(tolerance)];
        let below = [p.simd_lt(-tolerance), q.simd_lt(-tolerance), r.simd_lt(-tolerance)];
        Self {
            one: (above[0] & above[1] & above[2]) | (below[0] & below[1] & below[2]),
            clear: (above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2]),
            above,
        }
    }
}

/// Where a triangle crosses the other's plane: two points, in order along the common line.
struct Chord<S: Simd> {
    low: Points<S>,
    high: Points<S>,
    low_at: f32x8<S>,
    high_at: f32x8<S>,
    /// Error bound of the points, besides the error bound of the coordinates.
    error: f32x8<S>,
}

impl<S: Simd> Chord<S> {
    #[inline(always)]
    fn new(
        t: &[Points<S>; 3],
        heights: &[f32x8<S>; 3],
        sides: &CornerSides<S>,
        tolerance: f32x8<S>,
        line: Points<S>,
    ) -> Self {
        let [p, q, r] = sorted(t, sides);
        let [[hp], [hq], [hr]] = sorted(&[[heights[0]], [heights[1]], [heights[2]]], sides);
        let (x, error_x) = crossing([p, q], [hp, hq], tolerance);
        let (y, error_y) = crossing([p, r], [hp, hr], tolerance);
        let (at_x, at_y) = (dot(x, line), dot(y, line));
        let ordered = at_x.simd_le(at_y);
        Self {
            low: pick(ordered, x, y),
            high: pick(ordered, y, x),
            low_at: at_x.min(at_y),
            high_at: at_x.max(at_y),
            error: error_x.max(error_y),
        }
    }
}

/// The corner that is alone on its side, then the other two: the third if the first two agree, else the second if first
/// and third agree.
#[inline(always)]
fn sorted<S: Simd, const N: usize>(t: &[[f32x8<S>; N]; 3], sides: &CornerSides<S>) -> [[f32x8<S>; N]; 3] {
    let third = !(sides.above[0] ^ sides.above[1]);
    let second = !(sides.above[0] ^ sides.above[2]) & !third;
    let either = third | second;
    let mut sorted = *t;
    for i in 0..N {
        sorted[0][i] = third.select(t[2][i], second.select(t[1][i], t[0][i]));
        sorted[1][i] = either.select(t[0][i], t[1][i]);
        sorted[2][i] = third.select(t[1][i], t[2][i]);
    }
    sorted
}

/// Where an edge crosses the plane over which its ends have these heights, and the error bound of the point.
#[inline(always)]
fn crossing<S: Simd>([from, to]: [Points<S>; 2], heights: [f32x8<S>; 2], tolerance: f32x8<S>) -> (Points<S>, f32x8<S>) {
    let simd = tolerance.simd;
    let across = splat(simd, 1.0) / (heights[0] - heights[1]);
    let edge = sub(to, from);
    let along = heights[0] * across;
    // Both heights may err by the tolerance.
    let error = norm1(edge) * (tolerance * across).abs() * splat(simd, 2.0);
    (add(from, scale(edge, along)), error)
}
