//! Eight triangles of a body at a time, placed in single precision, and which of them have boxes near a triangle of the
//! other body.

use super::feature_bits::{CORNER_BITS, EDGE_BITS, FACE_BIT};
use super::precision::{ANY_TILT, ERROR};
use super::search::{Limits, Search};
use super::side::Side;
use super::small_triangle::{EightTriangles, SmallTriangle};
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{
    Rows, Select, Simd, SimdBase, SimdFloat, add, bitmask, boxes_meet, cross, dot, each, lane_of, lanes, largest,
    largest_point, least, least_point, load, load_points, mask32x8, max, min, norm1, pick, scale, splat, splat_point,
    store, store_points, sub,
};
use crate::state::mesh_arena::{Stored, StoredPoints};
use glam::Vec3;

/// The boxes of eight triangles in single precision, relative to the first body's centre of mass. Only triangles of
/// near pairs are computed in double precision.
#[derive(Default)]
pub struct PlacedCluster {
    min: StoredPoints,
    max: StoredPoints,
    /// Box around the triangles that take part.
    bounds: Aabb,
    /// Extent along [`Window::direction`](super::search::Window::direction).
    min_along: Stored,
    max_along: Stored,
    /// Lanes that hold a triangle, and lanes that take part.
    all_lanes: u32,
    pub lanes: u32,
    /// Lanes whose face, and lanes whose edges, may have a feature with a wanted normal.
    faces: u32,
    edges: u32,
}

/// Places a body's triangles.
pub struct ClusterTransform<S: Simd> {
    simd: S,
    rows: Rows<S>,
    /// 1 if placed corners run counter-clockwise seen from outside, else -1.
    outward: f32,
    /// 1 for the first body and -1 for the second: contact normals point from that to this.
    forward: f32,
}

impl<S: Simd> ClusterTransform<S> {
    /// The transform of side `number` of a pair.
    #[inline(always)]
    pub fn new(simd: S, sides: &[Side; 2], number: usize) -> Self {
        let side = &sides[number];
        Self {
            simd,
            rows: Rows::new(simd, side.matrix().as_mat3()),
            outward: side.winding(),
            forward: [1.0, -1.0][number],
        }
    }
}

impl PlacedCluster {
    /// Places a cluster here, and its triangles there. `pad` is the rounding allowance.
    #[inline(always)]
    pub fn place<S: Simd>(
        &mut self,
        triangles: &mut [SmallTriangle; CLUSTER],
        side: &Side,
        transform: &ClusterTransform<S>,
        cluster: u32,
        search: &Search,
        pad: f32,
    ) {
        let ClusterTransform {
            simd,
            rows,
            outward,
            forward,
        } = transform;
        let simd = *simd;
        let own = &side.mesh.lanes().clusters[cluster as usize];
        let at = splat_point(simd, side.place(own.origin).as_vec3());
        let p = rows.times(load_points(simd, &own.corners[0]));
        let q = rows.times(load_points(simd, &own.corners[1]));
        let r = rows.times(load_points(simd, &own.corners[2]));
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        let corners = [add(p, at), add(q, at), add(r, at)];
        let [p, q, r] = corners;
        let length = dot(normal, normal).sqrt();
        // Also false for NaN.
        let has_normal = length.simd_gt(splat(simd, f32::MIN_POSITIVE)) & length.simd_le(splat(simd, f32::MAX));
        let inverse = splat(simd, 1.0) / length;
        let tilt = splat(simd, ERROR) * norm1(u) * norm1(v) * inverse + splat(simd, ERROR);
        let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
        let extent = sub(high, low);
        let winding = splat(simd, *outward);
        let first = cluster * CLUSTER as u32;
        let edge_rotation = side.edge_normal_rotations(simd, first);
        let eight = EightTriangles {
            corners,
            normal: scale(normal, has_normal.select(inverse * winding, splat(simd, 0.0))),
            tilt: has_normal.select(tilt, splat(simd, ANY_TILT)),
            edge_rotation,
            sides: extent[0] + extent[1] + extent[2],
            nearest_rotation: side.nearest_rotations(simd, first).copysign(winding),
        };
        eight.scatter(triangles);
        (self.min, self.max) = (store_points(low), store_points(high));
        (self.min_along, self.max_along) = Default::default();
        (self.lanes, self.faces, self.edges) = (own.lanes, own.lanes, own.lanes);
        if let Some(window) = &search.window {
            (self.lanes, self.faces, self.edges) = (0, 0, 0);
            let (unit, known) = (scale(eight.direction(), splat(simd, *forward)), eight.has_direction());
            for region in window.regions() {
                let (center, radius) = (splat_point(simd, region.center), splat(simd, region.reach(pad)));
                let zero = splat(simd, 0.0);
                let way = each(|axis| (low[axis] - center[axis]).max(center[axis] - high[axis]).max(zero));
                let near = own.lanes & bitmask(dot(way, way).simd_le(radius * radius));
                self.lanes |= near;
                if region.normal == Vec3::ZERO {
                    self.faces |= near;
                    self.edges |= near;
                    continue;
                }
                let turn = sub(unit, splat_point(simd, region.normal));
                let turn = known.select(dot(turn, turn), zero);
                let most = splat(simd, window.chord);
                let most_of_edges = most + edge_rotation;
                self.faces |= near & bitmask(turn.simd_le(most * most));
                self.edges |= near & bitmask(turn.simd_le(most_of_edges * most_of_edges));
            }
            let direction = splat_point(simd, window.direction);
            let along = [dot(direction, p), dot(direction, q), dot(direction, r)];
            self.min_along = store(least(along));
            self.max_along = store(largest(along));
        }
        let owned = side.owned(first);
        for (i, triangle) in triangles.iter_mut().enumerate() {
            let all = |lanes: u32, bits: u32| (lanes >> i & 1).wrapping_neg() & bits;
            triangle.number = first + i as u32;
            triangle.owned = owned[i] & (CORNER_BITS | all(self.edges, EDGE_BITS)) | all(self.faces, FACE_BIT);
        }
        self.all_lanes = own.lanes;
    }

    /// Finds the box around this cluster's triangles, with which clusters of the other body are compared. Only one body
    /// needs such boxes.
    #[inline(always)]
    pub fn fit<S: Simd>(&mut self, simd: S) {
        let (mut low, mut high) = (load_points(simd, &self.min), load_points(simd, &self.max));
        // Lanes that hold no triangle repeat another.
        if self.lanes != self.all_lanes {
            let (part, none) = (lanes(simd, self.lanes), splat(simd, f32::INFINITY));
            (low, high) = (pick(part, low, [none; 3]), pick(part, high, [-none; 3]));
        }
        self.bounds = Aabb {
            min: least_point(low),
            max: largest_point(high),
        };
    }

    /// Lanes whose triangles may be near one of `other`: their boxes are no farther than the reach from the box around
    /// those.
    #[inline(always)]
    pub fn near_lanes<S: Simd>(&self, simd: S, other: &Self, limits: &Limits) -> u32 {
        self.lanes & bitmask(self.boxes_are_near(simd, &other.bounds, limits.reach))
    }

    /// Lanes of `other` whose triangles may be near triangle `i`: their boxes are no farther apart than the reach, and
    /// both are in the window.
    #[inline(always)]
    pub fn near_boxes<S: Simd>(&self, simd: S, i: usize, other: &Self, limits: &Limits) -> u32 {
        let own = Aabb {
            min: lane_of(&self.min, i),
            max: lane_of(&self.max, i),
        };
        let last = splat(simd, self.max_along.0[i] + limits.crossing);
        let boxes = other.boxes_are_near(simd, &own, limits.reach);
        let boxes = bitmask(boxes & load(simd, &other.min_along).simd_le(last));
        let all = |lanes: u32| (lanes >> i & 1).wrapping_neg();
        boxes & other.lanes & (all(self.faces) | other.faces | all(self.edges) & other.edges)
    }

    /// Lanes whose boxes are no farther than `reach` from a box.
    #[inline(always)]
    fn boxes_are_near<S: Simd>(&self, simd: S, to: &Aabb, reach: f32) -> mask32x8<S> {
        let (low, high) = (splat_point(simd, to.min - reach), splat_point(simd, to.max + reach));
        boxes_meet(low, high, load_points(simd, &self.min), load_points(simd, &self.max))
    }
}
