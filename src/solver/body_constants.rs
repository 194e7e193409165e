//! Properties of a body that are constant during a collision substep, and the free rotation that follows from them.

use super::bodies::SolverBody;
use super::motion::{rotated, rotation_displacement};
use crate::types::body::LockedAxes;
use glam::{Mat3, Quat, Vec3};

/// Free rotation is integrated in angles of at most this many radians...
pub(super) const FREE_ANGLE: f32 = 0.25;
/// ...in at most this many rounds per substep.
pub(super) const MAX_ROUNDS: f32 = 32.0;

/// Properties of a body that are constant during a collision substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyConstants {
    /// From the body's axes to the world's at the start of the collision substep.
    pub initial_rotation: Quat,
    local_inertia: Mat3,
    local_inverse_inertia: Mat3,
    /// The inertia is the same about all axes, so it does not rotate with the body and there is no gyroscopic torque.
    pub isotropic: bool,
    /// Not static, not asleep, and with finite motion.
    pub moves: bool,
    pub locked: LockedAxes,
    /// Factors that damping applies to the velocities in each substep.
    pub linear_decay: f32,
    pub angular_decay: f32,
}

impl BodyConstants {
    /// Those of a body that does not move.
    pub const NONE: Self = Self {
        initial_rotation: Quat::IDENTITY,
        local_inertia: Mat3::ZERO,
        local_inverse_inertia: Mat3::ZERO,
        isotropic: true,
        moves: false,
        locked: LockedAxes::NONE,
        linear_decay: 1.0,
        angular_decay: 1.0,
    };

    /// `movable` tells whether impulses change its velocity; `h` is the length of a substep, seconds.
    pub fn new(body: &SolverBody, rotation: Quat, moves: bool, movable: bool, h: f32) -> Self {
        let inverse = if movable { body.inverse_inertia } else { Mat3::ZERO };
        let inertia = inverse.inverse();
        // A singular inverse has no inertia tensor: the body cannot rotate about some axis. It rotates as if isotropic.
        let regular = inertia.is_finite();
        let size = inverse.x_axis.x;
        let isotropic =
            !regular || (inverse - Mat3::from_diagonal(Vec3::splat(size))).abs_diff_eq(Mat3::ZERO, 1e-5 * size);
        let decay = |rate: f32| if rate > 0.0 { (-rate * h).exp() } else { 1.0 };
        Self {
            initial_rotation: rotation,
            local_inertia: if regular { inertia } else { Mat3::ZERO },
            local_inverse_inertia: inverse,
            isotropic,
            moves,
            locked: if movable { body.locked_axes } else { LockedAxes::NONE },
            linear_decay: decay(body.linear_damping),
            angular_decay: decay(body.angular_damping),
        }
    }

    /// The inverse inertia in world axes at `rotation`.
    pub fn inverse_inertia(&self, rotation: Quat) -> Mat3 {
        let free = self.locked.free_rotation();
        if self.isotropic && free == Vec3::ONE {
            return self.local_inverse_inertia;
        }
        let axes = Mat3::from_quat(rotation);
        let inverse = axes * self.local_inverse_inertia * axes.transpose();
        if free == Vec3::ONE {
            return inverse;
        }
        // The bearing of a locked axis balances any moment about it. So the locked axes are removed from the inertia
        // tensor, and the rest is inverted. Removing them from the inverse tensor would describe a body that still
        // accelerates about them.
        let inertia = axes * self.local_inertia * axes.transpose();
        let locked = Vec3::ONE - free;
        let mask = Mat3::from_diagonal(free);
        let reduced = (mask * inertia * mask + Mat3::from_diagonal(locked)).inverse();
        let reduced = mask * reduced * mask;
        if reduced.is_finite() && self.local_inertia != Mat3::ZERO {
            reduced
        } else {
            mask * inverse * mask
        }
    }

    /// Rotates a body without torque (gyroscopic motion) over `h` seconds and returns its new angular velocity.
    /// `rotation_change` is its rotation since the start of the collision substep.
    ///
    /// In the body's axes the angular momentum rotates backward, and the angular velocity follows from it; so the
    /// momentum is conserved. The angle comes from the implicit midpoint rule, which is symmetric in time and so keeps
    /// the energy bounded too. All terms are summed as changes: otherwise the rounding of unit quaternions, and of the
    /// inertia times its inverse, would add up to 0.3 % in a minute.
    pub fn rotate_freely(&self, angular: Vec3, rotation_change: &mut Quat, h: f32) -> Vec3 {
        let rounds = (angular.length() * h / FREE_ANGLE).ceil().max(1.0);
        if rounds > MAX_ROUNDS {
            // The orientation of a body that rotates by more than a radian in a millisecond is not visible.
            *rotation_change = rotated(*rotation_change, angular * h);
            return angular;
        }
        let h = h / rounds;
        let (mut next, mut change) = (angular, *rotation_change);
        for _ in 0..rounds as u32 {
            let axes = Mat3::from_quat((change * self.initial_rotation).normalize());
            let inertia = axes * self.local_inertia * axes.transpose();
            let inverse = axes * self.local_inverse_inertia * axes.transpose();
            let momentum = inertia * next;
            // The angular velocity after a rotation by `angle`, in axes that rotate with the body and start as the
            // world's.
            let after = |angle: Vec3| {
                next + inverse * Vec3::from(rotation_displacement(Quat::from_scaled_axis(-angle), momentum.into()))
            };
            let mut middle = next;
            for _ in 0..3 {
                middle = after(middle * (0.5 * h));
            }
            let local = after(middle * h);
            next = local + Vec3::from(rotation_displacement(Quat::from_scaled_axis(middle * h), local.into()));
            change = rotated(change, middle * h);
        }
        if !(next.is_finite() && change.is_finite()) {
            return angular;
        }
        *rotation_change = change;
        next
    }
}
