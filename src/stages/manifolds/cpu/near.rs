//! Pairs of triangles that are near each other, down the trees of both meshes.

use super::side::{Side, Triangle};
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::stages::angles::PAD;
use crate::stages::mesh_arena::Points;
use crate::stages::triangle_test::cpu::descent::Descent;
use crate::stages::triangle_test::cpu::lanes::{
    Rows, bits, boxes_meet, cross, dot, each, lane_of, max, min, norm1, splat, sub,
};
use crate::stages::triangle_test::cpu::placed::unit_of;
use crate::stages::triangle_test::cpu::tree::{Tree, Way};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// Meshes of so many clusters at most have nodes too round for slabs to be worth their time.
const COARSE: usize = 300;

/// How the bodies of a pair lie to each other, in single precision.
pub struct Setting {
    /// Turns the second body's axes into the first's.
    pub rotation: Mat3,
    /// From the first body's centre of mass to the second's, in the first's axes, metres.
    pub translation: Vec3,
    /// Sum of the bounding radii, metres.
    pub size: f32,
}

/// Which pairs of triangles matter.
pub struct Window {
    /// Both meet this box.
    pub around: Aabb,
    /// The first reaches farther this way than the second does the other way. Zero for any pair.
    pub way: Vec3,
}

/// Memory kept between pairs, and the result.
#[derive(Default)]
pub struct Near {
    descent: Descent,
    /// Clusters of the second body, as the descent lists them.
    seconds: Vec<Placed>,
    /// Triangles of the first and of the second body that are near any of the other.
    triangles: [Vec<Triangle>; 2],
    /// Places in `triangles`.
    pairs: Vec<[u32; 2]>,
}

impl Near {
    /// Finds all pairs of triangles that may be no farther apart than `reach` and are in the window; some are a
    /// little farther.
    pub fn run(&mut self, sides: &[Side; 2], setting: &Setting, reach: f32, window: Option<&Window>) {
        let Self {
            descent,
            seconds,
            triangles: [firsts_near, seconds_near],
            pairs,
        } = self;
        firsts_near.clear();
        seconds_near.clear();
        pairs.clear();
        seconds.clear();
        let pad = PAD * setting.size;
        let reach = reach + pad;
        let [tree_a, tree_b] = trees(sides, setting, reach);
        descent.run(&tree_a, &tree_b);
        let places = [0, 1].map(|i| Rows::new(sides[i].matrix().as_mat3()));
        seconds.extend(
            descent
                .second()
                .map(|cluster| Placed::new(&sides[1], &places[1], cluster, window)),
        );
        for (cluster, others) in descent.pairs() {
            let mut a = Placed::new(&sides[0], &places[0], cluster, window);
            if a.lanes == 0 {
                continue;
            }
            for &other in others {
                let b = &mut seconds[other as usize];
                for i in bits(a.lanes) {
                    let near = a.near(i, b, reach, pad);
                    if near != 0 {
                        let first = a.complete(&sides[0], i, firsts_near);
                        pairs.extend(bits(near).map(|j| [first, b.complete(&sides[1], j, seconds_near)]));
                    }
                }
            }
        }
    }

    /// What [`Near::run`] has found.
    pub fn pairs(&self) -> impl Iterator<Item = [&Triangle; 2]> {
        let [a, b] = &self.triangles;
        self.pairs.iter().map(|&[i, j]| [&a[i as usize], &b[j as usize]])
    }
}

/// Eight triangles in single precision, about the first body's centre of mass, to find out which matter; those get double
/// precision.
struct Placed {
    corners: [Points; 3],
    /// Cross products of two sides, and their lengths.
    normal: Points,
    length: f32x8,
    /// How wrong a height over the plane can be beside the way to the corner, both times the normal's length.
    slack: f32x8,
    min: Points,
    max: Points,
    /// From where to where they reach along [`Window::way`].
    first_along: f32x8,
    last_along: f32x8,
    /// Lanes that count.
    lanes: u32,
    /// Triangle in lane 0.
    first: u32,
    /// Where the lanes are in double precision, or [`NOWHERE`].
    complete: [u32; CLUSTER],
}

const NOWHERE: u32 = u32::MAX;

/// What single precision costs a product of two vectors, relative to their lengths.
const ERROR: f32 = 2.0e-6;

impl Placed {
    fn new(side: &Side, place: &Rows, cluster: u32, window: Option<&Window>) -> Self {
        let own = &side.slot.lanes.clusters[cluster as usize];
        let at = splat(side.place(own.origin).as_vec3());
        let [p, q, r] = each(|k| place.times(own.corners[k]));
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        let [p, q, r] = each(|k| each(|i| [p, q, r][k][i] + at[i]));
        let mut placed = Self {
            corners: [p, q, r],
            normal,
            length: dot(normal, normal).sqrt(),
            slack: f32x8::splat(ERROR) * norm1(u) * norm1(v),
            min: min(p, min(q, r)),
            max: max(p, max(q, r)),
            first_along: f32x8::ZERO,
            last_along: f32x8::ZERO,
            lanes: own.lanes,
            first: cluster * CLUSTER as u32,
            complete: [NOWHERE; CLUSTER],
        };
        if let Some(Window { around, way }) = window {
            let meet = boxes_meet(placed.min, placed.max, splat(around.min), splat(around.max));
            placed.lanes &= meet.to_bitmask();
            let along = each(|k| dot(splat(*way), placed.corners[k]));
            placed.first_along = along[0].fast_min(along[1]).fast_min(along[2]);
            placed.last_along = along[0].fast_max(along[1]).fast_max(along[2]);
        }
        placed
    }

    /// Lanes of `other` that are near the triangle in lane `i`: neither their boxes nor a plane of one of the two part them by
    /// more than `reach`, and they are in the window, whose `pad` is for rounding.
    #[inline]
    fn near(&self, i: usize, other: &Self, reach: f32, pad: f32) -> u32 {
        let (low, high) = (lane_of(&self.min, i), lane_of(&self.max, i));
        let last = f32x8::splat(self.last_along.as_array()[i] + pad);
        let boxes = boxes_meet(splat(low - reach), splat(high + reach), other.min, other.max);
        let boxes = (boxes & other.first_along.simd_le(last)).to_bitmask();
        if boxes & other.lanes == 0 {
            return 0;
        }
        // No two points of triangles whose boxes are near are farther apart.
        let spread = f32x8::splat((high - low).element_sum() + reach)
            + (other.max[0] - other.min[0])
            + (other.max[1] - other.min[1])
            + (other.max[2] - other.min[2]);
        let reaches = f32x8::splat(reach);
        let at = |values: f32x8| f32x8::splat(values.as_array()[i]);
        let normal = splat(lane_of(&self.normal, i));
        let corner = each(|k| splat(lane_of(&self.corners[k], i)));
        let beyond = |heights: [f32x8; 3], most: f32x8| {
            let low = heights[0].fast_min(heights[1]).fast_min(heights[2]);
            let high = heights[0].fast_max(heights[1]).fast_max(heights[2]);
            low.simd_gt(most) | high.simd_lt(-most)
        };
        let over_own = each(|k| dot(normal, sub(other.corners[k], corner[0])));
        let over_other = each(|k| dot(other.normal, sub(corner[k], other.corners[0])));
        let apart = beyond(over_own, reaches * at(self.length) + spread * at(self.slack))
            | beyond(over_other, reaches * other.length + spread * other.slack);
        boxes & other.lanes & !apart.to_bitmask()
    }

    /// The place of lane `i` in the list of triangles.
    #[inline]
    fn complete(&mut self, side: &Side, i: usize, triangles: &mut Vec<Triangle>) -> u32 {
        if self.complete[i] == NOWHERE {
            self.complete[i] = triangles.len() as u32;
            triangles.push(side.triangle(self.first + i as u32));
        }
        self.complete[i]
    }
}

/// Both trees, whose nodes are found to touch if they are no farther apart than `reach`.
fn trees<'a>(sides: &[Side<'a>; 2], setting: &Setting, reach: f32) -> [Tree<'a>; 2] {
    let unit = unit_of(setting.size);
    let clusters = sides.each_ref().map(|side| side.slot.lanes.clusters.len());
    let slabs = clusters[0].max(clusters[1]) > COARSE;
    let back = setting.rotation.transpose();
    let ways = [
        (back, -(back * setting.translation)),
        (setting.rotation, setting.translation),
    ];
    [0, 1].map(|i| {
        let (rotation, translation) = ways[i];
        let way = Way {
            rotation,
            translation: unit * translation,
            // No support axis, and nothing beyond it.
            axis: Vec3::ZERO,
            least: f32::NEG_INFINITY,
        };
        Tree::new(
            &sides[i].slot.lanes,
            i == 1,
            unit * sides[i].scale,
            way,
            unit * reach,
            slabs,
        )
    })
}
