//! Scan conversion of eight triangles at a time, as [`Spans`](super::spans::Spans) defines it.
//!
//! A [`Batch`] is eight triangles of the mesh. Seen along a direction it becomes [`ProjectedTriangles`], which give
//! eight rows of one of the triangles at a time, or a row of each. Each number comes from the same operations in the
//! same order as in `Spans`, so both agree in every bit, with any instruction set.

use crate::geometry::cluster::CLUSTER;
use crate::geometry::lanes::{Stored, StoredPoints, points};
use crate::simd::lanes::{
    Points, Select, Simd, SimdFrom, bitmask, bits, dot, each, f32x8, load, load_points, mask32x8, max, min, pick,
    splat, splat_point, store, store_points,
};
use fearless_simd::i32x8;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Triangles are edge-on if the cosine between normal and direction is smaller than this. Such a triangle, 4096 pixels
/// high, is 0.004 pixels wide.
const EDGE_ON: f32 = 1.0e-6;

/// The affine map from the mesh to pixels, and the axes of the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub columns: [Vec3; 3],
    pub origin: Vec3,
    pub axes: [Vec3; 3],
}

impl View {
    /// A point in pixels: x to the right, y up, height.
    pub fn project(&self, p: Vec3) -> Vec3 {
        self.columns[0] * p.x + self.columns[1] * p.y + self.columns[2] * p.z + self.origin
    }

    /// A unit normal in the axes of the image, if its triangle is to be drawn.
    pub fn facing(&self, normal: Vec3, two_sided: bool) -> Option<Vec3> {
        let [x, y, z] = self.axes.map(|axis| normal.dot(axis));
        let toward = if two_sided { z.abs() } else { z };
        (toward > EDGE_ON).then_some(Vec3::new(x, y, z))
    }
}

/// A [`View`] in all lanes.
#[derive(Clone, Copy)]
pub(super) struct ViewLanes<S: Simd> {
    columns: [Points<S>; 3],
    origin: Points<S>,
    axes: [Points<S>; 3],
}

impl<S: Simd> ViewLanes<S> {
    #[inline(always)]
    pub fn new(simd: S, view: &View) -> Self {
        Self {
            columns: each(|i| splat_point(simd, view.columns[i])),
            origin: splat_point(simd, view.origin),
            axes: each(|i| splat_point(simd, view.axes[i])),
        }
    }

    #[inline(always)]
    fn project(&self, p: Points<S>) -> Points<S> {
        let [x, y, z] = &self.columns;
        each(|i| x[i] * p[0] + y[i] * p[1] + z[i] * p[2] + self.origin[i])
    }
}

/// Eight triangles of a mesh. Unused lanes have a normal of zero, which faces no viewer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch {
    /// Unit normals.
    normals: StoredPoints,
    /// The first, second and third corners.
    corners: [StoredPoints; 3],
}

impl Batch {
    /// `triangle` gives the corners of a lane's triangle and its unit normal, if the lane is used.
    pub fn new(triangle: impl Fn(usize) -> Option<([Vec3; 3], Vec3)>) -> Self {
        let lanes: [([Vec3; 3], Vec3); CLUSTER] = std::array::from_fn(|lane| triangle(lane).unwrap_or_default());
        Self {
            normals: points(|lane| lanes[lane].1),
            corners: each(|k| points(|lane| lanes[lane].0[k])),
        }
    }

    /// One of the triangles, with its unit normal.
    pub fn triangle(&self, lane: usize) -> ([Vec3; 3], Vec3) {
        (each(|k| point(&self.corners[k], lane)), point(&self.normals, lane))
    }

    /// Looks at the triangles. Returns whether any of them is to be drawn; only then `projected` is set.
    #[inline(always)]
    pub fn look<S: Simd>(
        &self,
        simd: S,
        view: &ViewLanes<S>,
        two_sided: bool,
        projected: &mut ProjectedTriangles,
    ) -> bool {
        let normals = load_points(simd, &self.normals);
        let z = dot(normals, view.axes[2]);
        let toward = if two_sided { z.abs() } else { z };
        let faces = toward.simd_gt(splat(simd, EDGE_ON));
        projected.facing = bitmask(faces);
        if projected.facing == 0 {
            return false;
        }
        let corners = each(|k| view.project(load_points(simd, &self.corners[k])));
        let [a, b, c] = corners;
        let (low, high) = (min(min(a, b), c), max(max(a, b), c));
        let (row_low, row_high) = (ceil(low[1]), truncate(high[1]));
        let crosses = row_low.simd_le(row_high) & ceil(low[0]).simd_le(truncate(high[0]));
        projected.crossing = bitmask(faces & crosses);
        projected.rows = [store(row_low), store(row_high)];
        projected.corners = each(|k| store_points(corners[k]));
        projected.low = store_points(low);
        projected.high = store_points(high);

        // With counter-clockwise winding an upward edge has the triangle on its left, so it bounds the spans on the
        // right.
        let front = z.simd_gt(splat(simd, 0.0));
        let (p, q) = (pick(front, b, c), pick(front, c, b));
        let edges = [Edge::new(a, p), Edge::new(p, q), Edge::new(q, a)];
        let beside = |x| [x, splat(simd, 0.0), splat(simd, 0.0)];
        projected.left = two_of(each(|k| edges[k].down), &edges, beside(low[0]));
        projected.right = two_of(each(|k| edges[k].up), &edges, beside(high[0]));

        let steep = -(splat(simd, 1.0) / z);
        projected.x_slope = store(dot(normals, view.axes[0]) * steep);
        projected.y_slope = store(dot(normals, view.axes[1]) * steep);
        true
    }
}

/// Edges as lines, evaluated from their lower ends: x, y and slope.
struct Edge<S: Simd> {
    line: Points<S>,
    up: mask32x8<S>,
    down: mask32x8<S>,
}

impl<S: Simd> Edge<S> {
    #[inline(always)]
    fn new(from: Points<S>, to: Points<S>) -> Self {
        let dy = to[1] - from[1];
        let zero = splat(dy.simd, 0.0);
        let up = dy.simd_gt(zero);
        let (low, high) = (pick(up, from, to), pick(up, to, from));
        Self {
            // Meaningless for a level edge, which bounds no row.
            line: [low[0], low[1], (high[0] - low[0]) / (high[1] - low[1])],
            up,
            down: dy.simd_lt(zero),
        }
    }
}

/// The lines of the edges in a mask, at most two per lane; `beside` where a lane has fewer.
#[inline(always)]
fn two_of<S: Simd>(
    [first, second, third]: [mask32x8<S>; 3],
    edges: &[Edge<S>; 3],
    beside: Points<S>,
) -> [StoredPoints; 2] {
    let [a, b, c] = each(|k| edges[k].line);
    [
        store_points(pick(first, a, pick(second, b, beside))),
        store_points(pick(third, c, pick(first & second, b, beside))),
    ]
}

/// Eight triangles as seen along a direction. Corners are in pixels: x to the right, y up, height.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ProjectedTriangles {
    /// One bit for each triangle that is to be drawn.
    pub facing: u32,
    /// One bit for each of these triangles whose box contains a pixel centre.
    pub crossing: u32,
    /// The first and the last row that may have a covered pixel centre.
    rows: [Stored; 2],
    corners: [StoredPoints; 3],
    /// The least and the largest coordinates of the corners.
    low: StoredPoints,
    high: StoredPoints,
    /// Change of height per pixel to the right and per row.
    x_slope: Stored,
    y_slope: Stored,
    /// The lines that bound the spans, each as x, y and slope.
    left: [StoredPoints; 2],
    right: [StoredPoints; 2],
}

/// Rows of triangles: the i-th pixel of a row has the height `height + x_slope * i`.
pub(super) struct Rows {
    /// One bit for each row with a covered pixel.
    pub covered: u32,
    /// The first covered pixel.
    pub first: [i32; CLUSTER],
    /// The number of covered pixels less one.
    pub extent: [f32; CLUSTER],
    /// The height of the first covered pixel.
    pub height: [f32; CLUSTER],
}

impl ProjectedTriangles {
    /// The first and the last row that may have a covered pixel centre.
    #[inline(always)]
    pub fn rows(&self, lane: usize) -> (i32, i32) {
        (number(&self.rows[0], lane) as i32, number(&self.rows[1], lane) as i32)
    }

    #[inline(always)]
    pub fn corners(&self, lane: usize) -> [Vec3; 3] {
        each(|k| point(&self.corners[k], lane))
    }

    #[inline(always)]
    pub fn x_slope(&self, lane: usize) -> f32 {
        number(&self.x_slope, lane)
    }

    /// The least and the largest coordinates of all triangles that are drawn, joined with those of `bounds`.
    #[inline(always)]
    pub fn join_bounds<S: Simd>(&self, simd: S, [low, high]: [Points<S>; 2]) -> [Points<S>; 2] {
        let drawn = mask32x8::from_bitmask(simd, u64::from(self.facing));
        [
            pick(drawn, min(low, load_points(simd, &self.low)), low),
            pick(drawn, max(high, load_points(simd, &self.high)), high),
        ]
    }

    /// The number of rows of the triangle with the most, and how many calls of [`ProjectedTriangles::rows_of`] give all
    /// rows of all triangles.
    #[inline(always)]
    pub fn row_counts(&self) -> (i32, i32) {
        let (mut most, mut calls) = (0, 0);
        for lane in bits(self.crossing) {
            let (low, high) = self.rows(lane);
            most = most.max(high - low + 1);
            calls += (high - low) / CLUSTER as i32 + 1;
        }
        (most, calls)
    }

    /// The rows from `y` on of one triangle, of those that [`ProjectedTriangles::rows`] gives.
    #[inline(always)]
    pub fn rows_of<S: Simd>(&self, simd: S, lane: usize, y: i32) -> Rows {
        let rows = splat(simd, y as f32) + f32x8::simd_from(simd, LANES);
        self.scan(
            simd,
            rows,
            #[inline(always)]
            |stored| splat(simd, number(stored, lane)),
        )
    }

    /// The row with number `row`, from 0 on, of each triangle.
    #[inline(always)]
    pub fn row_of_each<S: Simd>(&self, simd: S, row: i32) -> Rows {
        let rows = load(simd, &self.rows[0]) + splat(simd, row as f32);
        let scanned = self.scan(
            simd,
            rows,
            #[inline(always)]
            |stored| load(simd, stored),
        );
        Rows {
            covered: scanned.covered & self.crossing,
            ..scanned
        }
    }

    /// Scans a row in each lane; `each` gives the numbers of the lanes' triangles.
    #[inline(always)]
    fn scan<S: Simd>(&self, simd: S, rows: f32x8<S>, each: impl Fn(&Stored) -> f32x8<S>) -> Rows {
        let [left, right] = [
            [line(&self.left[0], rows, &each), line(&self.left[1], rows, &each)],
            [line(&self.right[0], rows, &each), line(&self.right[1], rows, &each)],
        ];
        let (x_low, x_high) = (each(&self.low[0]), each(&self.high[0]));
        // Clamped to the range of i32, so that `first > last` still holds if the left bound is right of the right
        // bound.
        let left = left[0].max(left[1]).max(x_low).min(x_high + splat(simd, 1.0));
        let right = right[0].min(right[1]).min(x_high).max(splat(simd, -1.0));
        let (first, last) = (ceil(left), truncate(right));
        let [anchor_x, anchor_y, anchor_z] = &self.corners[0];
        let height = each(anchor_z)
            + each(&self.x_slope) * (first - each(anchor_x))
            + each(&self.y_slope) * (rows - each(anchor_y));
        // For a triangle almost edge-on the slopes are huge and the terms cancel badly. The corners bound the result.
        let height = height.max(each(&self.low[2])).min(each(&self.high[2]));
        Rows {
            covered: bitmask(first.simd_le(last) & rows.simd_le(each(&self.rows[1]))),
            first: i32x8::truncate_from(first).into(),
            extent: (last - first).into(),
            height: height.into(),
        }
    }
}

#[inline(always)]
fn line<S: Simd>([x, y, slope]: &StoredPoints, rows: f32x8<S>, each: &impl Fn(&Stored) -> f32x8<S>) -> f32x8<S> {
    each(x) + each(slope) * (rows - each(y))
}

/// The number of each lane.
pub(super) const LANES: [f32; CLUSTER] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

#[inline(always)]
fn number(stored: &Stored, lane: usize) -> f32 {
    stored.0[lane % CLUSTER]
}

#[inline(always)]
fn point([x, y, z]: &StoredPoints, lane: usize) -> Vec3 {
    Vec3::new(number(x, lane), number(y, lane), number(z, lane))
}

/// Numbers in the range of `i32`, rounded toward zero. `floor` and `ceil` are function calls with SSE2.
#[inline(always)]
fn truncate<S: Simd>(values: f32x8<S>) -> f32x8<S> {
    f32x8::float_from(i32x8::truncate_from(values))
}

/// The smallest integers not below `values`, which are in the range of `i32`.
#[inline(always)]
fn ceil<S: Simd>(values: f32x8<S>) -> f32x8<S> {
    let cut = truncate(values);
    let simd = values.simd;
    cut + cut.simd_lt(values).select(splat(simd, 1.0), splat(simd, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::projection::spans::{Row, Spans};
    use crate::simd::level::{baseline, with_simd};
    use glam::{DMat3, Quat};

    /// Triangles of all sizes. Corners of many are at pixel centres, so that edges are level or meet rows exactly.
    fn triangles(random: &mut fastrand::Rng) -> Vec<([Vec3; 3], Vec3)> {
        let reach = [0.02, 0.1, 0.9][random.usize(..3)];
        let snap = random.bool();
        (0..random.usize(1..=CLUSTER))
            .map(|_| {
                let mut coordinates = |reach: f32| Vec3::from([(); 3].map(|()| reach * (2.0 * random.f32() - 1.0)));
                let center = coordinates(1.0 - reach);
                let corners = [(); 3].map(|()| {
                    let corner = center + coordinates(reach);
                    if snap { (corner * 32.0).round() / 32.0 } else { corner }
                });
                let [a, b, c] = corners.map(Vec3::as_dvec3);
                (corners, (b - a).cross(c - a).normalize_or_zero().as_vec3())
            })
            .collect()
    }

    fn view(random: &mut fastrand::Rng) -> View {
        let rotation = if random.bool() {
            DMat3::IDENTITY
        } else {
            DMat3::from_quat(
                Quat::from_xyzw(random.f32(), random.f32(), random.f32(), 0.5)
                    .normalize()
                    .as_dquat(),
            )
        };
        View {
            columns: [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(|v| (v * 32.0).as_vec3()),
            origin: Vec3::splat(66.0),
            axes: [0, 1, 2].map(|i| rotation.row(i).as_vec3()),
        }
    }

    /// The covered rows of one lane, by both ways to ask for them.
    #[inline(always)]
    fn covered<S: Simd>(simd: S, projected: &ProjectedTriangles, lane: usize) -> [Vec<(i32, Row)>; 2] {
        let (low, high) = projected.rows(lane);
        let (mut eight, mut each) = (Vec::new(), Vec::new());
        let row = |rows: &Rows, k: usize| Row {
            first: rows.first[k],
            last: rows.first[k] + rows.extent[k] as i32,
            height: rows.height[k],
        };
        for y in (low..=high).step_by(CLUSTER) {
            let rows = projected.rows_of(simd, lane, y);
            eight.extend(bits(rows.covered).map(|k| (y + k as i32, row(&rows, k))));
        }
        for number in 0..projected.row_counts().0 {
            let rows = projected.row_of_each(simd, number);
            if rows.covered >> lane & 1 == 1 {
                each.push((low + number, row(&rows, lane)));
            }
        }
        [eight, each]
    }

    #[inline(always)]
    fn check<S: Simd>(simd: S, view: &View, triangles: &[([Vec3; 3], Vec3)], two_sided: bool) -> usize {
        let batch = Batch::new(|lane| triangles.get(lane).copied());
        let mut projected = ProjectedTriangles::default();
        let mut found = 0;
        batch.look(simd, &ViewLanes::new(simd, view), two_sided, &mut projected);
        for (lane, &(corners, normal)) in triangles.iter().enumerate() {
            assert_eq!(batch.triangle(lane), (corners, normal));
            let facing = view.facing(normal, two_sided);
            assert_eq!(projected.facing >> lane & 1 == 1, facing.is_some());
            let Some(normal) = facing else { continue };
            let corners = corners.map(|p| view.project(p));
            assert_eq!(projected.corners(lane), corners);
            let spans = Spans::new(corners, normal);
            assert_eq!(projected.crossing >> lane & 1 == 1, spans.is_some());
            let Some(spans) = spans else { continue };
            assert_eq!(projected.rows(lane), spans.rows);
            assert_eq!(projected.x_slope(lane).to_bits(), spans.x_slope.to_bits());
            let expected: Vec<(i32, Row)> = (spans.rows.0..=spans.rows.1)
                .map(|y| (y, spans.row(y)))
                .filter(|(_, row)| row.first <= row.last)
                .collect();
            assert_eq!(covered(simd, &projected, lane), [expected.clone(), expected.clone()]);
            found += expected.len();
        }
        assert_eq!(projected.facing >> triangles.len(), 0, "unused lanes");
        found
    }

    #[test]
    fn eight_triangles_have_the_spans_of_one() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut found = 0;
        for _ in 0..3000 {
            let (triangles, view, two_sided) = (triangles(&mut random), view(&mut random), random.bool());
            found += check(baseline(), &view, &triangles, two_sided);
            found += with_simd!(simd => check(simd, &view, &triangles, two_sided));
        }
        assert!(found > 100_000, "{found} rows");
    }

    #[test]
    fn bounds_hold_the_triangles_that_are_drawn() {
        let simd = baseline();
        let mut random = fastrand::Rng::with_seed(4);
        for _ in 0..1000 {
            let (triangles, view) = (triangles(&mut random), view(&mut random));
            let mut projected = ProjectedTriangles::default();
            let start = [splat_point(simd, Vec3::INFINITY), splat_point(simd, Vec3::NEG_INFINITY)];
            if !Batch::new(|lane| triangles.get(lane).copied()).look(
                simd,
                &ViewLanes::new(simd, &view),
                false,
                &mut projected,
            ) {
                assert_eq!(projected.facing, 0);
                continue;
            }
            let [low, high] = projected.join_bounds(simd, start).map(store_points);
            for lane in 0..CLUSTER {
                let drawn = projected.facing >> lane & 1 == 1;
                let expected = if drawn {
                    let [a, b, c] = projected.corners(lane);
                    (a.min(b).min(c), a.max(b).max(c))
                } else {
                    (Vec3::INFINITY, Vec3::NEG_INFINITY)
                };
                assert_eq!((point(&low, lane), point(&high, lane)), expected);
            }
        }
    }
}
