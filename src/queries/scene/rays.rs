//! Rays against a scene.

use super::tree::WorldBox;
use super::{First, Scene, SolidPlane};
use crate::queries::{Placed, Ray, RayHit};
use glam::{DVec3, Vec3};

/// Where a ray hits something of a [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneRayHit {
    /// The number of the mesh or plane.
    pub number: usize,
    /// From the start of the ray, metres.
    pub distance: f64,
    /// The point in the world.
    pub point: DVec3,
    /// Unit normal of the surface, on the side from which the ray comes.
    pub normal: Vec3,
    /// The face, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
    /// As in [`RayHit`]; zero on a plane.
    pub barycentric: Vec3,
    /// Whether the ray comes from behind the surface.
    pub from_behind: bool,
}

impl Scene {
    /// The first hit of a ray. For rays that start on or in something, and for invalid ones, see
    /// [`Placed::cast_ray`](crate::queries::Placed::cast_ray). Of hits at the same distance it is that of the lower
    /// number.
    pub fn cast_ray(&self, ray: &Ray, filter: impl Fn(usize) -> bool) -> Option<SceneRayHit> {
        self.cast_ray_predicate(ray, filter, |_| true)
    }

    /// The first hit for which `predicate` holds. It may be called for hits behind the first one.
    pub fn cast_ray_predicate(
        &self,
        ray: &Ray,
        filter: impl Fn(usize) -> bool,
        predicate: impl Fn(&SceneRayHit) -> bool,
    ) -> Option<SceneRayHit> {
        let mut nearest = First::NONE;
        self.rays(ray, &filter, &mut |target, ray| {
            let hit = match target {
                Target::Mesh(number, mesh) => {
                    let is_wanted = |hit: &RayHit| predicate(&SceneRayHit::on_mesh(number, *hit));
                    SceneRayHit::on_mesh(number, mesh.cast_ray_predicate(ray, is_wanted)?)
                }
                Target::Plane(hit) => Some(hit).filter(&predicate)?,
            };
            nearest.add(hit.distance, hit.number, hit);
            nearest.distance()
        });
        nearest.hit()
    }

    /// All hits of a ray in the order of distance, then number, then face.
    pub fn ray_hits(&self, ray: &Ray, filter: impl Fn(usize) -> bool) -> Vec<SceneRayHit> {
        let mut hits = Vec::new();
        self.rays(ray, &filter, &mut |target, ray| {
            match target {
                Target::Mesh(number, mesh) => {
                    let all = mesh.ray_hits(ray);
                    hits.extend(all.into_iter().map(|hit| SceneRayHit::on_mesh(number, hit)));
                }
                Target::Plane(hit) => hits.push(hit),
            }
            None
        });
        hits.sort_by(|a, b| {
            let order = a.distance.total_cmp(&b.distance);
            order.then((a.number, a.face).cmp(&(b.number, b.face)))
        });
        hits
    }

    /// Whether a ray hits anything.
    pub fn hits_ray(&self, ray: &Ray, filter: impl Fn(usize) -> bool) -> bool {
        let mut hits = false;
        self.rays(ray, &filter, &mut |target, ray| {
            hits |= match target {
                Target::Mesh(_, mesh) => mesh.hits_ray(ray),
                Target::Plane(_) => true,
            };
            hits.then_some(f64::NEG_INFINITY)
        });
        hits
    }

    /// Calls `found` with what a ray may hit, and the ray as far as hits are wanted. `found` returns the distance up to
    /// which to go on; a negative one ends the search.
    fn rays(&self, ray: &Ray, filter: &impl Fn(usize) -> bool, found: &mut dyn FnMut(Target, &Ray) -> Option<f64>) {
        let Some(way) = ray.way() else { return };
        let mut ray = *ray;
        for (number, plane) in self.planes(filter) {
            if let Some(hit) = plane.cast_ray(number, &ray, way)
                && let Some(most) = found(Target::Plane(hit), &ray)
            {
                ray.max_distance = most;
            }
        }
        if ray.max_distance < 0.0 {
            return;
        }
        let (start, most) = (WorldBox::point(ray.origin), ray.max_distance);
        self.meshes_along(start, way, most, filter, &mut |number, mesh| {
            if let Some(most) = found(Target::Mesh(number, mesh), &ray) {
                ray.max_distance = most;
            }
            ray.max_distance
        });
    }
}

/// What a ray may hit.
enum Target<'a> {
    Mesh(usize, Placed<'a>),
    Plane(SceneRayHit),
}

impl SceneRayHit {
    fn on_mesh(number: usize, hit: RayHit) -> Self {
        let RayHit {
            distance,
            point,
            normal,
            face,
            barycentric,
            from_behind,
        } = hit;
        Self {
            number,
            distance,
            point,
            normal,
            face: Some(face),
            barycentric,
            from_behind,
        }
    }
}

impl SolidPlane {
    fn cast_ray(&self, number: usize, ray: &Ray, way: DVec3) -> Option<SceneRayHit> {
        let height = self.height(ray.origin);
        let fall = -self.normal.dot(way);
        if fall == 0.0 {
            return None;
        }
        let distance = height / fall;
        let hits = distance >= 0.0 && distance <= ray.max_distance;
        hits.then(|| SceneRayHit {
            number,
            distance,
            point: ray.origin + way * distance,
            normal: (self.normal * fall.signum()).as_vec3(),
            face: None,
            barycentric: Vec3::ZERO,
            from_behind: fall < 0.0,
        })
    }
}
