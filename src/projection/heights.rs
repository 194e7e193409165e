//! Support heights: how far a mesh reaches in any direction, as a rigorous upper bound.

use glam::Vec3;

/// Support heights of a point set in a few hundred baked directions.
#[derive(Clone, Debug, PartialEq)]
pub struct SupportHeights {
    heights: Vec<f32>,
}

impl SupportHeights {
    /// Bakes the heights of `points`.
    pub fn of(points: impl Iterator<Item = Vec3>) -> Self {
        let _ = points;
        todo!()
    }

    /// The stored heights, one per baked direction.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// Heights read from a file; `None` if there are not exactly as many as directions, or one is not finite.
    pub fn from_heights(heights: Vec<f32>) -> Option<Self> {
        Some(Self { heights })
    }

    /// A point `p` with `p . u >= max over the baked points of v . u`. `u` need not have unit length.
    ///
    /// `p` lies on the polyhedron that the baked heights cut out around the points, so it is usable as a support point
    /// in Gilbert's iteration, and `p . u` is the interpolated height.
    pub fn support(&self, u: Vec3) -> Vec3 {
        let _ = u;
        todo!()
    }
}
