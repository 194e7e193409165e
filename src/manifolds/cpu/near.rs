//! Pairs of triangles that are near each other, down the trees of both meshes.
//!
//! Of finely cut surfaces a wide margin holds very many such pairs, and few of them have a feature: a vertex is over a face
//! only if the two lie beside each other as seen along the face's normal, and edges push each other only if their faces
//! look at each other. What can have no feature and cannot intersect is dropped here, eight pairs at a time.

use super::side::{Side, Triangle};
use crate::geometry::Aabb;
use crate::geometry::cluster::CLUSTER;
use crate::simd::descent::Descent;
use crate::simd::lanes::{Rows, bits, boxes_meet, cross, dot, each, lane_of, max, min, norm1, splat, sub};
use crate::simd::rounding::{PAD, unit_of};
use crate::simd::tree::{RelativePose, Tree};
use crate::state::mesh_arena::Points;
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
        let places = sides.each_ref().map(Place::new);
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
    /// The unit normal that leads outward. Zero where single precision does not tell it.
    direction: Points,
    /// How wrong a height over the plane can be beside the way to the corner, both times the normal's length.
    slack: f32x8,
    /// A circle around the corners.
    middle: Points,
    around: f32x8,
    /// How far normals at owned edges may turn from the triangle's, radians.
    edge_turn: f32x8,
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

/// What places a body's triangles.
struct Place {
    rows: Rows,
    /// 1 if placed corners run counter-clockwise seen from outside, else -1.
    outward: f32,
}

impl Place {
    fn new(side: &Side) -> Self {
        Self {
            rows: Rows::new(side.matrix().as_mat3()),
            outward: side.winding(),
        }
    }
}

/// What single precision costs a product of two vectors, relative to their lengths.
pub(crate) const ERROR: f32 = 2.0e-6;

/// The direction of a normal must be known as well as this, radians.
pub(crate) const DIRECTION_ERROR: f32 = 1.0e-3;
/// By which factor radii are taken to be larger, for rounding.
pub(crate) const AROUND_ERROR: f32 = 1.001;

impl Placed {
    fn new(side: &Side, place: &Place, cluster: u32, window: Option<&Window>) -> Self {
        let own = &side.mesh.lanes().clusters[cluster as usize];
        let at = splat(side.place(own.origin).as_vec3());
        let [p, q, r] = each(|k| place.rows.times(own.corners[k]));
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        let [p, q, r] = each(|k| each(|i| [p, q, r][k][i] + at[i]));
        let length = dot(normal, normal).sqrt();
        let slack = f32x8::splat(ERROR) * norm1(u) * norm1(v);
        // Also false for what is not a number.
        let known = slack.simd_lt(f32x8::splat(DIRECTION_ERROR) * length);
        let inverse = known.bitselect(f32x8::splat(place.outward) / length, f32x8::ZERO);
        let middle = each(|i| (p[i] + q[i] + r[i]) * f32x8::splat(1.0 / 3.0));
        let square = |corner: Points| {
            let way = sub(corner, middle);
            dot(way, way)
        };
        let first = cluster * CLUSTER as u32;
        let mut placed = Self {
            corners: [p, q, r],
            normal,
            length,
            direction: each(|i| normal[i] * inverse),
            slack,
            middle,
            around: square(p).fast_max(square(q)).fast_max(square(r)).sqrt(),
            edge_turn: side.edge_turns(first),
            min: min(p, min(q, r)),
            max: max(p, max(q, r)),
            first_along: f32x8::ZERO,
            last_along: f32x8::ZERO,
            lanes: own.lanes,
            first,
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
        let apart = |most: f32x8| {
            beyond(over_own, most * at(self.length) + spread * at(self.slack))
                | beyond(over_other, most * other.length + spread * other.slack)
        };
        let near = boxes & other.lanes & !apart(reaches).to_bitmask();
        if near == 0 {
            return 0;
        }
        let pads = f32x8::splat(pad);
        let meet = boxes_meet(splat(low - pad), splat(high + pad), other.min, other.max) & !apart(pads);
        near & (meet | self.has_features(i, other, reach, pad)).to_bitmask()
    }

    /// Lanes of `other` whose triangles may have a feature with that in lane `i` whose points are no farther apart than
    /// `reach`. The points of one lie on a line along its normal: that of a face, or one that is at most
    /// [`Placed::edge_turn`] from those of the faces at both its edges.
    #[inline]
    fn has_features(&self, i: usize, other: &Self, reach: f32, pad: f32) -> f32x8 {
        let at = |values: f32x8| f32x8::splat(values.as_array()[i]);
        let direction = splat(lane_of(&self.direction, i));
        let way = sub(other.middle, splat(lane_of(&self.middle, i)));
        // How far beside each other they lie, seen along the normal of either. Without a direction it is nothing.
        let beside = |direction: Points| {
            let across = cross(way, direction);
            dot(across, across)
        };
        let (beside_own, beside_other) = (beside(direction), beside(other.direction));
        let slack = f32x8::splat(8.0 * pad + 2.0 * DIRECTION_ERROR * reach);
        let around = (at(self.around) + other.around) * f32x8::splat(AROUND_ERROR) + slack;
        let square = around * around;
        let vertices = beside_own.simd_le(square) | beside_other.simd_le(square);

        let turn = at(self.edge_turn) + other.edge_turn;
        let sum = each(|k| direction[k] + other.direction[k]);
        let facing = dot(sum, sum).simd_le(turn * turn);
        let swing = |turn: f32x8| {
            let most = around + f32x8::splat(reach) * turn.fast_min(f32x8::ONE);
            most * most
        };
        let edges =
            facing & beside_own.simd_le(swing(at(self.edge_turn))) & beside_other.simd_le(swing(other.edge_turn));
        vertices | edges
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
    let clusters = sides.each_ref().map(|side| side.mesh.lanes().clusters.len());
    let slabs = clusters[0].max(clusters[1]) > COARSE;
    let back = setting.rotation.transpose();
    let ways = [
        (back, -(back * setting.translation)),
        (setting.rotation, setting.translation),
    ];
    [0, 1].map(|i| {
        let (rotation, translation) = ways[i];
        let relative = RelativePose {
            rotation,
            translation: unit * translation,
            // No support axis, and nothing beyond it.
            axis: Vec3::ZERO,
            min_height: f32::NEG_INFINITY,
        };
        Tree::new(
            sides[i].mesh.lanes(),
            i == 1,
            unit * sides[i].scale,
            relative,
            unit * reach,
            slabs,
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::feature::TrianglePair;
    use super::super::pair_of_bodies;
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::{TriMesh, shapes};
    use crate::state::{Bodies, Body};
    use glam::{DVec3, Quat};

    /// The features of all pairs of triangles, and those of the pairs that the search keeps.
    fn features(bodies: &Bodies, meshes: &crate::state::mesh_arena::MeshArena, reach: f64) -> [Vec<DVec3>; 2] {
        let pair = pair_of_bodies(bodies, meshes, [0, 1]).unwrap();
        let sides = &pair.sides;
        let mut near = Near::default();
        near.run(sides, &pair.setting, reach as f32, None);
        let count = |side: &Side| side.features.triangles.len() as u32;
        let all: [Vec<Triangle>; 2] = [0, 1].map(|i| (0..count(&sides[i])).map(|t| sides[i].triangle(t)).collect());
        let of = |pair: [&Triangle; 2], found: &mut Vec<DVec3>| {
            if let Some(pair) = TrianglePair::new(sides, pair, reach) {
                pair.features(&(-reach..=reach), |feature| found.push(feature.middle()));
            }
        };
        let (mut every, mut kept) = (Vec::new(), Vec::new());
        for a in &all[0] {
            for b in &all[1] {
                of([a, b], &mut every);
            }
        }
        near.pairs().for_each(|pair| of(pair, &mut kept));
        [every, kept].map(|mut found| {
            found.sort_by(|p, q| p.to_array().partial_cmp(&q.to_array()).unwrap());
            found
        })
    }

    #[test]
    fn no_feature_is_lost_however_wide_the_margin() {
        let open = shapes::torus(12, 10, 0.7, 0.3);
        let open = TriMesh::new(open.vertices().to_vec(), open.triangles()[..200].to_vec()).unwrap();
        let inward = shapes::ball(0.5, 2);
        let turned = inward.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let inward = TriMesh::new(inward.vertices().to_vec(), turned).unwrap();
        let shapes = [
            shapes::ball(0.5, 2),
            shapes::cube(0.8),
            shapes::torus_240(),
            open,
            inward,
        ];
        let mut meshes = crate::state::mesh_arena::MeshArena::default();
        let slots = shapes.map(|shape| meshes.add(CollisionMesh::new(&shape)));
        let mut random = fastrand::Rng::with_seed(3);
        let mut number = || 2.0 * random.f32() - 1.0;
        let (mut found, mut pairs) = (0, 0);
        for round in 0..120 {
            let mut bodies = Bodies::default();
            for i in 0..2 {
                let at = Vec3::new(number(), number(), number()) * 0.9;
                let turn = Quat::from_xyzw(number(), number(), number(), number() + 0.01);
                let scale = match round % 4 {
                    0 => Vec3::new(1.0, 0.6, 1.3),
                    1 => Vec3::new(-1.0, 1.0, 1.0),
                    _ => Vec3::ONE,
                };
                let body = Body::at_rest(slots[(round + i * (1 + round / 5)) % 5], at, turn, scale);
                bodies.push(&body, &meshes).unwrap();
            }
            let [every, kept] = features(&bodies, &meshes, 0.4);
            assert_eq!(every, kept, "round {round}");
            found += every.len();
            let sides = pair_of_bodies(&bodies, &meshes, [0, 1]).unwrap().sides;
            pairs += sides[0].features.triangles.len() * sides[1].features.triangles.len();
        }
        assert!(found > 200, "{found} features of {pairs} pairs");
    }
}
