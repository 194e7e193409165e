//! Rays against a rounded mesh: where they enter what is within the rounding of its core, or leave it.

use super::placed::Placed;
use super::ray::{Ray, RayHit};
use super::shape::Round;
use glam::DVec3;

/// A ray has left the mesh when it is this near to the surface, in units of the bounding radius.
const LEFT: f64 = 1.0e-10;
/// The most steps of a ray that leaves.
const MAX_STEPS: u32 = 1024;

impl Placed<'_> {
    /// Radius of the rounding, metres; 0 for most meshes.
    pub(super) fn rounding(&self) -> f64 {
        f64::from(crate::state::bodies::rounding(self.mesh(), self.scale()))
    }

    /// Where a ray enters the rounded mesh, or where it leaves it if it starts inside.
    pub(super) fn rounded_hit(&self, ray: &Ray) -> Option<RayHit> {
        let way = ray.way()?;
        let point = Round {
            ends: [ray.origin; 2],
            radius: 0.0,
        };
        if self.overlaps_round(&point) {
            return self.leaving_hit(ray, way);
        }
        let hit = self.cast_round(&point, way, ray.max_distance)?;
        self.round_ray_hit(ray, way, hit.distance, false)
    }

    /// Where a ray that starts inside leaves the rounded mesh. Its surface is nowhere nearer than the rest of the
    /// rounding, or than the core's surface plus the rounding if the ray is in a closed core.
    fn leaving_hit(&self, ray: &Ray, way: DVec3) -> Option<RayHit> {
        let mut distance = 0.0;
        let rounding = self.rounding();
        for _ in 0..MAX_STEPS {
            let at = self.in_axes(ray.origin + way * distance);
            let nearest = self.nearest(at, f64::INFINITY)?.distance;
            let left = if self.contains(at) {
                rounding + nearest
            } else {
                rounding - nearest
            };
            if left <= LEFT * f64::from(self.radius()) {
                break;
            }
            distance += left;
            if distance > ray.max_distance {
                return None;
            }
        }
        self.round_ray_hit(ray, way, distance, true)
    }

    /// The hit at this distance. Face and weights are those of the core's nearest point.
    fn round_ray_hit(&self, ray: &Ray, way: DVec3, distance: f64, from_behind: bool) -> Option<RayHit> {
        let point = ray.origin + way * distance;
        let at = self.in_axes(point);
        let nearest = self.nearest(at, f64::INFINITY)?;
        let outward = self.turn_to_world((at - nearest.point).normalize_or_zero());
        let hit = self.point_hit(at, &nearest, false);
        Some(RayHit {
            distance,
            point,
            normal: if from_behind { -outward } else { outward }.as_vec3(),
            face: hit.face,
            barycentric: hit.barycentric,
            from_behind,
        })
    }
}
