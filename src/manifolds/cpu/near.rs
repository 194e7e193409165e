//! Pairs of triangles that are near each other, by a traversal of both bounding-volume trees.
//!
//! Between finely tessellated surfaces a wide margin holds very many such pairs, and few of them have a feature. A
//! vertex lies over a face only if the two overlap when projected along the face's normal. Edges form a feature only if
//! their faces point at each other. Pairs that can neither have a feature nor intersect are dropped here, eight at a
//! time.

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

/// Slabs are tested only for meshes of more clusters than this: the nodes of coarser ones are too round for slabs to
/// pay off.
const MAX_COARSE_CLUSTERS: usize = 300;

/// The relative pose of a pair in single precision.
pub struct PairPose {
    /// Rotation from the second body's axes to the first's.
    pub rotation: Mat3,
    /// From the first body's centre of mass to the second's, in the first's axes, metres.
    pub translation: Vec3,
    /// Sum of the bounding radii, metres.
    pub size: f32,
}

/// Limits the search to some pairs of triangles.
pub struct Window {
    /// Both triangles must meet this box.
    pub around: Aabb,
    /// The first must extend farther along this direction than the second's lower bound. Zero accepts every pair.
    pub direction: Vec3,
}

/// The result, and memory kept between pairs.
#[derive(Default)]
pub struct NearTriangles {
    descent: Descent,
    /// Clusters of the second body, in the order of the traversal.
    seconds: Vec<PlacedCluster>,
    /// Triangles of the first and of the second body that are near a triangle of the other.
    triangles: [Vec<Triangle>; 2],
    /// Indices into `triangles`.
    pairs: Vec<[u32; 2]>,
}

impl NearTriangles {
    /// Finds all pairs of triangles in the window that may be no farther apart than `reach`; some are slightly farther.
    pub fn run(&mut self, sides: &[Side; 2], pose: &PairPose, reach: f32, window: Option<&Window>) {
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
        let pad = PAD * pose.size;
        let reach = reach + pad;
        let [tree_a, tree_b] = trees(sides, pose, reach);
        descent.run(&tree_a, &tree_b);
        let transforms = sides.each_ref().map(ClusterTransform::new);
        seconds.extend(
            descent
                .second()
                .map(|cluster| PlacedCluster::new(&sides[1], &transforms[1], cluster, window)),
        );
        for (cluster, others) in descent.pairs() {
            let mut a = PlacedCluster::new(&sides[0], &transforms[0], cluster, window);
            if a.lanes == 0 {
                continue;
            }
            for &other in others {
                let b = &mut seconds[other as usize];
                for i in bits(a.lanes) {
                    let near = a.near(i, b, reach, pad);
                    if near != 0 {
                        let first = a.triangle_index(&sides[0], i, firsts_near);
                        pairs.extend(bits(near).map(|j| [first, b.triangle_index(&sides[1], j, seconds_near)]));
                    }
                }
            }
        }
    }

    /// The pairs that [`NearTriangles::run`] found.
    pub fn pairs(&self) -> impl Iterator<Item = [&Triangle; 2]> {
        let [a, b] = &self.triangles;
        self.pairs.iter().map(|&[i, j]| [&a[i as usize], &b[j as usize]])
    }
}

/// Eight triangles in single precision, relative to the first body's centre of mass. Only triangles of near pairs are
/// computed in double precision.
struct PlacedCluster {
    corners: [Points; 3],
    /// Cross products of two edges, and their lengths.
    normal: Points,
    length: f32x8,
    /// Outward unit normal; zero where single precision does not determine it.
    direction: Points,
    /// Error bound of a height over the plane per distance to the corner, times the normal's length.
    slack: f32x8,
    /// Centre and radius of a sphere around the corners.
    middle: Points,
    around: f32x8,
    /// Largest angle between the triangle's normal and a contact normal at an edge that it owns, radians.
    edge_rotation: f32x8,
    min: Points,
    max: Points,
    /// Extent along [`Window::direction`].
    min_along: f32x8,
    max_along: f32x8,
    /// Lanes that take part.
    lanes: u32,
    /// Index of the triangle in lane 0.
    first: u32,
    /// Index of each lane's triangle in double precision, or [`NOT_LISTED`].
    triangle_index: [u32; CLUSTER],
}

const NOT_LISTED: u32 = u32::MAX;

/// Places a body's triangles.
struct ClusterTransform {
    rows: Rows,
    /// 1 if placed corners run counter-clockwise seen from outside, else -1.
    outward: f32,
}

impl ClusterTransform {
    fn new(side: &Side) -> Self {
        Self {
            rows: Rows::new(side.matrix().as_mat3()),
            outward: side.winding(),
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
    fn new(side: &Side, transform: &ClusterTransform, cluster: u32, window: Option<&Window>) -> Self {
        let own = &side.mesh.lanes().clusters[cluster as usize];
        let at = splat(side.place(own.origin).as_vec3());
        let [p, q, r] = each(|k| transform.rows.times(own.corners[k]));
        let (u, v) = (sub(q, p), sub(r, p));
        let normal = cross(u, v);
        let [p, q, r] = each(|k| each(|i| [p, q, r][k][i] + at[i]));
        let length = dot(normal, normal).sqrt();
        let slack = f32x8::splat(ERROR) * norm1(u) * norm1(v);
        // Also false for NaN.
        let known = slack.simd_lt(f32x8::splat(DIRECTION_ERROR) * length);
        let inverse = known.bitselect(f32x8::splat(transform.outward) / length, f32x8::ZERO);
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
            edge_rotation: side.edge_normal_rotations(first),
            min: min(p, min(q, r)),
            max: max(p, max(q, r)),
            min_along: f32x8::ZERO,
            max_along: f32x8::ZERO,
            lanes: own.lanes,
            first,
            triangle_index: [NOT_LISTED; CLUSTER],
        };
        if let Some(Window { around, direction }) = window {
            let meet = boxes_meet(placed.min, placed.max, splat(around.min), splat(around.max));
            placed.lanes &= meet.to_bitmask();
            let along = each(|k| dot(splat(*direction), placed.corners[k]));
            placed.min_along = along[0].fast_min(along[1]).fast_min(along[2]);
            placed.max_along = along[0].fast_max(along[1]).fast_max(along[2]);
        }
        placed
    }

    /// Lanes of `other` whose triangles are near the triangle in lane `i`: neither their boxes nor one of their planes
    /// separate them by more than `reach`, and they are in the window. `pad` is the rounding allowance.
    #[inline]
    fn near(&self, i: usize, other: &Self, reach: f32, pad: f32) -> u32 {
        let (low, high) = (lane_of(&self.min, i), lane_of(&self.max, i));
        let last = f32x8::splat(self.max_along.as_array()[i] + pad);
        let boxes = boxes_meet(splat(low - reach), splat(high + reach), other.min, other.max);
        let boxes = (boxes & other.min_along.simd_le(last)).to_bitmask();
        if boxes & other.lanes == 0 {
            return 0;
        }
        // Upper bound of the distance between any two points of two triangles whose boxes are near.
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

    /// Lanes of `other` whose triangles may have a feature of separation up to `reach` with the triangle in lane `i`.
    /// The points of a feature lie on a line along its normal, which is a face's, or within
    /// [`PlacedCluster::edge_rotation`] of the normals of the faces at both edges.
    #[inline]
    fn has_features(&self, i: usize, other: &Self, reach: f32, pad: f32) -> f32x8 {
        let at = |values: f32x8| f32x8::splat(values.as_array()[i]);
        let direction = splat(lane_of(&self.direction, i));
        let way = sub(other.middle, splat(lane_of(&self.middle, i)));
        // Squared lateral distance of the centres, perpendicular to the normal of either. It is zero if the normal is
        // unknown.
        let lateral = |direction: Points| {
            let across = cross(way, direction);
            dot(across, across)
        };
        let (lateral_own, lateral_other) = (lateral(direction), lateral(other.direction));
        let slack = f32x8::splat(8.0 * pad + 2.0 * DIRECTION_ERROR * reach);
        let around = (at(self.around) + other.around) * f32x8::splat(AROUND_ERROR) + slack;
        let square = around * around;
        let vertices = lateral_own.simd_le(square) | lateral_other.simd_le(square);

        let rotation = at(self.edge_rotation) + other.edge_rotation;
        let sum = each(|k| direction[k] + other.direction[k]);
        let facing = dot(sum, sum).simd_le(rotation * rotation);
        let edge_distance = |rotation: f32x8| {
            let most = around + f32x8::splat(reach) * rotation.fast_min(f32x8::ONE);
            most * most
        };
        let edges = facing
            & lateral_own.simd_le(edge_distance(at(self.edge_rotation)))
            & lateral_other.simd_le(edge_distance(other.edge_rotation));
        vertices | edges
    }

    /// Index of lane `i` in the list of triangles, to which it is added if needed.
    #[inline]
    fn triangle_index(&mut self, side: &Side, i: usize, triangles: &mut Vec<Triangle>) -> u32 {
        if self.triangle_index[i] == NOT_LISTED {
            self.triangle_index[i] = triangles.len() as u32;
            triangles.push(side.triangle(self.first + i as u32));
        }
        self.triangle_index[i]
    }
}

/// Both trees. Nodes that are no farther apart than `reach` count as touching.
fn trees<'a>(sides: &[Side<'a>; 2], pose: &PairPose, reach: f32) -> [Tree<'a>; 2] {
    let unit = unit_of(pose.size);
    let clusters = sides.each_ref().map(|side| side.mesh.lanes().clusters.len());
    let slabs = clusters[0].max(clusters[1]) > MAX_COARSE_CLUSTERS;
    let back = pose.rotation.transpose();
    let poses = [(back, -(back * pose.translation)), (pose.rotation, pose.translation)];
    [0, 1].map(|i| {
        let (rotation, translation) = poses[i];
        let relative = RelativePose {
            rotation,
            translation: unit * translation,
            // No support axis is used here.
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

    /// The features of all pairs of triangles, and of the pairs that the search keeps.
    fn features(bodies: &Bodies, meshes: &crate::state::mesh_arena::MeshArena, reach: f64) -> [Vec<DVec3>; 2] {
        let pair = pair_of_bodies(bodies, meshes, [0, 1]).unwrap();
        let sides = &pair.sides;
        let mut near = NearTriangles::default();
        near.run(sides, &pair.pose, reach as f32, None);
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
