//! Which features pairs of triangles may have, and whether they may cross, in single precision, eight at a time. All
//! conditions are widened by the slack and by bounds of the rounding errors.

use super::feature::BELOW;
use super::feature_bits::{CROSSING, FeatureBit, FeatureBits};
use super::precision::ANY_TILT;
use super::search::Limits;
use super::small_triangle::{EightTriangles, SmallTriangle};
use crate::simd::lanes::{
    Points, Select, Simd, SimdBase, SimdFloat, add, bitmask, bits, columns, cross, dot, each, each_lane, f32x8,
    largest, least, norm1, scale, splat, sub,
};

/// Relative rounding error of these tests.
const ERROR: f32 = 1.0e-5;
/// The squared sine of the angle between two edges below which their nearest points are uncertain.
const PARALLEL: f32 = 1.0e-3;

/// Sets lower bounds of the distances of pairs, eight at a time.
#[inline(always)]
pub fn set_gaps<S: Simd>(simd: S, triangles: [&[SmallTriangle]; 2], pairs: &mut [GapPair], pad: f32) {
    for some in pairs.chunks_mut(8) {
        let eight = eight_of(some).map(|pair| pair.triangles);
        let both = each_lane(|lane| {
            [
                &triangles[0][eight[lane][0] as usize],
                &triangles[1][eight[lane][1] as usize],
            ]
        });
        for (pair, gap) in some.iter_mut().zip(TwoTriangles::new(simd, &both).gaps(pad)) {
            // Coordinates beyond single precision may give NaN.
            pair.gap = if gap.is_nan() { 0.0 } else { gap };
        }
    }
}

/// Two triangles, as indices into the triangles of the first and of the second body or as their numbers, and a lower
/// bound of their distance, metres.
#[derive(Clone, Copy, Debug)]
pub struct GapPair {
    pub triangles: [u32; 2],
    pub gap: f32,
}

/// Removes what pairs of triangles cannot have. Its memory is kept between calls.
#[derive(Default)]
pub struct Narrowing {
    vertices: Vec<Task>,
    edges: Vec<Task>,
    /// The pairs that may cross, as indices.
    crossings: Vec<u32>,
}

/// A feature of a pair.
#[derive(Clone, Copy)]
struct Task {
    pair: u32,
    bit: u32,
}

/// Two triangles and what they may have.
#[derive(Clone, Copy)]
pub struct SmallPair {
    /// As indices into the triangles of the first and of the second body.
    pub triangles: [u32; 2],
    pub feature_bits: FeatureBits,
    /// Lower bound of their distance, if they may cross.
    pub gap: f32,
}

impl Narrowing {
    /// Removes features and crossings that pairs cannot have, and then pairs that have nothing. Features stay if not
    /// all triangles are `one_sided`.
    #[inline(always)]
    pub fn run<S: Simd>(
        &mut self,
        simd: S,
        triangles: [&[SmallTriangle]; 2],
        pairs: &mut Vec<SmallPair>,
        one_sided: bool,
        limits: &Limits,
    ) {
        if one_sided {
            self.narrow_features(simd, triangles, pairs, limits);
        }
        // Without slack, the search has compared the triangles by the interval test, and their gap is not needed.
        if limits.has_slack {
            self.narrow_crossings(simd, triangles, pairs, limits);
        }
        pairs.retain(|pair| pair.feature_bits != 0);
    }

    #[inline(always)]
    fn narrow_features<S: Simd>(
        &mut self,
        simd: S,
        triangles: [&[SmallTriangle]; 2],
        pairs: &mut [SmallPair],
        limits: &Limits,
    ) {
        let Self { vertices, edges, .. } = self;
        vertices.clear();
        edges.clear();
        for (number, pair) in (0..).zip(pairs.iter_mut()) {
            for bit in bits(u32::from(pair.feature_bits & !CROSSING)) {
                let tasks = if bit < 6 { &mut *vertices } else { &mut *edges };
                tasks.push(Task {
                    pair: number,
                    bit: bit as u32,
                });
            }
            pair.feature_bits &= CROSSING;
        }
        for tasks in vertices.chunks(8) {
            let eight = eight_of(tasks);
            let corners = each_lane(|lane| Corner::new(eight[lane], triangles, pairs));
            add_parts(pairs, eight, vertices_over(simd, &corners, limits));
        }
        for tasks in edges.chunks(8) {
            let eight = eight_of(tasks);
            let ends = each_lane(|lane| ends_of_edges(eight[lane], triangles, pairs));
            add_parts(pairs, eight, edges_near(simd, &ends, limits));
        }
    }

    #[inline(always)]
    fn narrow_crossings<S: Simd>(
        &mut self,
        simd: S,
        triangles: [&[SmallTriangle]; 2],
        pairs: &mut [SmallPair],
        limits: &Limits,
    ) {
        self.crossings.clear();
        let may_cross = (0..).zip(&*pairs).filter(|(_, pair)| pair.feature_bits & CROSSING != 0);
        self.crossings.extend(may_cross.map(|(number, _)| number));
        for numbers in self.crossings.chunks(8) {
            let eight = eight_of(numbers);
            let both = each_lane(|lane| pairs[*eight[lane] as usize].of(triangles));
            let both = TwoTriangles::new(simd, &both);
            for (&number, gap) in numbers.iter().zip(both.gaps(limits.pad)) {
                let pair = &mut pairs[number as usize];
                // Coordinates beyond single precision may give NaN.
                pair.gap = if gap.is_nan() { 0.0 } else { gap };
                if pair.gap > limits.crossing {
                    pair.feature_bits &= !CROSSING;
                }
            }
        }
    }
}

/// Up to eight of them. The last fills up the lanes.
#[inline(always)]
pub fn eight_of<T>(some: &[T]) -> [&T; 8] {
    each_lane(|lane| &some[lane.min(some.len() - 1)])
}

/// Gives pairs the features of the tasks in these lanes.
#[inline(always)]
fn add_parts(pairs: &mut [SmallPair], tasks: [&Task; 8], lanes: u32) {
    for lane in bits(lanes) {
        let Task { pair, bit } = tasks[lane];
        pairs[*pair as usize].feature_bits |= 1 << bit;
    }
}

impl Task {
    #[inline(always)]
    fn triangles<'a>(&self, triangles: [&'a [SmallTriangle]; 2], pairs: &[SmallPair]) -> [&'a SmallTriangle; 2] {
        pairs[self.pair as usize].of(triangles)
    }
}

impl SmallPair {
    #[inline(always)]
    fn of<'a>(&self, triangles: [&'a [SmallTriangle]; 2]) -> [&'a SmallTriangle; 2] {
        let [i, j] = self.triangles;
        [&triangles[0][i as usize], &triangles[1][j as usize]]
    }
}

/// Corner `k` of a triangle over another triangle.
struct Corner<'a> {
    k: usize,
    own: &'a SmallTriangle,
    over: &'a SmallTriangle,
}

impl<'a> Corner<'a> {
    #[inline(always)]
    fn new(task: &Task, triangles: [&'a [SmallTriangle]; 2], pairs: &[SmallPair]) -> Self {
        let FeatureBit::Vertex { side, k } = FeatureBit::of(task.bit as usize) else {
            unreachable!("a feature of a vertex");
        };
        let triangles = task.triangles(triangles, pairs);
        Self {
            k,
            own: triangles[side],
            over: triangles[1 - side],
        }
    }
}

/// The ends of two edges.
#[inline(always)]
fn ends_of_edges<'a>(task: &Task, triangles: [&'a [SmallTriangle]; 2], pairs: &[SmallPair]) -> [[&'a [f32; 4]; 2]; 2] {
    let [first, second] = task.triangles(triangles, pairs);
    let FeatureBit::Edges([k, l]) = FeatureBit::of(task.bit as usize) else {
        unreachable!("a feature of edges");
    };
    [first.edge(k), second.edge(l)]
}

/// A point for each of eight lanes.
#[inline(always)]
fn gather<'a, S: Simd, T>(simd: S, from: &[T; 8], point: impl Fn(&T) -> &'a [f32; 4]) -> Points<S> {
    let [x, y, z, _] = columns(simd, each_lane(|lane| point(&from[lane])));
    [x, y, z]
}

/// Lanes in which a corner may have a feature with the face that it is over.
#[inline(always)]
fn vertices_over<S: Simd>(simd: S, corners: &[Corner; 8], limits: &Limits) -> u32 {
    let p = gather(simd, corners, |c| c.own.corner(c.k));
    let next = gather(simd, corners, |c| c.own.corner((c.k + 1) % 3));
    let before = gather(simd, corners, |c| c.own.corner((c.k + 2) % 3));
    let face = EightTriangles::gather(simd, each_lane(|lane| corners[lane].over));
    let (over, normal) = (face.corners, face.direction());
    let inward = scale(normal, face.winding());
    let tilt = face.has_direction().select(face.tilt, splat(simd, ANY_TILT));
    let pad = splat(simd, limits.pad);
    let ways = [sub(p, over[0]), sub(p, over[1]), sub(p, over[2])];
    let height = dot(ways[0], normal);
    let error = norm1(ways[0]) * tilt + pad;
    // Comparisons with NaN are false, so the tests mark lanes without a feature.
    let mut none = height.simd_lt(splat(simd, limits.lowest) - error);
    none |= height.simd_gt(splat(simd, limits.highest) + error);
    let lateral = (splat(simd, limits.lateral) + error) * splat(simd, 1.0 + ERROR);
    for i in 0..3 {
        let edge = sub(over[(i + 1) % 3], over[i]);
        let across = dot(cross(inward, edge), ways[i]);
        none |= across.simd_lt(-(lateral * dot(edge, edge).sqrt()));
    }
    // The edges of the vertex must not lead below the face. Two of them are those of its own triangle.
    let below = splat(simd, BELOW as f32 + limits.rotation + ERROR) + tilt;
    for end in [next, before] {
        let edge = sub(end, p);
        none |= dot(edge, normal).simd_lt(-(below * dot(edge, edge).sqrt() + pad));
    }
    bitmask(!none)
}

/// Lanes in which two edges, each given by its ends, may be within the reach of each other.
#[inline(always)]
fn edges_near<S: Simd>(simd: S, ends: &[[[&[f32; 4]; 2]; 2]; 8], limits: &Limits) -> u32 {
    let (p, q) = (gather(simd, ends, |e| e[0][0]), gather(simd, ends, |e| e[1][0]));
    let u = sub(gather(simd, ends, |e| e[0][1]), p);
    let v = sub(gather(simd, ends, |e| e[1][1]), q);
    let (a, e, b) = (dot(u, u), dot(v, v), dot(u, v));
    let way = sub(p, q);
    let (c, f) = (dot(u, way), dot(v, way));
    let square = a * e - b * b;
    // The nearest points, as in `candidates::squared_distance`.
    let s = unit((b * f - c * e) / square);
    let t = unit((b * s + f) / e);
    let s = unit((b * t - c) / a);
    let apart = sub(add(way, scale(u, s)), scale(v, t));
    let most = splat(simd, limits.reach + limits.pad);
    let certain = square.simd_gt(splat(simd, PARALLEL) * a * e);
    bitmask(!(certain & dot(apart, apart).simd_gt(most * most)))
}

/// Eight pairs of triangles, by their corners and edges.
struct TwoTriangles<S: Simd> {
    a: [Points<S>; 3],
    b: [Points<S>; 3],
    /// Edges from each corner to the next.
    edges_a: [Points<S>; 3],
    edges_b: [Points<S>; 3],
}

impl<S: Simd> TwoTriangles<S> {
    #[inline(always)]
    fn new(simd: S, pairs: &[[&SmallTriangle; 2]; 8]) -> Self {
        let [a, b] = [Self::corners(simd, pairs, 0), Self::corners(simd, pairs, 1)];
        Self {
            edges_a: Self::edges(&a),
            edges_b: Self::edges(&b),
            a,
            b,
        }
    }

    /// The corners of the first or of the second triangles.
    #[inline(always)]
    fn corners(simd: S, pairs: &[[&SmallTriangle; 2]; 8], side: usize) -> [Points<S>; 3] {
        [
            gather(simd, pairs, |pair| pair[side].corner(0)),
            gather(simd, pairs, |pair| pair[side].corner(1)),
            gather(simd, pairs, |pair| pair[side].corner(2)),
        ]
    }

    #[inline(always)]
    fn edges([p, q, r]: &[Points<S>; 3]) -> [Points<S>; 3] {
        [sub(*q, *p), sub(*r, *q), sub(*p, *r)]
    }

    /// Lower bounds of their distances, along the normals of both and the common perpendiculars of their edges. `pad`
    /// bounds the rounding error of heights.
    #[inline(always)]
    fn gaps(&self, pad: f32) -> [f32; 8] {
        let simd = self.a[0][0].simd;
        let mut gap = self.gap_of_normal(&self.edges_a).max(self.gap_of_normal(&self.edges_b));
        for (i, j) in PAIRS_OF_EDGES {
            let (apart, axis) = self.gap_of_edges(i, j);
            gap = gap.max(length_along(apart, axis));
        }
        (gap - splat(simd, pad)).into()
    }

    /// The gap along the normal of the triangle with these edges.
    #[inline(always)]
    fn gap_of_normal(&self, edges: &[Points<S>; 3]) -> f32x8<S> {
        let axis = cross(edges[0], edges[1]);
        // From one corner, so that rounding errors are in proportion to the distance of the triangles.
        let of_a = each(
            #[inline(always)]
            |k| dot(axis, sub(self.a[k], self.a[0])),
        );
        let of_b = each(
            #[inline(always)]
            |k| dot(axis, sub(self.b[k], self.a[0])),
        );
        let gap = (least(of_b) - largest(of_a)).max(least(of_a) - largest(of_b));
        length_along(gap, axis)
    }

    /// The gap along the common perpendicular of edges `i` and `j`, times the length of that axis, and the axis.
    #[inline(always)]
    fn gap_of_edges(&self, i: usize, j: usize) -> (f32x8<S>, Points<S>) {
        let (edge_a, edge_b) = (self.edges_a[i], self.edges_b[j]);
        let axis = cross(edge_a, edge_b);
        // Heights over the first end of the first edge. Rounding turns the axis of edges that are almost parallel to
        // any direction, so both ends of an edge count.
        let end_a = dot(axis, edge_a);
        let third_a = -dot(axis, self.edges_a[(i + 2) % 3]);
        let start_b = dot(axis, sub(self.b[j], self.a[i]));
        let end_b = start_b + dot(axis, edge_b);
        let third_b = start_b - dot(axis, self.edges_b[(j + 2) % 3]);
        let of_a = [splat(end_a.simd, 0.0), end_a, third_a];
        let of_b = [start_b, end_b, third_b];
        let gap = (least(of_b) - largest(of_a)).max(least(of_a) - largest(of_b));
        (gap, axis)
    }
}

/// The pairs of an edge of one triangle and one of another.
const PAIRS_OF_EDGES: [(usize, usize); 9] = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0), (2, 1), (2, 2)];

/// A length along an axis, from its product with the length of the axis; 0 if the axis has no length.
#[inline(always)]
fn length_along<S: Simd>(product: f32x8<S>, axis: Points<S>) -> f32x8<S> {
    let (simd, square) = (product.simd, dot(axis, axis));
    let known = square.simd_gt(splat(simd, f32::MIN_POSITIVE));
    known.select(product / square.sqrt(), splat(simd, 0.0))
}

/// The numbers, limited to 0 to 1.
#[inline(always)]
fn unit<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    x.max(splat(x.simd, 0.0)).min(splat(x.simd, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::level::with_simd;
    use crate::testing::scenes::any_vector;
    use glam::Vec3;

    /// A point of a triangle.
    fn point_of(triangle: &SmallTriangle, random: &mut fastrand::Rng) -> Vec3 {
        let [p, q, r] = triangle.points();
        let (s, t) = (random.f32(), random.f32());
        let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
        p + s * (q - p) + t * (r - p)
    }

    #[test]
    fn no_points_of_two_triangles_are_nearer_than_their_gap() {
        let mut random = fastrand::Rng::with_seed(11);
        let (mut apart, mut nearest) = (0, f32::INFINITY);
        for round in 0..500 {
            // Ever flatter ones, some without any area.
            let flat = [1.0, 1.0e-2, 1.0e-5, 0.0][round % 4];
            let mut triangle = || {
                let [at, along, across] = [0; 3].map(|_| any_vector(&mut || random.f32()));
                SmallTriangle::of_corners([at, at + along, at + 0.5 * along + flat * across])
            };
            let triangles: [[SmallTriangle; 2]; 8] = std::array::from_fn(|_| [triangle(), triangle()]);
            let both = triangles.each_ref().map(|[a, b]| [a, b]);
            let gaps = with_simd!(simd => TwoTriangles::new(simd, &both).gaps(4.0e-6));
            for (gap, [a, b]) in gaps.into_iter().zip(both) {
                apart += u32::from(gap > 0.0);
                for _ in 0..50 {
                    let distance = point_of(a, &mut random).distance(point_of(b, &mut random));
                    assert!(gap <= distance, "round {round}: {gap} for a distance of {distance}");
                    nearest = nearest.min(distance / gap.max(1.0e-3));
                }
            }
        }
        assert!(apart > 1000 && nearest < 1.5, "{apart} apart, {nearest} times the gap");
    }

    #[test]
    fn triangles_with_a_common_point_have_no_gap() {
        let mut random = fastrand::Rng::with_seed(12);
        for round in 0..4000 {
            // From the same directions of edges to those that only rounding tells apart, and others.
            let turn = [0.0, 1.0e-7, 1.0e-6, 1.0e-5, 1.0e-3, 1.0][round % 6];
            let mut pair = || {
                let [at, along, across, aside] = [0; 4].map(|_| any_vector(&mut || random.f32()));
                let of_corners = SmallTriangle::of_corners;
                let a = of_corners([at, at + along, at + across]);
                let edge = (random.f32() + 0.2) * along + turn * any_vector(&mut || random.f32());
                let b = of_corners([Vec3::ZERO, edge, aside]);
                // Moved to where a point of one is a point of the other.
                let way = point_of(&a, &mut random) - point_of(&b, &mut random);
                [a, of_corners(b.points().map(|corner| corner + way))]
            };
            let triangles: [[SmallTriangle; 2]; 8] = std::array::from_fn(|_| pair());
            let both = triangles.each_ref().map(|[a, b]| [a, b]);
            let gaps = with_simd!(simd => TwoTriangles::new(simd, &both).gaps(4.0e-6));
            assert!(gaps.iter().all(|gap| *gap <= 0.0), "round {round}: {gaps:?}");
        }
    }
}
