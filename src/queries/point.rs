//! The nearest point of one placed mesh, and whether a point is inside it.

use super::placed::Placed;
use crate::geometry::cluster::CLUSTER;
use crate::geometry::distance::closest;
use crate::simd::bounds::{Boxes, Near};
use crate::simd::lanes::{Simd, bits, splat_point};
use crate::simd::level::with_simd;
use crate::simd::levels::visit_nearest;
use crate::simd::rounding::PAD;
use crate::triangle_test::cpu::containment;
use glam::{DVec3, Vec3};

/// Points farther away than this find nothing, metres.
pub(super) const FARTHEST: f64 = 1.0e18;

/// The point of a mesh that is nearest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointHit {
    /// The nearest point of the surface, in the world.
    pub point: DVec3,
    /// From the given point to the mesh, metres; 0 if the point is inside.
    pub distance: f64,
    /// Unit vector out of the mesh: from the nearest point to the given one, or back if that is inside. On the surface
    /// it is the normal of the face.
    pub normal: Vec3,
    /// The face of the nearest point, an index of the source mesh.
    pub face: u32,
    /// Weights of the three corners of the face, in their order in the source mesh. They add up to 1.
    pub barycentric: Vec3,
    /// Whether the given point is inside the mesh. Never for rooms, and for open meshes unless they are nearly closed:
    /// see [`TriMesh::caps`](crate::geometry::TriMesh::caps). A point within the rounding of a mesh is inside.
    pub is_inside: bool,
}

/// A unit vector away from a point of a core that is a segment, or a point.
pub(super) fn beside_segment([start, end]: [DVec3; 2]) -> DVec3 {
    match (end - start).try_normalize() {
        Some(along) => along.any_orthonormal_vector(),
        None => DVec3::Y,
    }
}

/// The triangle nearest to a point.
pub(super) struct Nearest {
    pub triangle: usize,
    /// Its nearest point, in [`Placed::in_axes`].
    pub point: DVec3,
    pub distance: f64,
}

impl Placed<'_> {
    /// The point of the mesh that is nearest to `point`, if it is no farther than `max_distance` metres. That may be
    /// infinite.
    ///
    /// A point inside a closed mesh has distance 0, and `point` of the hit is on the surface, however far. Of two faces
    /// at the same distance, for example at a common corner, it is the one of lower number. There is none if a number
    /// is NaN, the distance negative, or the point not finite or farther than 10^18 m away.
    pub fn closest_point(&self, point: DVec3, max_distance: f64) -> Option<PointHit> {
        let from = self.in_axes(point);
        let is_valid = from.is_finite() && from.length() < FARTHEST && max_distance >= 0.0;
        if !is_valid {
            return None;
        }
        let (is_in_core, rounding) = (self.contains(from), self.rounding());
        let most = if is_in_core {
            f64::INFINITY
        } else {
            max_distance + rounding
        };
        let nearest = self.nearest(from, most)?;
        let mut hit = self.point_hit(from, &nearest, is_in_core);
        if rounding > 0.0 {
            hit.point += hit.normal.as_dvec3() * rounding;
            hit.is_inside = is_in_core || hit.distance <= rounding;
            hit.distance = (hit.distance - rounding).max(0.0);
        }
        Some(hit)
    }

    /// Whether a solid mesh contains a point, given in [`Placed::in_axes`].
    pub(super) fn contains(&self, point: DVec3) -> bool {
        let mesh = self.mesh();
        let (aabb, p) = (mesh.lanes().aabb, point / self.frame().scale);
        let from = (p - mesh.mass.center.as_dvec3()).as_vec3();
        // A point barely outside the box is outside the mesh.
        mesh.mesh.is_solid()
            && from.cmpge(aabb.min).all()
            && from.cmple(aabb.max).all()
            && containment::contains(mesh, p)
    }

    /// The nearest triangle, if it is no farther than `most`.
    pub(super) fn nearest(&self, from: DVec3, most: f64) -> Option<Nearest> {
        let mut nearest: Option<Nearest> = None;
        let mut most = most;
        let face = |triangle: usize| self.mesh().mesh.face_ids()[triangle];
        self.visit_near(from, DVec3::ZERO, most, &mut |triangle| {
            let point = closest(from, &self.corners(triangle));
            let distance = point.distance(from);
            let is_tie = |nearest: &Nearest| distance == nearest.distance && face(triangle) < face(nearest.triangle);
            if distance < most || (distance == most && nearest.as_ref().is_none_or(is_tie)) {
                most = distance;
                nearest = Some(Nearest {
                    triangle,
                    point,
                    distance,
                });
            }
            most
        });
        nearest
    }

    /// Calls `found` with the triangles whose boxes may be within `most` of a box given by its centre and half size,
    /// nearer ones first. It returns the distance of interest from then on; minus infinity ends the visit.
    pub(super) fn visit_near(&self, center: DVec3, half: DVec3, most: f64, found: &mut dyn FnMut(usize) -> f64) {
        with_simd!(simd => self.visit_near_with(simd, center, half, most, found));
    }

    #[inline(always)]
    fn visit_near_with<S: Simd>(
        &self,
        simd: S,
        center: DVec3,
        half: DVec3,
        most: f64,
        found: &mut dyn FnMut(usize) -> f64,
    ) {
        let (mesh, scale) = (self.mesh(), self.scale());
        let lanes = mesh.lanes();
        let scales = splat_point(simd, scale);
        let from = center - self.axes_center();
        let pad = PAD * (2.0 * self.radius() + half.length() as f32);
        let near = Near::new(simd, from, half, pad);
        let up = |most: f64| (most * (1.0 + 1.0e-6)) as f32;
        let mut limit = up(most);
        visit_nearest(
            &lanes.levels,
            limit,
            #[inline(always)]
            |group, most| near.bounds(&Boxes::of(simd, group).scaled(scales), most),
            |_| {},
            #[inline(always)]
            |number| {
                let cluster = &lanes.clusters[number as usize];
                let boxes = Boxes::of_triangles(simd, cluster, mesh.mass.center).scaled(scales);
                let (lower, met) = near.bounds(&boxes, limit);
                for lane in bits(met) {
                    if lower[lane] <= limit {
                        limit = up(found(number as usize * CLUSTER + lane));
                    }
                }
                limit
            },
        );
    }

    /// What [`Placed::closest_point`] tells of the nearest triangle.
    pub(super) fn point_hit(&self, from: DVec3, nearest: &Nearest, is_inside: bool) -> PointHit {
        let corners @ [a, b, c] = self.corners(nearest.triangle);
        let way = if is_inside {
            nearest.point - from
        } else {
            from - nearest.point
        };
        let area = (b - a).cross(c - a);
        let rounding = 1.0e-14 * (from.length() + a.length());
        let normal = if nearest.distance > rounding {
            way.normalize()
        } else {
            area.normalize_or(beside_segment([a, c])) * self.mirror()
        };
        PointHit {
            point: self.in_world(nearest.point),
            distance: if is_inside { 0.0 } else { nearest.distance },
            normal: self.turn_to_world(normal).as_vec3(),
            face: self.mesh().mesh.face_ids()[nearest.triangle],
            barycentric: self.barycentric(nearest.triangle, nearest.point, corners),
            is_inside,
        }
    }

    /// Weights of a triangle's corners, which are given, at one of its points; in the order of the source mesh.
    pub(super) fn barycentric(&self, triangle: usize, p: DVec3, [a, b, c]: [DVec3; 3]) -> Vec3 {
        let (ab, ac, ap) = (b - a, c - a, p - a);
        let area = ab.cross(ac);
        let squared = area.length_squared();
        // A triangle that the scale has flattened has no weights.
        let [v, w] = if squared > 0.0 {
            [ap.cross(ac).dot(area), ab.cross(ap).dot(area)].map(|weight| (weight / squared).clamp(0.0, 1.0))
        } else {
            [0.0; 2]
        };
        self.input_order(triangle, [1.0 - v - w, v, w])
    }

    /// Weights of the corners of a triangle, in the order of the source mesh.
    pub(super) fn input_order(&self, triangle: usize, [u, v, w]: [f64; 3]) -> Vec3 {
        let ordered = if self.mesh().mesh.is_turned(triangle) {
            [u, w, v]
        } else {
            [u, v, w]
        };
        Vec3::from_array(ordered.map(|weight| weight as f32))
    }
}
