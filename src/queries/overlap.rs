//! Whether a shape overlaps one placed mesh.

use super::placed::Placed;
use super::shape::{PlacedShape, QueryShape, Round};
use crate::angles::cpu::best_axis;
use crate::geometry::distance::{closest, nearest};
use crate::triangle_test::cpu::{Worker, touch_placed};
use glam::{DQuat, DVec3};
use std::cell::RefCell;

thread_local! {
    /// Each thread keeps the memory of its triangle tests.
    static WORKER: RefCell<Worker> = RefCell::default();
}

impl Placed<'_> {
    /// Whether a shape with a pose touches or overlaps the mesh: their surfaces have a point in common, or one is solid
    /// and contains the other or a connected component of it. [`QueryShape`] tells which shapes are solid; the mesh is
    /// solid if it is closed, unless it is a room.
    ///
    /// Meshes and boxes are tested triangle by triangle, as in a simulation: no touch is missed, and triangles may
    /// count as touching if they are apart by no more than the rounding of their corners in double precision, 1e-14 of
    /// the size of both. Results far from the origin are as exact, because only the difference of the translations
    /// counts. `rotation` may have any length but zero. An invalid shape or pose overlaps nothing.
    pub fn overlaps(&self, shape: &QueryShape, translation: DVec3, rotation: DQuat) -> bool {
        match shape.placed(translation, rotation) {
            Some(PlacedShape::Mesh(mesh)) => self.overlaps_mesh(&mesh),
            Some(PlacedShape::Round(round)) => self.overlaps_round(&round),
            None => false,
        }
    }

    pub(super) fn overlaps_mesh(&self, other: &Placed) -> bool {
        if self.is_beyond(other, 0.0) {
            return false;
        }
        let frames = [self, other].map(|placed| placed.frame_about(self.translation()));
        let [a, b] = [self.in_frame(&frames[0]), other.in_frame(&frames[1])];
        let near = best_axis([&a, &b], 0.0);
        near.is_some_and(|near| WORKER.with_borrow_mut(|worker| touch_placed([&a, &b], &near, worker)))
    }

    pub(super) fn overlaps_round(&self, round: &Round) -> bool {
        let radius = round.radius + self.rounding();
        let [p, q] = round.ends.map(|end| self.in_axes(end));
        let (center, half) = ((p + q) * 0.5, (p - q).abs() * 0.5);
        let reach = half.length() + radius + f64::from(self.radius());
        if center.distance(self.axes_center()) > reach * (1.0 + 1.0e-6) {
            return false;
        }
        let mut touches = false;
        self.visit_near(center, half, radius, &mut |triangle| {
            let corners = self.corners(triangle);
            let distance = if p == q {
                closest(p, &corners).distance(p)
            } else {
                nearest(&corners, &[p, q, q]).distance
            };
            touches = distance <= radius;
            if touches { f64::NEG_INFINITY } else { radius }
        });
        touches || self.contains(p)
    }
}
