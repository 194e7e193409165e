//! Eight triangles of a body at a time, placed in single precision, and which of them are near a triangle of the other
//! body.
//!
//! Between finely tessellated surfaces a wide margin holds very many triangles that are near each other, and few of them
//! have a feature. A vertex lies over a face only if the two overlap when projected along the face's normal. Edges form
//! a feature only if their faces point at each other. Pairs that can neither have a feature nor cross are dropped here.

use super::candidates::{CROSSING, Parts, corner_parts, edge_parts};
use super::eight::{ANY_TILT, SmallTriangle};
use super::search::{Limits, Search};
use super::side::Side;
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::simd::lanes::{
    Rows, Select, Simd, SimdBase, SimdFloat, add, bitmask, bits, boxes_meet, cross, dot, each, f32x8, heights, lane_of,
    largest, least, load, load_points, mask32x8, max, min, norm1, scale, splat, splat_point, store, store_points, sub,
};
use crate::state::mesh_arena::{Stored, StoredPoints};
use glam::Vec3;

/// Eight triangles in single precision, relative to the first body's centre of mass. Only triangles of near pairs are
/// computed in double precision. It is placed where it stays, because it is large.
#[derive(Default)]
pub struct PlacedCluster {
    corners: [StoredPoints; 3],
    /// Cross products of two edges, and their lengths.
    normal: StoredPoints,
    length: Stored,
    /// Outward unit normal; zero where single precision does not determine it.
    direction: StoredPoints,
    /// Error bound of a height over the plane per distance to the corner, times the normal's length.
    slack: Stored,
    /// Centre and radius of a sphere around the corners.
    middle: StoredPoints,
    around: Stored,
    /// Largest angle between the triangle's normal and a contact normal at an edge that it owns, radians.
    edge_rotation: Stored,
    min: StoredPoints,
    max: StoredPoints,
    /// Sum of the sides of the triangles' boxes.
    sides: Stored,
    /// Box around the triangles that take part.
    bounds: Aabb,
    /// Extent along [`Window::direction`].
    min_along: Stored,
    max_along: Stored,
    /// Lanes that take part.
    pub lanes: u32,
    /// Those whose face, and whose edges, may have a feature with a normal that is wanted.
    faces: u32,
    edges: u32,
    /// Index of the triangle in lane 0.
    first: u32,
    /// What each lane's triangle owns.
    pub owned: [u32; CLUSTER],
    /// 1 if placed corners run counter-clockwise seen from outside, else -1.
    winding: f32,
}

/// Lanes of a cluster whose triangles are near a triangle, and what they may have with it.
#[derive(Clone, Copy, Default)]
pub struct NearLanes {
    /// They may cross it.
    crossing: u32,
    /// For each of its corners, lanes that it may be over; and for each of their corners, lanes in which that may be over it.
    corners: [[u32; 3]; 2],
    /// For each of its edges, lanes with which that may have a feature; and lanes whose first, second and third edge may.
    edges: [[u32; 3]; 2],
}

impl NearLanes {
    #[inline(always)]
    pub fn any(&self) -> u32 {
        let any = |[p, q, r]: [u32; 3]| p | q | r;
        let [first, second] = self.corners;
        let [own, other] = self.edges;
        self.crossing | any(first) | any(second) | any(own) & any(other)
    }

    #[inline(always)]
    pub fn parts(&self, lane: usize) -> Parts {
        let bit = |lanes: u32| lanes >> lane & 1;
        let set = |[p, q, r]: [u32; 3]| bit(p) | bit(q) << 1 | bit(r) << 2;
        let crossing = if bit(self.crossing) == 1 { CROSSING } else { 0 };
        let [first, second] = self.corners;
        let [own, other] = self.edges;
        crossing | corner_parts([set(first), set(second)]) | edge_parts([set(own), set(other)])
    }
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
    /// That of one of the sides of a pair.
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

/// Relative rounding error of a product of two vectors in single precision.
pub(crate) const ERROR: f32 = 2.0e-6;

/// Largest error of a normal's direction, radians. Less certain normals count as unknown.
pub(crate) const DIRECTION_ERROR: f32 = 1.0e-3;
/// Factor on radii, for rounding.
pub(crate) const AROUND_ERROR: f32 = 1.001;

impl PlacedCluster {
    /// Places a cluster here. `pad` is the rounding allowance.
    #[inline(always)]
    pub fn place<S: Simd>(
        &mut self,
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
        let (p, q, r) = (add(p, at), add(q, at), add(r, at));
        let length = dot(normal, normal).sqrt();
        let slack = splat(simd, ERROR) * norm1(u) * norm1(v);
        // Also false for NaN.
        let known = slack.simd_lt(splat(simd, DIRECTION_ERROR) * length);
        let inverse = known.select(splat(simd, *outward) / length, splat(simd, 0.0));
        let middle = scale(add(add(p, q), r), splat(simd, 1.0 / 3.0));
        let (from_p, from_q, from_r) = (sub(p, middle), sub(q, middle), sub(r, middle));
        let squares = [dot(from_p, from_p), dot(from_q, from_q), dot(from_r, from_r)];
        let (low, high) = (min(p, min(q, r)), max(p, max(q, r)));
        let first = cluster * CLUSTER as u32;
        let extent = sub(high, low);
        self.corners = [store_points(p), store_points(q), store_points(r)];
        self.normal = store_points(normal);
        self.length = store(length);
        self.direction = store_points(scale(normal, inverse));
        self.slack = store(slack);
        self.middle = store_points(middle);
        self.around = store(largest(squares).sqrt());
        self.edge_rotation = side.edge_normal_rotations(first);
        (self.min, self.max) = (store_points(low), store_points(high));
        self.sides = store(extent[0] + extent[1] + extent[2]);
        (self.min_along, self.max_along) = Default::default();
        (self.lanes, self.faces, self.edges) = (own.lanes, own.lanes, own.lanes);
        self.first = first;
        for (i, owned) in self.owned.iter_mut().enumerate() {
            *owned = side.features.owned.get(first as usize + i).copied().unwrap_or(0);
        }
        self.winding = *outward;
        if let Some(window) = &search.window {
            (self.lanes, self.faces, self.edges) = (0, 0, 0);
            let unit = scale(normal, inverse * splat(simd, *forward));
            let edge_rotation = load(simd, &self.edge_rotation);
            for place in window.places() {
                let (center, radius) = (
                    splat_point(simd, place.center),
                    splat(simd, AROUND_ERROR * place.radius + pad),
                );
                let zero = splat(simd, 0.0);
                let way = each(|axis| (low[axis] - center[axis]).max(center[axis] - high[axis]).max(zero));
                let near = own.lanes & bitmask(dot(way, way).simd_le(radius * radius));
                self.lanes |= near;
                if place.normal == Vec3::ZERO {
                    self.faces |= near;
                    self.edges |= near;
                    continue;
                }
                let turn = sub(unit, splat_point(simd, place.normal));
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
        self.bounds = Aabb::EMPTY;
        for i in bits(self.lanes) {
            self.bounds.min = self.bounds.min.min(lane_of(&self.min, i));
            self.bounds.max = self.bounds.max.max(lane_of(&self.max, i));
        }
    }

    /// Lanes whose boxes are no farther than `reach` from the box around `other`.
    #[inline(always)]
    pub fn near_box<S: Simd>(&self, simd: S, other: &Self, reach: f32) -> u32 {
        bitmask(self.boxes_are_near(simd, &other.bounds, reach))
    }

    /// The box of the triangle in lane `i`.
    #[inline(always)]
    fn box_of(&self, i: usize) -> Aabb {
        Aabb {
            min: lane_of(&self.min, i),
            max: lane_of(&self.max, i),
        }
    }

    /// Lanes of `other` in the window whose boxes are no farther than the reach from that of the triangle in lane `i`.
    #[inline(always)]
    pub fn near_boxes<S: Simd>(&self, simd: S, i: usize, other: &Self, limits: &Limits) -> u32 {
        let last = splat(simd, self.max_along.0[i] + limits.crossing);
        let boxes = other.boxes_are_near(simd, &self.box_of(i), limits.reach);
        let boxes = bitmask(boxes & load(simd, &other.min_along).simd_le(last));
        let [face, edges] = self.in_window(i);
        boxes & other.lanes & (face | other.faces | edges & other.edges)
    }

    /// All lanes if the face of the triangle in lane `i` may have a feature with a normal that is wanted, and all if its
    /// edges may.
    #[inline(always)]
    fn in_window(&self, i: usize) -> [u32; 2] {
        let all = |lanes: u32| (lanes >> i & 1).wrapping_neg();
        [all(self.faces), all(self.edges)]
    }

    /// Those of the lanes `boxes` of `other` whose triangles may have features with the triangle in lane `i` or cross it: none
    /// of their planes separates them by more than the reach.
    #[inline(always)]
    pub fn near<S: Simd>(&self, simd: S, i: usize, other: &Self, boxes: u32, limits: &Limits) -> NearLanes {
        let &Limits { reach, crossing, .. } = limits;
        // Upper bound of the distance between any two points of two triangles whose boxes are near.
        let spread = splat(simd, self.sides.0[i] + reach) + load(simd, &other.sides);
        let [own_face, own_edges] = self.in_window(i);
        let normal = splat_point(simd, lane_of(&self.normal, i));
        let corners = [
            splat_point(simd, lane_of(&self.corners[0], i)),
            splat_point(simd, lane_of(&self.corners[1], i)),
            splat_point(simd, lane_of(&self.corners[2], i)),
        ];
        let other_corners = [
            load_points(simd, &other.corners[0]),
            load_points(simd, &other.corners[1]),
            load_points(simd, &other.corners[2]),
        ];
        let far = splat(simd, reach);
        let over_own = Heights {
            heights: heights(&other_corners, corners[0], normal),
            outward: self.winding,
            length: splat(simd, self.length.0[i]),
            slack: spread * splat(simd, self.slack.0[i]),
        };
        let near = boxes & !bitmask(over_own.beyond(far));
        if near == 0 {
            return NearLanes::default();
        }
        let over_other = Heights {
            heights: heights(&corners, other_corners[0], load_points(simd, &other.normal)),
            outward: other.winding,
            length: load(simd, &other.length),
            slack: spread * load(simd, &other.slack),
        };
        let near = near & !bitmask(over_other.beyond(far));
        if near == 0 {
            return NearLanes::default();
        }
        let close = splat(simd, crossing);
        let apart = over_own.beyond(close) | over_other.beyond(close);
        let meet = other.boxes_are_near(simd, &self.box_of(i), crossing) & !apart;
        let mut found = NearLanes {
            crossing: near & bitmask(meet),
            ..NearLanes::default()
        };
        let corners = [
            over_other.corners(limits, near & other.faces),
            over_own.corners(limits, near & own_face),
        ];
        let edges = near & own_edges & other.edges & self.may_face(simd, i, other, limits);
        let [[p, q, r], [s, t, u]] = corners;
        if p | q | r | s | t | u | edges == 0 {
            // Most triangles that cross have no feature.
            return found;
        }
        let [first, second, near_edges] = self.may_have_features(simd, i, other, limits);
        found.corners = [each(|k| corners[0][k] & first), each(|k| corners[1][k] & second)];
        let edges = edges & near_edges;
        found.edges = [over_other.edges(far, edges), over_own.edges(far, edges)];
        found
    }

    /// Lanes of `other` whose triangles face the triangle in lane `i`, as far as their edges may have a feature.
    #[inline(always)]
    fn may_face<S: Simd>(&self, simd: S, i: usize, other: &Self, limits: &Limits) -> u32 {
        let sum = add(
            splat_point(simd, lane_of(&self.direction, i)),
            load_points(simd, &other.direction),
        );
        let rotation = splat(simd, self.edge_rotation.0[i] + limits.rotation) + load(simd, &other.edge_rotation);
        bitmask(dot(sum, sum).simd_le(rotation * rotation))
    }

    /// Lanes whose boxes are no farther than `reach` from a box.
    #[inline(always)]
    fn boxes_are_near<S: Simd>(&self, simd: S, to: &Aabb, reach: f32) -> mask32x8<S> {
        let (low, high) = (splat_point(simd, to.min - reach), splat_point(simd, to.max + reach));
        boxes_meet(low, high, load_points(simd, &self.min), load_points(simd, &self.max))
    }

    /// Lanes of `other` whose triangles may have a feature of separation up to the reach with the triangle in lane `i`: a
    /// vertex of that over them, a vertex over that, or two edges.
    /// The points of a feature lie on a line along its normal, which is a face's, or within
    /// [`PlacedCluster::edge_rotation`] of the normals of the faces at both edges.
    #[inline(always)]
    fn may_have_features<S: Simd>(&self, simd: S, i: usize, other: &Self, limits: &Limits) -> [u32; 3] {
        let own_direction = splat_point(simd, lane_of(&self.direction, i));
        let other_direction = load_points(simd, &other.direction);
        let way = sub(
            load_points(simd, &other.middle),
            splat_point(simd, lane_of(&self.middle, i)),
        );
        // Squared lateral distance of the centres, perpendicular to the normal of either. It is zero if the normal is
        // unknown.
        let (across_own, across_other) = (cross(way, own_direction), cross(way, other_direction));
        let lateral_own = dot(across_own, across_own);
        let lateral_other = dot(across_other, across_other);
        let radii = splat(simd, self.around.0[i]) + load(simd, &other.around);
        let around = radii * splat(simd, AROUND_ERROR) + splat(simd, limits.lateral);
        let square = around * around;

        let own_rotation = splat(simd, self.edge_rotation.0[i]);
        let other_rotation = load(simd, &other.edge_rotation);
        let (reach, one) = (splat(simd, limits.reach), splat(simd, 1.0));
        let most_own = around + reach * own_rotation.min(one);
        let most_other = around + reach * other_rotation.min(one);
        let edges = lateral_own.simd_le(most_own * most_own) & lateral_other.simd_le(most_other * most_other);
        [
            bitmask(lateral_other.simd_le(square)),
            bitmask(lateral_own.simd_le(square)),
            bitmask(edges),
        ]
    }

    /// The triangle in lane `i`.
    #[inline]
    pub fn triangle(&self, i: usize) -> SmallTriangle {
        let normal = lane_of(&self.direction, i);
        SmallTriangle {
            number: self.first + i as u32,
            corners: each(|k| lane_of(&self.corners[k], i)),
            normal,
            tilt: if normal == Vec3::ZERO {
                ANY_TILT
            } else {
                // The rounding of the unit normal comes on top.
                self.slack.0[i] / self.length.0[i] + ERROR
            },
            winding: self.winding,
        }
    }
}

/// Heights of the corners of triangles over planes.
struct Heights<S: Simd> {
    /// Times the length of the plane's normal.
    heights: [f32x8<S>; 3],
    /// 1 if they are positive outside, else -1.
    outward: f32,
    length: f32x8<S>,
    /// Error bound, times the length.
    slack: f32x8<S>,
}

impl<S: Simd> Heights<S> {
    /// Lanes whose corners are all farther from the plane than `most`, on one side.
    #[inline(always)]
    fn beyond(&self, most: f32x8<S>) -> mask32x8<S> {
        let most = most * self.length + self.slack;
        least(self.heights).simd_gt(most) | largest(self.heights).simd_lt(-most)
    }

    /// For each corner, those of the lanes in which its height may be the separation of a feature.
    #[inline(always)]
    fn corners(&self, limits: &Limits, lanes: u32) -> [u32; 3] {
        let simd = self.length.simd;
        let lowest = splat(simd, limits.lowest) * self.length - self.slack;
        let highest = splat(simd, limits.highest) * self.length + self.slack;
        let outward = splat(simd, self.outward);
        each(|k| {
            let height = outward * self.heights[k];
            lanes & !bitmask(height.simd_lt(lowest) | height.simd_gt(highest))
        })
    }

    /// For each edge, those of the lanes in which it may come as near to the plane as `most`.
    #[inline(always)]
    fn edges(&self, most: f32x8<S>, lanes: u32) -> [u32; 3] {
        let most = most * self.length + self.slack;
        each(|k| {
            let (start, end) = (self.heights[k], self.heights[(k + 1) % 3]);
            lanes & !bitmask(start.min(end).simd_gt(most) | start.max(end).simd_lt(-most))
        })
    }
}
