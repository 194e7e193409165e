//! Points and overlaps in a scene.

use super::tree::WorldBox;
use super::{Scene, SolidPlane};
use crate::queries::shape::{PlacedShape, QueryShape, Round};
use crate::queries::{Placed, PointHit};
use glam::{DQuat, DVec3, Vec3};

/// The nearest point of a [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScenePointHit {
    /// The number of the mesh or half-space.
    pub number: usize,
    /// The nearest point of the surface, in the world.
    pub point: DVec3,
    /// From the given point, metres; 0 if that is inside.
    pub distance: f64,
    /// As in [`PointHit`].
    pub normal: Vec3,
    /// The face of the nearest point, an index of the input mesh. `None` on a half-space.
    pub face: Option<u32>,
    /// As in [`PointHit`]; zero on a half-space.
    pub barycentric: Vec3,
    /// Whether the given point is inside.
    pub is_inside: bool,
}

impl Scene {
    /// The point that is nearest to a given one, if it is no farther than `max_distance` metres. That may be infinite. See
    /// [`Placed::closest_point`]. Of several that contain the point it is that of the lowest number.
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
        let mut nearest: Option<ScenePointHit> = None;
        let mut most = max_distance;
        let mut consider = |hit: ScenePointHit, most: &mut f64| {
            let key = |hit: &ScenePointHit| (hit.distance, hit.number);
            if hit.distance <= *most && nearest.as_ref().is_none_or(|nearest| key(&hit) < key(nearest)) {
                *most = hit.distance;
                nearest = Some(hit);
            }
        };
        for (number, plane) in self.planes(&filter) {
            consider(plane.closest_point(number, point), &mut most);
        }
        let tree = self.tree();
        let near = WorldBox {
            center: point,
            half: DVec3::ZERO,
        };
        tree.tree.around(near, most, &mut |index| {
            let number = tree.meshes[index as usize] as usize;
            if filter(number)
                && let Some(hit) = self.placed(number).and_then(|mesh| mesh.closest_point(point, most))
            {
                consider(ScenePointHit::on_mesh(number, hit), &mut most);
            }
            most
        });
        nearest
    }

    /// The numbers of the meshes and half-spaces that a shape with a pose overlaps, ascending. See [`Placed::overlaps`].
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
        let tree = self.tree();
        tree.tree.around(placed.outer_box(), 0.0, &mut |index| {
            let number = tree.meshes[index as usize] as usize;
            let overlaps = |mesh: Placed| match &placed {
                PlacedShape::Mesh(shape) => mesh.overlaps_mesh(shape),
                PlacedShape::Round(round) => mesh.overlaps_round(round),
            };
            if filter(number) && self.placed(number).is_some_and(overlaps) {
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
    /// Its point that is farthest along a unit direction.
    pub(super) fn farthest(&self, direction: DVec3) -> DVec3 {
        match self {
            Self::Mesh(mesh) => mesh.farthest(direction),
            Self::Round(Round { ends: [p, q], radius }) => {
                let end = if direction.dot(*p - *q) > 0.0 { *p } else { *q };
                end + direction * *radius
            }
        }
    }

    /// A box that contains it.
    pub(super) fn outer_box(&self) -> WorldBox {
        match self {
            Self::Mesh(mesh) => {
                let [center, half] = mesh.outer_box();
                WorldBox { center, half }
            }
            Self::Round(Round { ends: [p, q], radius }) => {
                WorldBox::between([p.min(*q) - *radius, p.max(*q) + *radius])
            }
        }
    }
}

impl SolidPlane {
    pub(super) fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.distance
    }

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
