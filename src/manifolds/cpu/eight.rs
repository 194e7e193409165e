//! Which features pairs of triangles may have, in single precision, eight features at a time. All conditions are widened
//! by the slack and by bounds of the rounding errors.

use super::candidates::{CROSSING, Part, Parts};
use super::feature::BELOW;
use super::search::Limits;
use crate::simd::lanes::{
    Points, Simd, SimdBase, SimdFloat, SimdFrom, add, bitmask, bits, cross, dot, f32x8, norm1, scale, splat, sub,
};
use glam::Vec3;

/// A triangle in single precision, in the axes of the pair's first body.
#[derive(Clone, Copy, Default)]
pub struct SmallTriangle {
    pub number: u32,
    pub corners: [Vec3; 3],
    /// Outward unit normal; zero where single precision does not determine it.
    pub normal: Vec3,
    /// Error bound of a height over the plane, per distance to a corner.
    pub tilt: f32,
    /// 1 if the corners are counter-clockwise seen from outside, else -1.
    pub winding: f32,
}

impl SmallTriangle {
    /// The ends of edge `k`.
    #[inline(always)]
    fn edge(&self, k: usize) -> [Vec3; 2] {
        [self.corners[k], self.corners[(k + 1) % 3]]
    }
}

/// The tilt of a triangle whose normal is not known: all heights are possible.
pub const ANY_TILT: f32 = 4.0;

/// Relative rounding error of these tests.
const ERROR: f32 = 1.0e-5;
/// The squared sine of the angle between two edges below which their nearest points are uncertain.
const PARALLEL: f32 = 1.0e-3;

/// Pairs of triangles with what they may have, and memory kept between calls.
#[derive(Default)]
pub struct Narrowing {
    vertices: Vec<Task>,
    edges: Vec<Task>,
}

/// A feature of a pair.
#[derive(Clone, Copy)]
struct Task {
    pair: u32,
    bit: u32,
}

/// Two triangles, as indices into the triangles of the first and of the second body, and what they may have.
pub type SmallPair = ([u32; 2], Parts);

impl Narrowing {
    /// Removes features that pairs cannot have, and then pairs that have nothing.
    #[inline(always)]
    pub fn run<S: Simd>(
        &mut self,
        simd: S,
        triangles: &[Vec<SmallTriangle>; 2],
        pairs: &mut Vec<SmallPair>,
        limits: &Limits,
    ) {
        let Self { vertices, edges } = self;
        vertices.clear();
        edges.clear();
        for (pair, (_, parts)) in (0..).zip(pairs.iter_mut()) {
            for bit in bits(u32::from(*parts & !CROSSING)) {
                let tasks = if bit < 6 { &mut *vertices } else { &mut *edges };
                tasks.push(Task { pair, bit: bit as u32 });
            }
            *parts &= CROSSING;
        }
        for tasks in vertices.chunks(8) {
            let eight = eight_of(tasks);
            let corners = eight.map(|task| Corner::new(task, triangles, pairs));
            add_parts(pairs, eight, vertices_over(simd, &corners, limits));
        }
        for tasks in edges.chunks(8) {
            let eight = eight_of(tasks);
            let ends = eight.map(|task| ends_of_edges(task, triangles, pairs));
            add_parts(pairs, eight, edges_near(simd, &ends, limits));
        }
        pairs.retain(|(_, parts)| *parts != 0);
    }
}

/// Up to eight tasks. The last fills up the lanes.
#[inline(always)]
fn eight_of(tasks: &[Task]) -> [&Task; 8] {
    std::array::from_fn(|lane| &tasks[lane.min(tasks.len() - 1)])
}

/// Gives pairs the features of the tasks in these lanes.
#[inline(always)]
fn add_parts(pairs: &mut [SmallPair], tasks: [&Task; 8], lanes: u32) {
    for lane in bits(lanes) {
        let Task { pair, bit } = tasks[lane];
        pairs[*pair as usize].1 |= 1 << bit;
    }
}

impl Task {
    #[inline(always)]
    fn triangles<'a>(&self, triangles: &'a [Vec<SmallTriangle>; 2], pairs: &[SmallPair]) -> [&'a SmallTriangle; 2] {
        let [i, j] = pairs[self.pair as usize].0;
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
    fn new(task: &Task, triangles: &'a [Vec<SmallTriangle>; 2], pairs: &[SmallPair]) -> Self {
        let Part::Vertex { side, k } = Part::of(task.bit as usize) else {
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
fn ends_of_edges(task: &Task, triangles: &[Vec<SmallTriangle>; 2], pairs: &[SmallPair]) -> [[Vec3; 2]; 2] {
    let [first, second] = task.triangles(triangles, pairs);
    let Part::Edges([k, l]) = Part::of(task.bit as usize) else {
        unreachable!("a feature of edges");
    };
    [first.edge(k), second.edge(l)]
}

/// A point for each of eight lanes.
#[inline(always)]
fn gather<S: Simd, T>(simd: S, from: &[T; 8], point: impl Fn(&T) -> Vec3) -> Points<S> {
    let points: [Vec3; 8] = std::array::from_fn(|lane| point(&from[lane]));
    [
        f32x8::simd_from(simd, points.map(|p| p.x)),
        f32x8::simd_from(simd, points.map(|p| p.y)),
        f32x8::simd_from(simd, points.map(|p| p.z)),
    ]
}

/// Lanes in which a corner may have a feature with the face that it is over.
#[inline(always)]
fn vertices_over<S: Simd>(simd: S, corners: &[Corner; 8], limits: &Limits) -> u32 {
    let p = gather(simd, corners, |c| c.own.corners[c.k]);
    let next = gather(simd, corners, |c| c.own.corners[(c.k + 1) % 3]);
    let before = gather(simd, corners, |c| c.own.corners[(c.k + 2) % 3]);
    let over = [
        gather(simd, corners, |c| c.over.corners[0]),
        gather(simd, corners, |c| c.over.corners[1]),
        gather(simd, corners, |c| c.over.corners[2]),
    ];
    let normal = gather(simd, corners, |c| c.over.normal);
    let winding = f32x8::simd_from(simd, std::array::from_fn(|lane| corners[lane].over.winding));
    let inward = scale(normal, winding);
    let tilt = f32x8::simd_from(simd, std::array::from_fn(|lane| corners[lane].over.tilt));
    let pad = splat(simd, limits.pad);
    let ways = [sub(p, over[0]), sub(p, over[1]), sub(p, over[2])];
    let height = dot(ways[0], normal);
    let error = norm1(ways[0]) * tilt + pad;
    // Comparisons with NaN are false, so these say where there is no feature.
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
fn edges_near<S: Simd>(simd: S, ends: &[[[Vec3; 2]; 2]; 8], limits: &Limits) -> u32 {
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

/// The numbers, limited to 0 to 1.
#[inline(always)]
fn unit<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    x.max(splat(x.simd, 0.0)).min(splat(x.simd, 1.0))
}
