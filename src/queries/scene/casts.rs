//! Shapes that move through a scene.

use super::{First, Scene, SolidPlane};
use crate::queries::ray::unit;
use crate::queries::shape::PlacedShape;
use crate::queries::{CastHit, CastScratch, QueryShape};
use glam::{DQuat, DVec3, Vec3};

/// Where a shape that moves along a line first touches something of a [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneCastHit {
    /// The number of the mesh or plane.
    pub number: usize,
    /// How far the shape moves until it touches, metres; 0 if it touches or overlaps at the start.
    pub distance: f64,
    /// A point of the surface at which they touch, in the world.
    pub point: DVec3,
    /// Unit vector from what is hit to the shape.
    pub normal: Vec3,
    /// The face, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
    /// The face of the shape if that is a mesh, unless the shape touches at the start.
    pub shape_face: Option<u32>,
}

impl Scene {
    /// The first touch of a shape that starts with a pose and moves up to `max_distance` metres along `direction`,
    /// without turning. See [`Placed::cast`](crate::queries::Placed::cast). Of touches at the same distance it is that
    /// of the lower number.
    pub fn cast(
        &self,
        shape: &QueryShape,
        translation: DVec3,
        rotation: DQuat,
        direction: DVec3,
        max_distance: f64,
        filter: impl Fn(usize) -> bool,
    ) -> Option<SceneCastHit> {
        let way = unit(direction).filter(|_| max_distance >= 0.0)?;
        let placed = shape.placed(translation, rotation)?;
        let mut first = First::NONE;
        for (number, plane) in self.planes(&filter) {
            if let Some(hit) = plane.cast(number, &placed, way, max_distance) {
                first.add(hit.distance, number, hit);
            }
        }
        let most = first.most(max_distance);
        let mut scratch = CastScratch::default();
        self.meshes_along(placed.outer_box(), way, most, &filter, &mut |number, mesh| {
            let most = first.most(max_distance);
            if let Some(hit) = mesh.cast(shape, translation, rotation, way, most, &mut scratch) {
                first.add(hit.distance, number, SceneCastHit::on_mesh(number, hit));
            }
            first.most(max_distance)
        });
        first.hit()
    }
}

impl SceneCastHit {
    fn on_mesh(number: usize, hit: CastHit) -> Self {
        let CastHit {
            distance,
            point,
            normal,
            face,
            shape_face,
        } = hit;
        Self {
            number,
            distance,
            point,
            normal,
            face: Some(face),
            shape_face,
        }
    }
}

impl SolidPlane {
    fn cast(&self, number: usize, shape: &PlacedShape, way: DVec3, most: f64) -> Option<SceneCastHit> {
        let lowest = shape.farthest(-self.normal);
        let (height, fall) = (self.height(lowest), -self.normal.dot(way));
        let distance = if height <= 0.0 { 0.0 } else { height / fall };
        let hits = distance <= most && (height <= 0.0 || fall > 0.0);
        hits.then(|| SceneCastHit {
            number,
            distance,
            point: lowest + way * distance - height.min(0.0) * self.normal,
            normal: self.normal.as_vec3(),
            face: None,
            shape_face: None,
        })
    }
}
