//! The motion of a body during a collision substep.

use crate::state::Bodies;
use glam::{DMat3, DQuat, DVec3};

/// Position and rotation of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Centre of mass in the world, metres.
    pub center: DVec3,
    /// From the body's axes to the world's; of unit length.
    pub rotation: DQuat,
}

impl Pose {
    /// The pose of body `i`.
    pub(super) fn of(bodies: &Bodies, i: usize) -> Self {
        match bodies.compound_of(i as u32) {
            Some(compound) => Self {
                center: compound.center,
                rotation: compound.rotation,
            },
            None => Self {
                center: bodies.frame[i].center,
                rotation: bodies.rotation[i].as_dquat().normalize(),
            },
        }
    }
}

/// The motion of a body during a collision substep: its centre of mass moves along a line at constant velocity, and it
/// rotates about it at constant angular velocity. Times are fractions of the collision substep, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sweep {
    /// The pose at the start.
    pub before: Pose,
    /// Displacement of the centre of mass, metres: velocity times length of the collision substep.
    pub travel: DVec3,
    /// Rotation vector in world axes, radians: angular velocity times length of the collision substep. It may have any
    /// length, for several revolutions.
    pub turn: DVec3,
}

impl Sweep {
    /// From pose to pose, by the shorter rotation. For a rotation by more than half a revolution set [`Sweep::turn`]
    /// instead, because poses do not determine it.
    pub fn between(before: Pose, after: Pose) -> Self {
        let rotation = after.rotation * before.rotation.inverse();
        // A quaternion and its negative are the same rotation; the one with positive `w` is the shorter one.
        let shorter = if rotation.w < 0.0 { -rotation } else { rotation };
        Self {
            before,
            travel: after.center - before.center,
            turn: shorter.to_scaled_axis(),
        }
    }

    /// This motion for axes that are turned by `rotation` in the body.
    pub(super) fn turned(&self, rotation: DQuat) -> Self {
        let before = Pose {
            rotation: (self.before.rotation * rotation).normalize(),
            ..self.before
        };
        Self { before, ..*self }
    }

    /// The motion of a body at rest.
    pub fn at_rest(pose: Pose) -> Self {
        Self {
            before: pose,
            travel: DVec3::ZERO,
            turn: DVec3::ZERO,
        }
    }

    /// The pose at time `t`.
    pub fn at(&self, t: f64) -> Pose {
        Pose {
            center: self.before.center + self.travel * t,
            rotation: (DQuat::from_scaled_axis(self.turn * t) * self.before.rotation).normalize(),
        }
    }

    /// The part of the motion between two times.
    pub fn part(&self, from: f64, to: f64) -> Self {
        Self {
            before: self.at(from),
            travel: self.travel * (to - from),
            turn: self.turn * (to - from),
        }
    }

    /// Whether all numbers are finite and the rotation is of unit length.
    pub(super) fn is_valid(&self) -> bool {
        let Pose { center, rotation } = self.before;
        center.is_finite() && rotation.is_normalized() && self.travel.is_finite() && self.turn.is_finite()
    }

    /// From the body's axes to the world's at time `t`.
    pub(super) fn axes(&self, t: f64) -> DMat3 {
        DMat3::from_quat(self.at(t).rotation)
    }
}
