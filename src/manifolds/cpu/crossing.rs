//! Where triangles cross: segments, in double precision, four pairs of triangles at a time.

use super::side::{Side, Triangle};
use crate::simd::lanes::{
    DPoints, Select, Simd, SimdBase, SimdFloat, SimdMask, abs, add, bitmask_of_four, bits, cross, dot, each, f64x4,
    four_points, heights, largest, mask64x4, max, min, pick, scale, sub,
};
use glam::DVec3;

/// Largest gap between the boxes of triangles that cross, in units of the error of heights: about a millionth of the
/// bodies' size.
const BOX_GAP: f64 = 1.0e8;
/// Rounding error of a coordinate, relative to the largest.
const COORDINATE_ERROR: f64 = 1.0e-12;
/// Least square of the sine between two planes that have a common line.
const MIN_LINE: f64 = 1.0e-24;

/// The segment in which two triangles cross, oriented along the cross product of their normals.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    pub ends: [DVec3; 2],
    pub triangles: [u32; 2],
    /// The crossing that each end shares with the next segment.
    pub keys: [Key; 2],
}

/// Key of a crossing, at which a contour passes from one triangle to the next: an edge of one side pierces a triangle
/// of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Key(u64);

impl Key {
    #[inline(always)]
    fn new(side: usize, edge: u32, triangle: u32) -> Self {
        debug_assert!(triangle <= u32::MAX / 2, "meshes have fewer triangles");
        Self(u64::from(edge) << 32 | u64::from(triangle) << 1 | side as u64)
    }

    /// The side whose edge pierces a triangle of the other, and the edge.
    pub fn edge(self) -> (usize, u32) {
        ((self.0 & 1) as usize, (self.0 >> 32) as u32)
    }

    /// A number that no other crossing has.
    #[inline(always)]
    pub fn number(self) -> u64 {
        self.0
    }
}

/// Pairs of triangles that may cross, as indices into lists of triangles.
#[derive(Default)]
pub struct Crossings {
    pairs: Vec<[u32; 2]>,
}

impl Crossings {
    pub fn clear(&mut self) {
        self.pairs.clear();
    }

    #[inline(always)]
    pub fn push(&mut self, triangles: [u32; 2]) {
        self.pairs.push(triangles);
    }

    /// Appends the segments of the pairs that cross and are not coplanar, in order. `triangles` are the lists. Heights
    /// up to `rounding` are ties. Ties are broken as if the first body were slightly smaller: its corners lie below the
    /// second's planes, and the second's above its own. So contours are closed even if faces of both bodies are
    /// coplanar.
    #[inline(always)]
    pub fn segments<S: Simd>(
        &self,
        simd: S,
        sides: &[Side; 2],
        triangles: [&[Triangle]; 2],
        rounding: f64,
        segments: &mut Vec<Segment>,
    ) {
        for some in self.pairs.chunks(4) {
            // Unused lanes repeat the last pair.
            let pair = |lane: usize| {
                let [i, j] = some[lane.min(some.len() - 1)];
                [&triangles[0][i as usize], &triangles[1][j as usize]]
            };
            let pairs = [pair(0), pair(1), pair(2), pair(3)];
            let crossed = FourCrossings::new(simd, &pairs, rounding);
            for lane in bits(crossed.lanes & ((1 << some.len()) - 1)) {
                segments.push(crossed.segment(sides, pairs[lane], lane));
            }
        }
    }
}

/// Four triangles.
struct FourTriangles<S: Simd> {
    corners: [DPoints<S>; 3],
    normal: DPoints<S>,
    /// For each edge, whether it is followed from its second corner.
    backward: [mask64x4<S>; 3],
}

impl<S: Simd> FourTriangles<S> {
    #[inline(always)]
    fn new(simd: S, four: [&Triangle; 4]) -> Self {
        let [a, b, c, d] = four;
        let corner = |k: usize| four_points(simd, [a.corners[k], b.corners[k], c.corners[k], d.corners[k]]);
        Self {
            corners: [corner(0), corner(1), corner(2)],
            normal: four_points(simd, [a.normal, b.normal, c.normal, d.normal]),
            backward: each(|k| {
                let bit = |triangle: &Triangle| u64::from(triangle.backward >> k & 1);
                mask64x4::from_bitmask(simd, bit(a) | bit(b) << 1 | bit(c) << 2 | bit(d) << 3)
            }),
        }
    }

    /// The lower and the upper corners of the boxes.
    #[inline(always)]
    fn boxes(&self) -> [DPoints<S>; 2] {
        let [p, q, r] = self.corners;
        [min(min(p, q), r), max(max(p, q), r)]
    }
}

/// Where edges of triangles cross the planes of others.
struct Chord<S: Simd> {
    /// The two points in order along the common line, and their places on it.
    points: [DPoints<S>; 2],
    at: [f64x4<S>; 2],
    /// Lanes in which the third, and in which the second corner is alone on its side; else it is the first.
    alone: [u32; 2],
    /// Lanes in which the points were swapped.
    swapped: u32,
}

impl<S: Simd> Chord<S> {
    /// `heights` are those over the other planes, `above` tells which count as above. They are not all on one side.
    #[inline(always)]
    fn new(four: &FourTriangles<S>, heights: &[f64x4<S>; 3], above: &[mask64x4<S>; 3], line: DPoints<S>) -> Self {
        let third = !(above[0] ^ above[1]);
        let second = !(above[0] ^ above[2]) & !third;
        let [p, q, r] = four.corners;
        let [hp, hq, hr] = *heights;
        let [pq, qr, rp] = four.backward;
        // The first crossing edge starts at the first corner, or at the second if the third is alone. The last starts
        // at the third corner, or at the second if the second is alone.
        let first = crossing(
            [pick(third, q, p), pick(third, r, q)],
            [third.select(hq, hp), third.select(hr, hq)],
            (third & qr) | (!third & pq),
        );
        let last = crossing(
            [pick(second, q, r), pick(second, r, p)],
            [second.select(hq, hr), second.select(hr, hp)],
            (second & qr) | (!second & rp),
        );
        let at = [dot(line, first), dot(line, last)];
        let swapped = at[0].simd_gt(at[1]);
        Self {
            points: [pick(swapped, last, first), pick(swapped, first, last)],
            at: [swapped.select(at[1], at[0]), swapped.select(at[0], at[1])],
            alone: [bitmask_of_four(third), bitmask_of_four(second)],
            swapped: bitmask_of_four(swapped),
        }
    }

    /// The edge, by its place in the triangle, on which the first or second point of a lane lies.
    #[inline(always)]
    fn edge(&self, lane: usize, end: usize) -> usize {
        let [third, second] = self.alone.map(|lanes| lanes >> lane & 1 == 1);
        let swapped = (self.swapped >> lane & 1) as usize;
        [[0, 1][usize::from(third)], [2, 1][usize::from(second)]][end ^ swapped]
    }
}

/// Where edges, each from one point to another, cross planes over which these have the heights. Both triangles of an
/// edge compute the point from the same end, so they get the same bits: `backward` tells where it is the second.
#[inline(always)]
fn crossing<S: Simd>([p, q]: [DPoints<S>; 2], [hp, hq]: [f64x4<S>; 2], backward: mask64x4<S>) -> DPoints<S> {
    let simd = hp.simd;
    let (from, to) = (pick(backward, q, p), pick(backward, p, q));
    let (height, other) = (backward.select(hq, hp), backward.select(hp, hq));
    let at = height / (height - other);
    // If both heights are zero, any point of the edge will do.
    let known = at.simd_eq(at);
    let at = at.max(f64x4::splat(simd, 0.0)).min(f64x4::splat(simd, 1.0));
    let at = known.select(at, f64x4::splat(simd, 0.5));
    add(from, scale(sub(to, from), at))
}

/// Four pairs of triangles that may cross.
struct FourCrossings<S: Simd> {
    /// Lanes in which they cross.
    lanes: u32,
    ends: [DPoints<S>; 2],
    /// Lanes in which the start, and the end, is where an edge of the second triangle pierces the first.
    of_second: [u32; 2],
    chords: [Chord<S>; 2],
}

impl<S: Simd> FourCrossings<S> {
    #[inline(always)]
    fn new(simd: S, pairs: &[[&Triangle; 2]; 4], rounding: f64) -> Self {
        let [p, q, r, s] = pairs;
        let a = FourTriangles::new(simd, [p[0], q[0], r[0], s[0]]);
        let b = FourTriangles::new(simd, [p[1], q[1], r[1], s[1]]);
        let heights_a = heights(&a.corners, b.corners[0], b.normal);
        let heights_b = heights(&b.corners, a.corners[0], a.normal);
        let tie = f64x4::splat(simd, rounding);
        let above_a = each(|k| heights_a[k].simd_gt(tie));
        let above_b = each(|k| heights_b[k].simd_ge(-tie));
        let on_both = |above: &[mask64x4<S>; 3]| (above[0] ^ above[1]) | (above[0] ^ above[2]);
        let line = cross(a.normal, b.normal);
        let square = dot(line, line);
        let may_cross = on_both(&above_a) & on_both(&above_b) & square.simd_ge(f64x4::splat(simd, MIN_LINE));
        // Rounding makes almost parallel triangles cross that are apart.
        let may_cross = may_cross & boxes_are_within(&a, &b, BOX_GAP * rounding);

        let chord_a = Chord::new(&a, &heights_a, &above_a, line);
        let chord_b = Chord::new(&b, &heights_b, &above_b, line);
        // At ties the first body, which counts as smaller, ends first.
        let slack = tie * square.sqrt();
        let starts = chord_a.at[0].simd_lt(chord_b.at[0] - slack);
        let ends = chord_a.at[1].simd_gt(chord_b.at[1] + slack);
        let from = starts.select(chord_b.at[0], chord_a.at[0]);
        let to = ends.select(chord_b.at[1], chord_a.at[1]);
        Self {
            lanes: bitmask_of_four(may_cross & from.simd_lt(to)),
            ends: [
                pick(starts, chord_b.points[0], chord_a.points[0]),
                pick(ends, chord_b.points[1], chord_a.points[1]),
            ],
            of_second: [bitmask_of_four(starts), bitmask_of_four(ends)],
            chords: [chord_a, chord_b],
        }
    }

    /// The segment of one lane.
    #[inline(always)]
    fn segment(&self, sides: &[Side; 2], pair: [&Triangle; 2], lane: usize) -> Segment {
        let key = |end: usize| {
            let side = (self.of_second[end] >> lane & 1) as usize;
            let edges = &sides[side].features.triangle_edges[pair[side].number as usize];
            let edge = edges[self.chords[side].edge(lane, end)];
            Key::new(side, edge, pair[1 - side].number)
        };
        let point = |[x, y, z]: &DPoints<S>| DVec3::new(x[lane], y[lane], z[lane]);
        Segment {
            ends: [point(&self.ends[0]), point(&self.ends[1])],
            triangles: pair.map(|triangle| triangle.number),
            keys: [key(0), key(1)],
        }
    }
}

/// Lanes in which the boxes of two triangles are no farther apart than `distance` along any axis, up to rounding.
#[inline(always)]
fn boxes_are_within<S: Simd>(a: &FourTriangles<S>, b: &FourTriangles<S>, distance: f64) -> mask64x4<S> {
    let ([low_a, high_a], [low_b, high_b]) = (a.boxes(), b.boxes());
    let error = largest(abs(low_a)) + largest(abs(low_b));
    let gap = largest(max(sub(low_a, high_b), sub(low_b, high_a)));
    let simd = gap.simd;
    gap.simd_le(f64x4::splat(simd, distance) + f64x4::splat(simd, COORDINATE_ERROR) * error)
}

#[cfg(test)]
mod tests {
    use super::super::near::tests::random_pairs;
    use super::super::pair::ROUNDING;
    use super::*;
    use crate::geometry::triangle::intersect;
    use crate::simd::level::with_simd;

    #[test]
    fn triangles_cross_where_the_test_of_two_triangles_finds_their_intersection() {
        let (mut tests, mut hits) = (0, 0);
        random_pairs(40, |round, pair| {
            let sides = &pair.sides;
            let triangles = [0, 1].map(|i: usize| {
                let count = sides[i].features.triangles.len() as u32;
                (0..count).map(|t| sides[i].triangle(t)).collect::<Vec<_>>()
            });
            let mut crossings = Crossings::default();
            let mut expected = vec![];
            for (i, a) in (0..).zip(&triangles[0]) {
                for (j, b) in (0..).zip(&triangles[1]) {
                    crossings.push([i, j]);
                    let both = intersect(&a.corners, &b.corners).filter(|both| !both.coplanar);
                    expected.extend(both.map(|both| ([i, j], [both.start, both.end])));
                    tests += 1;
                }
            }
            let mut found = vec![];
            let lists = triangles.each_ref().map(Vec::as_slice);
            let rounding = ROUNDING * f64::from(pair.pose.size);
            with_simd!(simd => crossings.segments(simd, sides, lists, rounding, &mut found));
            assert!(
                found.iter().map(|s| s.triangles).eq(expected.iter().map(|e| e.0)),
                "round {round}"
            );
            for (segment, (_, [start, end])) in found.iter().zip(expected) {
                let [p, q] = segment.ends;
                let error = |p: DVec3, q: DVec3| p.distance(start).max(q.distance(end));
                assert!(error(p, q).min(error(q, p)) < 1.0e-9, "round {round}: {segment:?}");
                let [a, b] = [0, 1].map(|i| triangles[i][segment.triangles[i] as usize].normal);
                assert!(a.cross(b).dot(q - p) > 0.0, "round {round}: {segment:?} runs back");
                hits += 1;
            }
        });
        assert!(hits > 1000, "{hits} of {tests} cross");
    }
}
