//! Where a collider is.

use avian3d::math::{Quaternion, Vector};

/// Position of the origin, and rotation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub position: Vector,
    pub rotation: Quaternion,
}

impl Pose {
    /// Where a point is that moves with the collider from here to `now`.
    pub(crate) fn carry(&self, point: Vector, now: &Pose) -> Vector {
        now.position + self.turn(point - self.position, now)
    }

    /// The direction of a vector that turns with the collider from here to `now`.
    pub(crate) fn turn(&self, v: Vector, now: &Pose) -> Vector {
        now.rotation * (self.rotation.inverse() * v)
    }
}
