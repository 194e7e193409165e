//! Pairs of triangles that single precision cannot tell apart.

use super::choice::Choice;
use super::cull::{self, Other};
use super::decide::{Eight, decide};
use super::lanes::{Rows, bits, boxes_meet, cross, dot, each, lane_of, max, min, norm1, splat, sub};
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
    /// The pair's unit of length per metre: a power of two near the inverse of the pair's size. Products of five lengths
    /// occur, and in this unit none overflows or vanishes, whatever the size of the bodies.
    unit: f32,
    masks: [Vec<u8>; 2],
    /// The result: where the triangles of the first and second mesh stand among the placed ones.
    candidates: Vec<[u32; 2]>,
}

/// Eight triangles in the axes of the pair's first body, about its centre of mass, in the pair's own unit of length.
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

/// Error of a placed coordinate in the pair's unit, in which the sum of the bounding radii is between 1 and 2: a handful of
/// roundings of `2^-24`.
const ERROR: f32 = 2.0e-6;

/// The power of two that brings `size` between 1 and 2. Multiplying by it is exact.
fn unit_of(size: f32) -> f32 {
    let exponent = (size.to_bits() >> 23) & 0xff;
    // Bounding radii are far from the ends of the range, so this is a normal number.
    f32::from_bits((254 - exponent.clamp(1, 253)) << 23)
}

/// Fills `scratch.candidates` and tells how many pairs of triangles had overlapping boxes.
pub fn candidates(bodies: &Bodies, meshes: &MeshArena, pair: &NearPair, scratch: &mut Scratch) -> u64 {
    let Scratch {
        nodes,
        clusters,
        a,
        b,
        boxes,
        unit,
        masks: [masks_a, masks_b],
        candidates,
    } = scratch;
    candidates.clear();
    a.clear();
    b.clear();
    let [ia, ib] = pair.bodies.map(|i| i as usize);
    let [slot_a, slot_b] = [ia, ib].map(|i| &meshes[bodies.mesh[i]]);
    let (lanes_a, lanes_b) = (&slot_a.lanes, &slot_b.lanes);
    let choice_a = Choice::new(pair.views[0], &slot_a.mesh, masks_a);
    let choice_b = Choice::new(pair.views[1], &slot_b.mesh, masks_b);
    let (scale_a, scale_b) = (bodies.scale[ia], bodies.scale[ib]);
    let size = bodies.radius[ia] + bodies.radius[ib];
    let pad = PAD * size;
    *unit = unit_of(size);
    let unit = *unit;

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
        reach: unit * (reach(lanes_a, scale_a) + reach(lanes_b, scale_b)),
        pad: unit * pad,
    };

    let axis = splat(pair.axis);
    let along = |placed: &Placed| each(|k| dot(placed.corners[k], axis));
    cull::clusters(lanes_a, scale_a, &a_from_b, nodes, clusters);
    let place_a = Place::new(Mat3::from_diagonal(unit * scale_a), Vec3::ZERO);
    let least = f32x8::splat(unit * (pair.b_above - pad));
    let around_a = place_a.all(a, lanes_a, clusters, &choice_a, &placing, |placed| {
        let reach = along(placed);
        placed.keep(reach[0].fast_max(reach[1]).fast_max(reach[2]).simd_ge(least));
    });
    if a.is_empty() {
        return 0;
    }

    cull::clusters(lanes_b, scale_b, &b_from_a, nodes, clusters);
    let place_b = Place::new(
        pair.rotation * Mat3::from_diagonal(unit * scale_b),
        unit * pair.translation,
    );
    let most = f32x8::splat(unit * (pair.a_below + pad));
    let around_b = place_b.all(b, lanes_b, clusters, &choice_b, &placing, |placed| {
        let reach = along(placed);
        placed.keep(reach[0].fast_min(reach[1]).fast_min(reach[2]).simd_le(most));
        placed.keep_inside(around_a);
    });
    a.retain_mut(|placed| {
        placed.keep_inside(around_b);
        placed.lanes != 0
    });
    if a.is_empty() || b.is_empty() {
        return 0;
    }
    product(a, b, boxes, candidates)
}

/// Adds to a list and hands out what was added.
#[inline(always)]
fn push<T>(list: &mut Vec<T>, item: T) -> &mut T {
    let at = list.len();
    list.push(item);
    &mut list[at]
}

struct Placing {
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

    /// Adds to `list` the clusters of which anything is left after `choice` and `cull`, and tells the box around them.
    #[inline(always)]
    fn all(
        &self,
        list: &mut Vec<Placed>,
        mesh: &MeshLanes,
        clusters: &[u32],
        choice: &Choice,
        placing: &Placing,
        cull: impl Fn(&mut Placed),
    ) -> Aabb {
        let mut around = Aabb::EMPTY;
        for &c in clusters {
            let chosen = choice.lanes(c);
            if chosen == 0 {
                continue;
            }
            let placed = push(list, self.cluster(mesh, c, chosen, placing));
            if let Some(facing) = choice.facing(placed.normal) {
                placed.keep(facing);
            }
            cull(placed);
            if placed.lanes != 0 {
                around = around.union(placed.aabb);
            } else {
                list.pop();
            }
        }
        around
    }

    #[inline]
    fn cluster(&self, mesh: &MeshLanes, cluster: u32, chosen: u32, placing: &Placing) -> Placed {
        let Cluster { corners, lanes } = mesh.clusters[cluster as usize];
        let corners = each(|k| {
            let p = self.matrix.times(corners[k]);
            each(|i| p[i] + self.translation[i])
        });
        let [p, q, r] = corners;
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        // The height n . (x - p) is wrong by the error of x and p along n, and by the error of n along x - p, which is
        // no longer than the two triangles together if their boxes overlap.
        let error = f32x8::splat(3.0 * ERROR);
        let tolerance = error * (norm1(normal) + (norm1(u) + norm1(v)) * f32x8::splat(placing.reach));
        let pad = splat(Vec3::splat(0.5 * placing.pad));
        let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
        let mut placed = Placed {
            first: cluster * CLUSTER as u32,
            corners,
            min: sub(low, pad),
            max: each(|i| high[i] + pad[i]),
            normal,
            tolerance,
            lanes: lanes & chosen,
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
        for lane in bits(self.lanes) {
            around = around.union(Aabb {
                min: lane_of(&self.min, lane),
                max: lane_of(&self.max, lane),
            });
        }
        self.aabb = around;
    }
}

fn scaled(aabb: Aabb, scale: Vec3) -> Aabb {
    Aabb::around([aabb.min * scale, aabb.max * scale])
}

/// All clusters of `a` against all of `b`: boxes of clusters, boxes of triangles, planes.
fn product(a: &[Placed], b: &[Placed], boxes: &mut Vec<[Points; 2]>, candidates: &mut Vec<[u32; 2]>) -> u64 {
    boxes.clear();
    for run in b.chunks(CLUSTER) {
        let mut lanes = [Aabb::EMPTY; CLUSTER];
        for (lane, placed) in lanes.iter_mut().zip(run) {
            *lane = placed.aabb;
        }
        boxes.push([points(|i| lanes[i].min), points(|i| lanes[i].max)]);
    }
    let mut tests = 0;
    for (i, ca) in a.iter().enumerate() {
        let (low, high) = (splat(ca.aabb.min), splat(ca.aabb.max));
        for (run, [min, max]) in boxes.iter().enumerate() {
            for lane in bits(boxes_meet(low, high, *min, *max).to_bitmask()) {
                let j = run * CLUSTER + lane;
                tests += cluster_pair(i, ca, j, &b[j], candidates);
            }
        }
    }
    tests
}

#[inline]
fn cluster_pair(index_a: usize, a: &Placed, index_b: usize, b: &Placed, candidates: &mut Vec<[u32; 2]>) -> u64 {
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
            candidates.push([index_a * CLUSTER + i, index_b * CLUSTER + j].map(|at| at as u32));
        }
    }
    tests
}

/// Lanes of `b` that lie wholly on one side of the plane of `a`'s triangle `i`.
#[inline]
fn beside_plane(a: &Placed, i: usize, b: &Placed) -> u32 {
    let origin = splat(lane_of(&a.corners[0], i));
    let normal = splat(lane_of(&a.normal, i));
    let tolerance = f32x8::splat(a.tolerance.as_array()[i]);
    let height = |k: usize| dot(sub(b.corners[k], origin), normal);
    let heights = [height(0), height(1), height(2)];
    let lowest = heights[0].fast_min(heights[1]).fast_min(heights[2]);
    let highest = heights[0].fast_max(heights[1]).fast_max(heights[2]);
    (lowest.simd_gt(tolerance) | highest.simd_lt(-tolerance)).to_bitmask()
}

/// One candidate, decided.
pub struct Decided {
    /// Triangles of the first and second mesh.
    pub triangles: [u32; 2],
    /// The common segment about the first body's centre in its axes; `None` if single precision cannot tell.
    pub segment: Option<[Vec3; 2]>,
}

impl Scratch {
    /// Goes through the candidates in order, and reports those that intersect and those that may.
    pub fn decide(&self, mut report: impl FnMut(Decided)) {
        let metres = 1.0 / self.unit;
        for run in self.candidates.chunks(CLUSTER) {
            // Lanes without a candidate repeat the last.
            let pairs: [[u32; 2]; CLUSTER] = std::array::from_fn(|lane| run[lane.min(run.len() - 1)]);
            let a = gather(&self.a, pairs.map(|[a, _]| a));
            let b = gather(&self.b, pairs.map(|[_, b]| b));
            let verdicts = decide(&a, &b, ERROR);
            let wanted = (1u32 << run.len()) - 1;
            for lane in bits((verdicts.hit | verdicts.unsure) & wanted) {
                let [at_a, at_b] = pairs[lane];
                report(Decided {
                    triangles: [triangle(&self.a, at_a), triangle(&self.b, at_b)],
                    segment: (verdicts.hit >> lane & 1 == 1).then(|| verdicts.segment(lane).map(|p| p * metres)),
                });
            }
        }
    }
}

fn triangle(placed: &[Placed], at: u32) -> u32 {
    placed[at as usize / CLUSTER].first + at % CLUSTER as u32
}

/// Brings eight triangles from anywhere among the placed ones together.
fn gather(placed: &[Placed], at: [u32; CLUSTER]) -> Eight {
    let mut out = [[0f32; CLUSTER]; 13];
    for (lane, at) in at.into_iter().enumerate() {
        let (from, i) = (&placed[at as usize / CLUSTER], at as usize % CLUSTER);
        for k in 0..3 {
            for axis in 0..3 {
                out[3 * k + axis][lane] = from.corners[k][axis].as_array()[i];
            }
            out[9 + k][lane] = from.normal[k].as_array()[i];
        }
        out[12][lane] = from.tolerance.as_array()[i];
    }
    let at = |row: usize| each(|i| f32x8::new(out[row + i]));
    Eight {
        corners: [at(0), at(3), at(6)],
        normal: at(9),
        tolerance: f32x8::new(out[12]),
    }
}
