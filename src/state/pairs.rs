//! Pairs of bodies that may touch, with their relative pose, best support axis and visible triangles.

use glam::{DVec3, Mat3, Vec3};

/// The direction in which two bodies with the same centre are separated. It is arbitrary, but always the same, and
/// parallel to no edge of a typical mesh.
pub(crate) const DEFAULT_DIRECTION: DVec3 = DVec3::new(0.36, 0.48, 0.8);

/// A pair that may touch.
#[derive(Clone, Copy, Debug)]
pub struct NearPair {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// Rotation from `b`'s axes to `a`'s.
    pub rotation: Mat3,
    /// From `a`'s centre of mass to `b`'s, in `a`'s axes, metres.
    pub translation: Vec3,
    /// The support axis of least overlap: a unit vector from `a` to `b` in `a`'s axes.
    pub axis: Vec3,
    /// Lower bound of `b` along the axis, measured from `a`'s centre of mass, metres.
    pub b_above: f32,
    /// Upper bound of `a` along the axis, measured from `a`'s centre of mass, metres.
    pub a_below: f32,
    /// Which triangles of `a` and of `b` are tested.
    pub views: [View; 2],
    /// Speculative margin, metres.
    pub margin: f32,
}

/// Which triangles of one body of a pair are tested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// All triangles.
    All,
    /// The triangles of this group of the mesh's [`FaceTable`](crate::projection::FaceTable).
    Group(u32),
    /// Triangles whose normal has a positive dot product with this vector. The normal follows from the winding of the
    /// corners placed in the first body's axes. The vector points to the other body, or away from it if the winding
    /// shows the inner side.
    Facing(Vec3),
}

impl NearPair {
    /// Whether the support axis separates the two, so that they are listed only for their speculative margin.
    pub fn is_apart(&self) -> bool {
        self.a_below < self.b_above
    }

    /// Whether an approximate culling mode leaves out triangles that may touch.
    pub fn is_approximate(&self) -> bool {
        self.views != [View::All; 2]
    }
}
