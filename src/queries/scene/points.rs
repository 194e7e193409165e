//! Points and overlaps in a scene.

use super::tree::WorldBox;
use super::{First, Scene, SolidPlane};
use crate::queries::PointHit;
use crate::queries::shape::{PlacedShape, QueryShape};
use glam::{DQuat, DVec3, Vec3};

/// The nearest point of a [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScenePointHit {
    /// The number of the mesh or plane.
    pub number: usize,
    /// The nearest point of the surface, in the world.
    pub point: DVec3,
    /// From the given point, metres; 0 if that is inside.
    pub distance: f64,
    /// As in [`PointHit`].
    pub normal: Vec3,
    /// The face of the nearest point, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
    /// As in [`PointHit`]; zero on a plane.
    pub barycentric: Vec3,
    /// Whether the given point is inside.
    pub is_inside: bool,
}

impl Scene {
    /// The point that is nearest to a given one, if it is no farther than `max_distance` metres. That may be infinite.
    /// See [`Placed::closest_point`](crate::queries::Placed::closest_point). Of several that contain the point it is
    /// that of the lowest number.
    pub fn closest_point(
        &self,
        point: DVec3,
        max_distance: f64,
        filter: impl Fn(usize) -> bool,
    ) -> Option<ScenePointHit> {
        let is_valid = point.is_finite() && max_distance >= 0.0;
        if !is_valid {
            return None;
        }
        let mut nearest = First::NONE;
        for (number, plane) in self.planes(&filter) {
            let hit = plane.closest_point(number, point);
            if hit.distance <= max_distance {
                nearest.add(hit.distance, number, hit);
            }
        }
        let most = nearest.most(max_distance);
        self.meshes_around(WorldBox::point(point), most, &filter, &mut |number, mesh| {
            if let Some(hit) = mesh.closest_point(point, nearest.most(max_distance)) {
                nearest.add(hit.distance, number, ScenePointHit::on_mesh(number, hit));
            }
            nearest.most(max_distance)
        });
        nearest.hit()
    }

    /// The numbers of the meshes and planes that a shape with a pose overlaps, ascending. See
    /// [`Placed::overlaps`](crate::queries::Placed::overlaps).
    pub fn overlapping(
        &self,
        shape: &QueryShape,
        translation: DVec3,
        rotation: DQuat,
        filter: impl Fn(usize) -> bool,
    ) -> Vec<usize> {
        let Some(placed) = shape.placed(translation, rotation) else {
            return Vec::new();
        };
        let planes = self
            .planes(&filter)
            .filter(|(_, plane)| plane.height(placed.farthest(-plane.normal)) <= 0.0);
        let mut found: Vec<usize> = planes.map(|(number, _)| number).collect();
        self.meshes_around(placed.outer_box(), 0.0, &filter, &mut |number, mesh| {
            let overlaps = match &placed {
                PlacedShape::Mesh(shape) => mesh.overlaps_mesh(shape),
                PlacedShape::Round(round) => mesh.overlaps_round(round),
            };
            if overlaps {
                found.push(number);
            }
            0.0
        });
        found.sort_unstable();
        found
    }
}

impl ScenePointHit {
    fn on_mesh(number: usize, hit: PointHit) -> Self {
        let PointHit {
            point,
            distance,
            normal,
            face,
            barycentric,
            is_inside,
        } = hit;
        Self {
            number,
            point,
            distance,
            normal,
            face: Some(face),
            barycentric,
            is_inside,
        }
    }
}

impl PlacedShape<'_> {
    /// A box that contains it.
    pub(super) fn outer_box(&self) -> WorldBox {
        match self {
            Self::Mesh(mesh) => WorldBox::of(mesh),
            Self::Round(round) => WorldBox::between(round.bounding_box()),
        }
    }
}

impl SolidPlane {
    fn closest_point(&self, number: usize, point: DVec3) -> ScenePointHit {
        let height = self.height(point);
        ScenePointHit {
            number,
            point: point - height * self.normal,
            distance: height.max(0.0),
            normal: self.normal.as_vec3(),
            face: None,
            barycentric: Vec3::ZERO,
            is_inside: height < 0.0,
        }
    }
}
