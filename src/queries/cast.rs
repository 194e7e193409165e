//! Casts: where a shape that moves along a line first touches one placed mesh.

use super::placed::Placed;
use super::point::FARTHEST;
use super::ray::unit;
use super::shape::{PlacedShape, QueryShape, Round};
use crate::ccd;
use crate::geometry::cluster::CLUSTER;
use crate::geometry::linear_cast::{self, First};
use crate::simd::bounds::{Boxes, Swept};
use crate::simd::lanes::{Simd, bits, splat_point};
use crate::simd::level::with_simd;
use crate::simd::levels::visit_nearest;
use crate::simd::rounding::PAD;
use glam::{DQuat, DVec3, Vec3};

/// Where a shape that moves along a line first touches a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CastHit {
    /// How far the shape moves until it touches, metres; 0 if it touches or overlaps the mesh at the start.
    pub distance: f64,
    /// A point of the mesh at which they touch, in the world.
    pub point: DVec3,
    /// Unit vector from the mesh to the shape: normal to the face that touches, to both edges that touch, or to the
    /// round shape. At least a little against the direction of the cast, unless the distance is 0.
    pub normal: Vec3,
    /// The face of the mesh, an index of the source mesh.
    pub face: u32,
    /// The face of the shape if that is a mesh, unless the shape touches at the start.
    pub shape_face: Option<u32>,
}

/// Memory of casts, reused from one to the next. Keep one for each thread.
#[derive(Default)]
pub struct CastScratch {
    search: ccd::Scratch,
}

/// Relative allowance for the rounding of radii.
const ROUNDING: f64 = 1.0e-6;

impl Placed<'_> {
    /// The first touch of a shape that starts with a pose and moves up to `max_distance` metres, which may be infinite,
    /// along `direction` of any length, without turning.
    ///
    /// * The distance is exact up to rounding, about 10^-9 of the size of the faces: the shape moved by it touches the
    ///   mesh, and on the way there is apart. Between rounded meshes it is up to a millionth of the smaller bounding
    ///   radius too short.
    /// * A shape that touches or overlaps the mesh at the start, as [`Placed::overlaps`] tells, has distance 0, also if
    ///   it moves away. So keep a shape that shall slide along a floor a little above it. Point, normal and face are
    ///   then those of [`Placed::closest_point`] for the centre of the shape; for a mesh that is its centre of mass.
    /// * If it touches in several places at once, the hit is a face rather than an edge, and the one most directly
    ///   against the direction.
    /// * A shape inside a room or a hollow hits its wall from inside.
    /// * A face that moves in its own plane does not hit faces in the same plane, but those at their edges.
    /// * There is no hit if the shape or the pose is not valid, the direction is zero or not finite, the distance is
    ///   negative or NaN, or the shape is farther than 10^18 m away.
    pub fn cast(
        &self,
        shape: &QueryShape,
        translation: DVec3,
        rotation: DQuat,
        direction: DVec3,
        max_distance: f64,
        scratch: &mut CastScratch,
    ) -> Option<CastHit> {
        let way = unit(direction).filter(|_| max_distance >= 0.0)?;
        let hit = match shape.placed(translation, rotation)? {
            PlacedShape::Mesh(mesh) if self.overlaps_mesh(&mesh) => self.start_hit(mesh.center_of_mass()),
            PlacedShape::Mesh(mesh) => self.cast_mesh(&mesh, way, max_distance, scratch),
            PlacedShape::Round(round) if self.overlaps_round(&round) => self.start_hit(translation),
            PlacedShape::Round(round) => self.cast_round(&round, way, max_distance),
        }?;
        // A box has no faces to report.
        let shape_face = hit.shape_face.filter(|_| matches!(shape, QueryShape::Mesh(..)));
        Some(CastHit { shape_face, ..hit })
    }

    /// The hit of a shape that touches at the start.
    fn start_hit(&self, center: DVec3) -> Option<CastHit> {
        let hit = self.closest_point(center, f64::INFINITY)?;
        Some(CastHit {
            distance: 0.0,
            point: hit.point,
            normal: hit.normal,
            face: hit.face,
            shape_face: None,
        })
    }

    /// The span of the way, metres, in which a ball about a point, given relative to the centre of mass, overlaps the
    /// bounding sphere.
    fn span(&self, from: DVec3, radius: f64, way: DVec3, max_distance: f64) -> Option<[f64; 2]> {
        if from.length() >= FARTHEST {
            return None;
        }
        let reach = (radius + f64::from(self.radius())) * (1.0 + ROUNDING) + 1.0e-14 * from.length();
        let nearest = -from.dot(way);
        let gap = (from + way * nearest).length();
        if gap > reach {
            return None;
        }
        let half = ((reach - gap) * (reach + gap)).sqrt();
        let [first, last] = [(nearest - half).max(0.0), (nearest + half).min(max_distance)];
        (first <= last).then_some([first, last])
    }

    fn cast_mesh(&self, other: &Placed, way: DVec3, max_distance: f64, scratch: &mut CastScratch) -> Option<CastHit> {
        // Positions are relative to this mesh's translation. The search begins where the bounding spheres meet.
        let origin = self.translation();
        let apart = other.center_of_mass() - self.center_of_mass();
        let [start, end] = self.span(apart, f64::from(other.radius()), way, max_distance)?;
        let offset = other.translation() - origin + way * start;
        let length = (end - start).max(f64::MIN_POSITIVE);
        let [a, b] = [(self, DVec3::ZERO), (other, offset)];
        let corners = |(placed, at): (&Placed, DVec3), triangle: u32| {
            let corners = placed.corners(triangle as usize);
            corners.map(|p| at + placed.turn_to_world(p))
        };
        let mut first = First::new(way);
        let meshes = [a, b].map(|(placed, at)| moving(placed, at));
        if self.rounding() + other.rounding() > 0.0 {
            return self.cast_rounded(meshes, [start, length], way, other, scratch);
        }
        ccd::cast(&meshes, way * length, &mut scratch.search, &mut |pair| {
            let [corners_a, corners_b] = [corners(a, pair[0]), corners(b, pair[1])];
            if let Some(touch) = linear_cast::triangles(&corners_a, &corners_b, way) {
                first.add(touch, pair);
            }
            first.most() / length
        });
        let (touch, [triangle, other_triangle]) = first.found()?;
        let distance = start + touch.distance;
        (distance <= max_distance).then(|| CastHit {
            distance,
            point: origin + touch.point,
            normal: touch.normal.as_vec3(),
            face: self.mesh().mesh.face_ids()[triangle as usize],
            shape_face: Some(other.mesh().mesh.face_ids()[other_triangle as usize]),
        })
    }

    /// The first touch of two meshes one of which is rounded, that are given at the start of a way with this length.
    fn cast_rounded(
        &self,
        meshes: [ccd::Moving; 2],
        [start, length]: [f64; 2],
        way: DVec3,
        other: &Placed,
        scratch: &mut CastScratch,
    ) -> Option<CastHit> {
        let touch = ccd::cast_rounded(&meshes, way * length, &mut scratch.search)?;
        let Some([face, other_face]) = touch.triangles else {
            // They are within the tolerance there, or the search took too long.
            let distance = start + touch.time * length;
            let hit = self.start_hit(other.center_of_mass() + way * distance)?;
            return Some(CastHit { distance, ..hit });
        };
        Some(CastHit {
            distance: start + touch.time * length,
            point: self.translation() + touch.point,
            normal: touch.normal.as_vec3(),
            face: self.mesh().mesh.face_ids()[face as usize],
            shape_face: Some(other.mesh().mesh.face_ids()[other_face as usize]),
        })
    }

    pub(super) fn cast_round(&self, round: &Round, way: DVec3, max_distance: f64) -> Option<CastHit> {
        let rounding = self.rounding();
        // The core touches a shape that is wider by the rounding.
        let (ends, radius) = (round.ends.map(|end| self.in_axes(end)), round.radius + rounding);
        let way = self.frame().rotation.transpose() * way;
        let center = (ends[0] + ends[1]) * 0.5 - self.axes_center();
        let half = ends[0].distance(ends[1]) * 0.5;
        let [start, end] = self.span(center, half + radius, way, max_distance)?;
        let swept = SweptRound {
            placed: self,
            ends: ends.map(|p| p + way * start),
            radius,
            way,
        };
        let mut first = First::new(way);
        let mut touches = |triangle: usize| {
            if let Some(touch) = linear_cast::round(&self.corners(triangle), swept.ends, radius, way) {
                first.add(touch, triangle);
            }
            first.most().min(end - start)
        };
        with_simd!(simd => swept.search(simd, end - start, &mut touches));
        let (touch, triangle) = first.found()?;
        let distance = start + touch.distance;
        let normal = self.turn_to_world(touch.normal);
        (distance <= max_distance).then(|| CastHit {
            distance,
            point: self.in_world(touch.point) + normal * rounding,
            normal: normal.as_vec3(),
            face: self.mesh().mesh.face_ids()[triangle],
            shape_face: None,
        })
    }
}

/// A mesh for the search, with its origin at a point.
fn moving<'a>(placed: &Placed<'a>, at: DVec3) -> ccd::Moving<'a> {
    ccd::Moving {
        mesh: placed.mesh(),
        scale: placed.scale(),
        rotation: DQuat::from_mat3(&placed.frame().rotation),
        center: at + placed.center_offset(),
        radius: f64::from(placed.radius()) * (1.0 + ROUNDING),
        rounding: placed.rounding(),
    }
}

/// A round shape that moves along a line, in the mesh's own axes.
struct SweptRound<'a> {
    placed: &'a Placed<'a>,
    ends: [DVec3; 2],
    radius: f64,
    way: DVec3,
}

impl SweptRound<'_> {
    /// Calls `touches` with the triangles whose boxes it may meet within `most` metres, nearer ones first. It returns
    /// the distance of interest from then on.
    #[inline(always)]
    fn search<S: Simd>(&self, simd: S, most: f64, touches: &mut impl FnMut(usize) -> f64) {
        let (mesh, [p, q]) = (self.placed.mesh(), self.ends);
        let lanes = mesh.lanes();
        let scales = splat_point(simd, self.placed.scale());
        let half = (p - q).abs() * 0.5 + self.radius;
        let pad = 2.0 * PAD * (self.placed.radius() + half.length() as f32);
        let start = (p + q) * 0.5 - self.placed.axes_center();
        let swept = Swept::new(simd, start, half, self.way.as_vec3(), pad);
        let up = |most: f64| (most * (1.0 + 1.0e-6)) as f32 + pad;
        let mut limit = up(most);
        visit_nearest(
            &lanes.levels,
            limit,
            #[inline(always)]
            |group, most| swept.bounds(&Boxes::of(simd, group).scaled(scales), most),
            |_| {},
            #[inline(always)]
            |number| {
                let cluster = &lanes.clusters[number as usize];
                let boxes = Boxes::of_triangles(simd, cluster, mesh.mass.center).scaled(scales);
                let (lower, met) = swept.bounds(&boxes, limit);
                for lane in bits(met) {
                    if lower[lane] <= limit {
                        limit = up(touches(number as usize * CLUSTER + lane));
                    }
                }
                limit
            },
        );
    }
}
