//! Rays against one placed mesh, exact on its triangles.

use super::placed::Placed;
use crate::geometry::cluster::CLUSTER;
use crate::geometry::linear_cast::line_meets;
use crate::simd::bounds::{Boxes, Swept};
use crate::simd::lanes::{Simd, bits};
use crate::simd::level::with_simd;
use crate::simd::levels::visit_nearest;
use crate::simd::line::may_meet;
use crate::simd::rounding::PAD;
use glam::{DVec3, Vec3};
use std::hint::black_box;

/// Relative rounding error of a distance.
const ROUNDING: f64 = 1.0e-13;

/// A ray: the points `origin + t * direction` for `t` from 0 on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: DVec3,
    /// Where it goes; of any length but zero.
    pub direction: DVec3,
    /// How far it goes, metres. May be infinite.
    pub max_distance: f64,
}

/// Where a ray hits a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// From the start of the ray, metres.
    pub distance: f64,
    /// The point in the world.
    pub point: DVec3,
    /// Unit normal of the face, on the side from which the ray comes.
    pub normal: Vec3,
    /// The face, an index of the source mesh.
    pub face: u32,
    /// Weights of the three corners of the face, in their order in the source mesh. They add up to 1.
    pub barycentric: Vec3,
    /// Whether the ray comes from behind the face: from inside, if the mesh is closed.
    pub from_behind: bool,
}

impl Ray {
    /// Without an end.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            max_distance: f64::INFINITY,
        }
    }

    /// From `start` to `end`.
    pub fn between(start: DVec3, end: DVec3) -> Self {
        Self {
            origin: start,
            direction: end - start,
            max_distance: start.distance(end),
        }
    }

    /// The unit direction. `None` if the ray hits nothing: if a number is not finite, the direction is zero, or the
    /// length is negative or NaN.
    pub(super) fn way(&self) -> Option<DVec3> {
        unit(self.direction).filter(|_| self.origin.is_finite() && self.max_distance >= 0.0)
    }
}

/// A direction of length 1. `None` if it is zero or not finite.
pub(super) fn unit(direction: DVec3) -> Option<DVec3> {
    // Scaled first, so that no length overflows or underflows.
    (direction / direction.abs().max_element()).try_normalize()
}

impl Placed<'_> {
    /// The first face that a ray hits.
    ///
    /// A ray that starts on a face hits it at distance 0. One that starts inside a closed mesh hits it from behind. Of
    /// two faces that are hit at the same distance, for example at a common edge, it is the one of lower number. A ray
    /// that lies in the plane of a face hits only its neighbours. A ray with a zero direction, a number that is not
    /// finite or a negative length hits nothing.
    ///
    /// A ray hits a rounded mesh where it enters the round surface, or leaves it if it starts inside. The face is then
    /// that of the nearest point of the core.
    pub fn cast_ray(&self, ray: &Ray) -> Option<RayHit> {
        if self.rounding() > 0.0 {
            return self.rounded_hit(ray);
        }
        self.nearest_hit(ray, |_, _| true)
    }

    /// The first face for which `predicate` holds. It may be called for faces behind the first one. Of a rounded mesh
    /// only the first hit is tried.
    pub fn cast_ray_predicate(&self, ray: &Ray, predicate: impl Fn(&RayHit) -> bool) -> Option<RayHit> {
        if self.rounding() > 0.0 {
            return self.rounded_hit(ray).filter(predicate);
        }
        self.nearest_hit(ray, |cast, meeting| predicate(&cast.hit(meeting)))
    }

    /// Whether a ray hits any face. Faster than [`Placed::cast_ray`] where it hits several.
    pub fn hits_ray(&self, ray: &Ray) -> bool {
        if self.rounding() > 0.0 {
            return self.rounded_hit(ray).is_some();
        }
        let mut hits = false;
        self.visit(ray, &mut |_, _| {
            hits = true;
            f64::NEG_INFINITY
        });
        hits
    }

    /// All faces that a ray hits, in the order of distance, then number. A ray through a common edge hits both faces.
    /// A rounded mesh has only its first hit.
    pub fn ray_hits(&self, ray: &Ray) -> Vec<RayHit> {
        if self.rounding() > 0.0 {
            return self.rounded_hit(ray).into_iter().collect();
        }
        self.core_hits(ray)
    }

    /// [`Placed::ray_hits`] of the core.
    pub(super) fn core_hits(&self, ray: &Ray) -> Vec<RayHit> {
        let mut hits = Vec::new();
        self.visit(ray, &mut |cast, meeting| {
            hits.push(cast.hit(&meeting));
            ray.max_distance
        });
        hits.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.face.cmp(&b.face)));
        hits
    }

    fn nearest_hit(&self, ray: &Ray, counts: impl Fn(&Cast, &Meeting) -> bool) -> Option<RayHit> {
        let face = |meeting: &Meeting| self.mesh().mesh.face_ids()[meeting.triangle];
        let mut first: Option<Meeting> = None;
        let cast = self.visit(ray, &mut |cast, meeting| {
            let is_nearer = first.as_ref().is_none_or(|first| {
                meeting.distance < first.distance
                    || (meeting.distance == first.distance && face(&meeting) < face(first))
            });
            if is_nearer && counts(cast, &meeting) {
                first = Some(meeting);
            }
            first.as_ref().map_or(ray.max_distance, |first| first.distance)
        })?;
        Some(cast.hit(&first?))
    }

    /// Calls `found` with where the ray meets faces, those in nearer boxes first. It returns the distance up to which
    /// to go on; minus infinity ends the search. The result is `None` if the ray misses the box of the mesh.
    fn visit<'c>(&'c self, ray: &'c Ray, found: &mut dyn FnMut(&Cast, Meeting) -> f64) -> Option<Cast<'c>> {
        let cast = Cast::new(self, ray, ray.way()?)?;
        let mut next = |triangle: usize, most: f64| {
            let meeting = cast.meeting(triangle, most);
            meeting.map_or(most, |meeting| found(&cast, meeting))
        };
        with_simd!(simd => cast.search(simd, &mut next));
        Some(cast)
    }
}

/// A ray and a placed mesh.
struct Cast<'a> {
    placed: &'a Placed<'a>,
    ray: &'a Ray,
    /// Its unit direction in the world.
    way: DVec3,
    /// The ray from where it enters the box of the mesh on. All triangles are tested from there, so that the distance
    /// to the mesh costs no precision.
    line: Line,
    /// The distance at which it enters, metres.
    enter: f64,
}

/// Where a ray meets a triangle.
struct Meeting {
    triangle: usize,
    distance: f64,
    /// Barycentric weights of the triangle's corners.
    weights: [f64; 3],
}

/// A line in the space of a mesh.
struct Line {
    start: DVec3,
    /// The change per metre in the world.
    way: DVec3,
}

impl<'a> Cast<'a> {
    /// `None` if the ray misses the box of the mesh.
    fn new(placed: &'a Placed<'a>, ray: &'a Ray, way: DVec3) -> Option<Self> {
        let mesh = placed.mesh();
        let frame = placed.frame_about(ray.origin);
        let back = frame.rotation.transpose();
        let from_origin = Line {
            start: (back * -frame.position) / frame.scale,
            way: (back * way) / frame.scale,
        };
        let aabb = mesh.lanes().aabb;
        let bounds = [aabb.min, aabb.max].map(|p| p.as_dvec3() + mesh.mass.center.as_dvec3());
        let pad = 1.0e-6 * f64::from(aabb.half_size().length());
        let enter = from_origin.enters(bounds, pad, ray.max_distance)?;
        Some(Self {
            placed,
            ray,
            way,
            line: Line {
                start: from_origin.start + from_origin.way * enter,
                ..from_origin
            },
            enter,
        })
    }

    /// Calls `hit` with the number of each triangle that the ray may hit and the distance up to which hits are wanted,
    /// at first the length of the ray. It returns the next such distance.
    #[inline(always)]
    fn search<S: Simd>(&self, simd: S, hit: &mut impl FnMut(usize, f64) -> f64) {
        let mesh = self.placed.mesh();
        let lanes = mesh.lanes();
        let (length, way) = (self.line.way.length(), self.line.way.normalize());
        let pad = 2.0 * PAD * lanes.aabb.half_size().length();
        let start = self.line.start - mesh.mass.center.as_dvec3();
        let swept = Swept::new(simd, start, DVec3::ZERO, way.as_vec3(), pad);
        let limit = |most: f64| ((most - self.enter) * length * (1.0 + 1.0e-6)) as f32 + pad;
        let mut most = self.ray.max_distance;
        visit_nearest(
            &lanes.levels,
            limit(most),
            #[inline(always)]
            |group, most| swept.bounds(&Boxes::of(simd, group), most),
            #[inline(always)]
            |cluster| {
                // Loads one number of each third of the cluster, and its end, into the cache.
                let [a, b, c] = &lanes.clusters[cluster as usize].corners;
                black_box((a[0].0[0], b[0].0[0], c[0].0[0], c[2].0[7]));
                mesh.mesh.read_early(cluster as usize * CLUSTER);
            },
            #[inline(always)]
            |cluster| {
                let first = cluster as usize * CLUSTER;
                // In a large mesh memory takes most of the time. So the triangles for the exact test are loaded while
                // this test waits for the cluster.
                mesh.mesh.read_early(first);
                for lane in bits(may_meet(simd, &lanes.clusters[cluster as usize], self.line.start, way)) {
                    most = hit(first + lane, most);
                }
                limit(most)
            },
        );
    }

    /// Where the ray meets a triangle, if that is no farther than `most`.
    fn meeting(&self, triangle: usize, most: f64) -> Option<Meeting> {
        let corners = self.placed.mesh().mesh.corners(triangle);
        let from = corners.map(|p| p.as_dvec3() - self.line.start);
        let (after, weights) = line_meets(self.line.way, from)?;
        let distance = self.enter + after;
        let behind = ROUNDING * (from[0].length() / self.line.way.length() + self.enter);
        (-behind..=most * (1.0 + ROUNDING))
            .contains(&distance)
            .then(|| Meeting {
                triangle,
                distance: distance.max(0.0),
                weights,
            })
    }

    fn hit(&self, meeting: &Meeting) -> RayHit {
        let Self { placed, ray, .. } = self;
        let [a, b, c] = placed.corners(meeting.triangle);
        let area = placed.turn_to_world((b - a).cross(c - a).normalize_or_zero());
        let outward = area * placed.mirror();
        let from_behind = outward.dot(self.way) > 0.0;
        RayHit {
            distance: meeting.distance,
            point: ray.origin + self.way * meeting.distance,
            normal: if from_behind { -outward } else { outward }.as_vec3(),
            face: placed.mesh().mesh.face_ids()[meeting.triangle],
            barycentric: placed.input_order(meeting.triangle, meeting.weights),
            from_behind,
        }
    }
}

impl Line {
    /// The distance, 0 or more, at which it enters a box enlarged by `pad`, if that is no farther than `most`.
    fn enters(&self, [low, high]: [DVec3; 2], pad: f64, most: f64) -> Option<f64> {
        let (mut enter, mut leave) = (0.0f64, most);
        for i in 0..3 {
            let (start, way) = (self.start[i], self.way[i]);
            let (low, high) = (low[i] - pad, high[i] + pad);
            if way == 0.0 {
                if start < low || start > high {
                    return None;
                }
                continue;
            }
            let (s, t) = ((low - start) / way, (high - start) / way);
            enter = enter.max(s.min(t));
            leave = leave.min(s.max(t));
        }
        // Far away the rounding error of the quotients is that of the distance.
        (enter <= leave + 1.0e-12 * enter.abs()).then_some(enter)
    }
}
