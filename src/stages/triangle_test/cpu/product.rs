//! Pairs of triangles that single precision cannot tell apart.

use super::cull::{self, Other};
use super::lanes::{Rows, bits, boxes_meet, cross, dot, max, min, norm1, splat, sub};
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::stages::angles::PAD;
use crate::stages::mesh_arena::{Cluster, MeshArena, MeshLanes, Points, points};
use crate::stages::state::{Bodies, NearPair};
use glam::{Mat3, Vec3};
use wide::f32x8;

/// Memory kept between pairs.
#[derive(Default)]
pub struct Scratch {
    nodes: Vec<u32>,
    clusters: Vec<u32>,
    a: Vec<Placed>,
    b: Vec<Placed>,
    boxes: Vec<[Points; 2]>,
    /// The result: triangles of the first and second mesh.
    pub candidates: Vec<[u32; 2]>,
}

/// Eight triangles in the axes of the pair's first body, about its centre of mass.
struct Placed {
    /// Triangle in lane 0.
    first: u32,
    corners: [Points; 3],
    min: Points,
    max: Points,
    normal: Points,
    /// How wrong a height over the triangle's plane, times the normal's length, can be.
    tolerance: f32x8,
    /// Lanes that still matter.
    lanes: u32,
    /// Around those lanes.
    aabb: Aabb,
}

/// Error of a placed coordinate, relative to the sum of the bounding radii: a handful of roundings of `2^-24`.
const PLACING: f32 = 1.0e-6;

/// Fills `scratch.candidates` and tells how many pairs of triangles had overlapping boxes.
pub fn candidates(bodies: &Bodies, meshes: &MeshArena, pair: &NearPair, scratch: &mut Scratch) -> u64 {
    let Scratch {
        nodes,
        clusters,
        a,
        b,
        boxes,
        candidates,
    } = scratch;
    candidates.clear();
    a.clear();
    b.clear();
    let [ia, ib] = pair.bodies.map(|i| i as usize);
    let [lanes_a, lanes_b] = [ia, ib].map(|i| &meshes[bodies.mesh[i]].lanes);
    let (scale_a, scale_b) = (bodies.scale[ia], bodies.scale[ib]);
    let size = bodies.radius[ia] + bodies.radius[ib];
    let pad = PAD * size;

    let back = pair.rotation.transpose();
    let a_from_b = Other {
        rotation: back,
        translation: -(back * pair.translation),
        aabb: scaled(lanes_b.aabb, scale_b),
        center: pair.translation,
        radius: bodies.radius[ib],
        axis: pair.axis,
        least: pair.b_above,
        pad,
    };
    let b_from_a = Other {
        rotation: pair.rotation,
        translation: pair.translation,
        aabb: scaled(lanes_a.aabb, scale_a),
        center: a_from_b.translation,
        radius: bodies.radius[ia],
        axis: -(back * pair.axis),
        least: pair.translation.dot(pair.axis) - pair.a_below,
        pad,
    };
    let reach = |lanes: &MeshLanes, scale: Vec3| 3f32.sqrt() * lanes.longest_side * scale.abs().max_element();
    let placing = Placing {
        error: PLACING * size,
        reach: reach(lanes_a, scale_a) + reach(lanes_b, scale_b),
        pad,
    };

    cull::clusters(lanes_a, scale_a, &a_from_b, nodes, clusters);
    let place_a = Place::new(Mat3::from_diagonal(scale_a), Vec3::ZERO);
    let mut around_a = Aabb::EMPTY;
    for &c in clusters.iter() {
        let mut placed = place_a.cluster(lanes_a, c, &placing);
        let reach = placed.corners.map(|p| dot(p, splat(pair.axis)));
        let far = reach[0].fast_max(reach[1]).fast_max(reach[2]);
        placed.keep(far.simd_ge(f32x8::splat(pair.b_above - pad)));
        if placed.lanes != 0 {
            around_a = around_a.union(placed.aabb);
            a.push(placed);
        }
    }
    if a.is_empty() {
        return 0;
    }

    cull::clusters(lanes_b, scale_b, &b_from_a, nodes, clusters);
    let place_b = Place::new(pair.rotation * Mat3::from_diagonal(scale_b), pair.translation);
    let mut around_b = Aabb::EMPTY;
    for &c in clusters.iter() {
        let mut placed = place_b.cluster(lanes_b, c, &placing);
        let reach = placed.corners.map(|p| dot(p, splat(pair.axis)));
        let near = reach[0].fast_min(reach[1]).fast_min(reach[2]);
        placed.keep(near.simd_le(f32x8::splat(pair.a_below + pad)));
        placed.keep_inside(around_a);
        if placed.lanes != 0 {
            around_b = around_b.union(placed.aabb);
            b.push(placed);
        }
    }
    a.retain_mut(|placed| {
        placed.keep_inside(around_b);
        placed.lanes != 0
    });
    if a.is_empty() || b.is_empty() {
        return 0;
    }
    product(a, b, boxes, candidates)
}

struct Placing {
    error: f32,
    reach: f32,
    pad: f32,
}

/// Moves clusters into the axes of the pair's first body.
struct Place {
    matrix: Rows,
    translation: Points,
}

impl Place {
    fn new(matrix: Mat3, translation: Vec3) -> Self {
        Self {
            matrix: Rows::new(matrix),
            translation: splat(translation),
        }
    }

    #[inline]
    fn cluster(&self, mesh: &MeshLanes, cluster: u32, placing: &Placing) -> Placed {
        let Cluster { corners, lanes } = mesh.clusters[cluster as usize];
        let corners = corners.map(|p| {
            let p = self.matrix.times(p);
            [0, 1, 2].map(|i| p[i] + self.translation[i])
        });
        let [p, q, r] = corners;
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        // The height n . (x - p) is wrong by the error of x and p along n, and by the error of n along x - p, which is
        // no longer than the two triangles together if their boxes overlap.
        let error = f32x8::splat(2.0 * placing.error);
        let tolerance = error * (norm1(normal) + (norm1(u) + norm1(v)) * f32x8::splat(placing.reach));
        let pad = splat(Vec3::splat(0.5 * placing.pad));
        let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
        let mut placed = Placed {
            first: cluster * CLUSTER as u32,
            corners,
            min: sub(low, pad),
            max: [0, 1, 2].map(|i| high[i] + pad[i]),
            normal,
            tolerance,
            lanes,
            aabb: Aabb::EMPTY,
        };
        placed.fit();
        placed
    }
}

impl Placed {
    #[inline]
    fn keep(&mut self, mask: f32x8) {
        let lanes = self.lanes & mask.to_bitmask();
        if lanes != self.lanes {
            self.lanes = lanes;
            self.fit();
        }
    }

    #[inline]
    fn keep_inside(&mut self, aabb: Aabb) {
        self.keep(boxes_meet(self.min, self.max, splat(aabb.min), splat(aabb.max)));
    }

    fn fit(&mut self) {
        let mut around = Aabb::EMPTY;
        let (low, high) = (
            self.min.each_ref().map(f32x8::as_array),
            self.max.each_ref().map(f32x8::as_array),
        );
        for lane in bits(self.lanes) {
            around = around.union(Aabb {
                min: Vec3::new(low[0][lane], low[1][lane], low[2][lane]),
                max: Vec3::new(high[0][lane], high[1][lane], high[2][lane]),
            });
        }
        self.aabb = around;
    }

    fn corner(&self, k: usize, lane: usize) -> Vec3 {
        lane_of(&self.corners[k], lane)
    }
}

fn lane_of(p: &Points, lane: usize) -> Vec3 {
    Vec3::new(p[0].as_array()[lane], p[1].as_array()[lane], p[2].as_array()[lane])
}

fn scaled(aabb: Aabb, scale: Vec3) -> Aabb {
    Aabb::around([aabb.min * scale, aabb.max * scale])
}

/// All clusters of `a` against all of `b`: boxes of clusters, boxes of triangles, planes.
fn product(a: &[Placed], b: &[Placed], boxes: &mut Vec<[Points; 2]>, candidates: &mut Vec<[u32; 2]>) -> u64 {
    boxes.clear();
    boxes.extend(b.chunks(CLUSTER).map(|run| {
        let lane = |i: usize| run.get(i).map_or(Aabb::EMPTY, |p| p.aabb);
        [points(|i| lane(i).min), points(|i| lane(i).max)]
    }));
    let mut tests = 0;
    for ca in a {
        let (low, high) = (splat(ca.aabb.min), splat(ca.aabb.max));
        for (run, [min, max]) in boxes.iter().enumerate() {
            for lane in bits(boxes_meet(low, high, *min, *max).to_bitmask()) {
                tests += cluster_pair(ca, &b[run * CLUSTER + lane], candidates);
            }
        }
    }
    tests
}

#[inline]
fn cluster_pair(a: &Placed, b: &Placed, candidates: &mut Vec<[u32; 2]>) -> u64 {
    let meet = boxes_meet(a.min, a.max, splat(b.aabb.min), splat(b.aabb.max));
    let mut tests = 0;
    for i in bits(meet.to_bitmask() & a.lanes) {
        let meet = boxes_meet(b.min, b.max, splat(lane_of(&a.min, i)), splat(lane_of(&a.max, i)));
        let overlapping = meet.to_bitmask() & b.lanes;
        if overlapping == 0 {
            continue;
        }
        tests += overlapping.count_ones() as u64;
        for j in bits(overlapping & !beside_plane(a, i, b)) {
            if !plane_separates(b, j, a, i) {
                candidates.push([a.first + i as u32, b.first + j as u32]);
            }
        }
    }
    tests
}

/// Lanes of `b` that lie wholly on one side of the plane of `a`'s triangle `i`.
#[inline]
fn beside_plane(a: &Placed, i: usize, b: &Placed) -> u32 {
    let origin = splat(a.corner(0, i));
    let normal = splat(lane_of(&a.normal, i));
    let tolerance = f32x8::splat(a.tolerance.as_array()[i]);
    let heights = b.corners.map(|p| dot(sub(p, origin), normal));
    let lowest = heights[0].fast_min(heights[1]).fast_min(heights[2]);
    let highest = heights[0].fast_max(heights[1]).fast_max(heights[2]);
    (lowest.simd_gt(tolerance) | highest.simd_lt(-tolerance)).to_bitmask()
}

/// Whether triangle `j` of `b` has all of `a`'s triangle `i` on one side of its plane.
#[inline]
fn plane_separates(b: &Placed, j: usize, a: &Placed, i: usize) -> bool {
    let origin = b.corner(0, j);
    let normal = lane_of(&b.normal, j);
    let tolerance = b.tolerance.as_array()[j];
    let heights = Vec3::from_array([0, 1, 2].map(|k| (a.corner(k, i) - origin).dot(normal)));
    heights.min_element() > tolerance || heights.max_element() < -tolerance
}
