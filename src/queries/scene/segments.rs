//! Segments in a scene.

use super::tree::WorldBox;
use super::{First, Scene, SolidPlane};
use crate::queries::SegmentHit;
use glam::{DVec3, Vec3};

/// How a segment lies beside the nearest surface of a [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneSegmentHit {
    /// The number of the mesh or plane.
    pub number: usize,
    /// As in [`SegmentHit`].
    pub distance: f64,
    /// A point of the surface, in the world.
    pub point: DVec3,
    /// As in [`SegmentHit`].
    pub normal: Vec3,
    /// The face, an index of the source mesh. `None` on a plane.
    pub face: Option<u32>,
}

impl Scene {
    /// The surface that is nearest to a segment with these ends, or in which it is deepest, if it is no farther than
    /// `max_distance` metres. See [`Placed::closest_to_segment`](crate::queries::Placed::closest_to_segment). Of
    /// several at the same distance it is that of the lowest number.
    pub fn closest_to_segment(
        &self,
        ends: [DVec3; 2],
        max_distance: f64,
        filter: impl Fn(usize) -> bool,
    ) -> Option<SceneSegmentHit> {
        let [p, q] = ends;
        if !(p.is_finite() && q.is_finite() && max_distance >= 0.0) {
            return None;
        }
        let mut first = First::NONE;
        for (number, plane) in self.planes(&filter) {
            let hit = plane.closest_to_segment(number, ends);
            if hit.distance <= max_distance {
                first.add(hit.distance, number, hit);
            }
        }
        // The deepest surface counts, so everything that overlaps is looked at.
        let most = |first: &First<_>| first.most(max_distance).max(0.0);
        let segment = WorldBox::between([p.min(q), p.max(q)]);
        self.meshes_around(segment, most(&first), &filter, &mut |number, mesh| {
            if let Some(hit) = mesh.closest_to_segment(ends, most(&first)) {
                first.add(hit.distance, number, SceneSegmentHit::on_mesh(number, hit));
            }
            most(&first)
        });
        first.hit()
    }
}

impl SceneSegmentHit {
    fn on_mesh(number: usize, hit: SegmentHit) -> Self {
        let SegmentHit {
            distance,
            point,
            normal,
            face,
        } = hit;
        Self {
            number,
            distance,
            point,
            normal,
            face: Some(face),
        }
    }
}

impl SolidPlane {
    fn closest_to_segment(&self, number: usize, ends: [DVec3; 2]) -> SceneSegmentHit {
        let [height, other] = ends.map(|end| self.height(end));
        let (end, distance) = if other < height {
            (ends[1], other)
        } else {
            (ends[0], height)
        };
        SceneSegmentHit {
            number,
            distance,
            point: end - self.normal * distance,
            normal: self.normal.as_vec3(),
            face: None,
        }
    }
}
