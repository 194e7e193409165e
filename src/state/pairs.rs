//! Pairs of bodies that may touch, and which of their triangles take part.

use glam::{Mat3, Vec3};

/// A pair that may touch.
#[derive(Clone, Copy, Debug)]
pub struct NearPair {
    /// The two bodies, `a < b`.
    pub bodies: [u32; 2],
    /// Turns `b`'s axes into `a`'s.
    pub rotation: Mat3,
    /// From `a`'s centre of mass to `b`'s, in `a`'s axes, metres.
    pub translation: Vec3,
    /// The support axis along which the two overlap least: a unit vector from `a` to `b` in `a`'s axes.
    pub axis: Vec3,
    /// No point of `b` reaches below this along the axis, measured from `a`'s centre.
    pub b_above: f32,
    /// No point of `a` reaches above this along the axis, measured from `a`'s centre.
    pub a_below: f32,
    /// Which triangles of `a` and of `b` take part.
    pub views: [View; 2],
    /// How near the surfaces must come for contact points to be found, metres.
    pub margin: f32,
}

/// Which triangles of one end of a pair take part in the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// All of them.
    All,
    /// Those of the group of this number in the mesh's [`FaceTable`](crate::projection::FaceTable).
    Group(u32),
    /// Those whose normal, by the winding of the corners placed in the first body's axes, has a positive product with
    /// this vector. It points to the other body, or away from it where the winding shows the inner side.
    Facing(Vec3),
}

impl NearPair {
    /// Whether a support plane separates the two: they are listed for the margin between them.
    pub fn is_apart(&self) -> bool {
        self.a_below < self.b_above
    }

    /// Whether some triangles are left out although they may touch.
    pub fn is_approximate(&self) -> bool {
        self.views != [View::All; 2]
    }
}
