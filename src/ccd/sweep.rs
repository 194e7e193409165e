//! How a body moves over an interval.

use glam::{DMat3, DQuat, DVec3};

/// Where a body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of mass in the world, metres.
    pub center: DVec3,
    /// From the body's axes to the world's; of unit length.
    pub rotation: DQuat,
}

/// The motion of a body over an interval: its centre of mass along a line at constant speed, and a turn about it at constant
/// angular velocity. Times are parts of the interval, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// At the start of the interval.
    pub before: Pose,
    /// The way of the centre of mass, metres: velocity times length of the interval.
    pub travel: DVec3,
    /// Along the axis of the turn, in the world, as long as its angle in radians: angular velocity times length of the
    /// interval. Of any length: bodies may turn many times.
    pub turn: DVec3,
}

impl Sweep {
    /// From pose to pose, turning the shorter way. Of a body that turns by more than half a turn poses do not tell how;
    /// give [`Sweep::turn`] instead.
    pub fn between(before: Pose, after: Pose) -> Self {
        let turn = after.rotation * before.rotation.inverse();
        // A quaternion and its negative are the same rotation; the one of positive `w` takes the shorter way.
        let shorter = if turn.w < 0.0 { -turn } else { turn };
        Self {
            before,
            travel: after.center - before.center,
            turn: shorter.to_scaled_axis(),
        }
    }

    /// The motion of a body that stays where it is.
    pub fn at_rest(pose: Pose) -> Self {
        Self {
            before: pose,
            travel: DVec3::ZERO,
            turn: DVec3::ZERO,
        }
    }

    /// Where the body is at time `t`.
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

    /// No point within `radius` of the centre of mass has a longer way, metres.
    pub fn longest_way(&self, radius: f64) -> f64 {
        self.travel.length() + self.turn.length() * radius
    }

    /// Whether all its numbers are numbers, and its rotation is one.
    pub(super) fn is_valid(&self) -> bool {
        let Pose { center, rotation } = self.before;
        center.is_finite() && rotation.is_normalized() && self.travel.is_finite() && self.turn.is_finite()
    }

    /// From the body's axes to the world's at time `t`.
    pub(super) fn axes(&self, t: f64) -> DMat3 {
        DMat3::from_quat(self.at(t).rotation)
    }
}
