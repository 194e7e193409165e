//! Properties of a body that are constant during a collision substep, and the free rotation that follows from them.

use super::bodies::SolverBody;
use super::islands::Mobility;
use crate::state::bodies::invert_inertia;
use crate::types::body::{ExternalForces, LockedAxes};
use glam::{Mat3, Quat, Vec3, Vec3A};

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
    /// Whether the inertia is the same about all axes: it does not rotate with the body, and there is no gyroscopic
    /// torque.
    isotropic: bool,
    locked: LockedAxes,
    /// Length of the body's substeps, seconds.
    pub h: f32,
    /// Not static, not asleep, with finite motion, and its step is not completed.
    pub moves: bool,
    /// Gyroscopic torque changes the axis about which it rotates.
    pub rotates_freely: bool,
    /// Whether the inertia tensor depends on the rotation.
    pub inertia_rotates: bool,
    /// The change of velocity by gravity in each substep.
    pub gravity: Vec3A,
    /// The impulses of external forces in each substep.
    pub impulse: Vec3A,
    pub angular_impulse: Vec3A,
    /// Factors that damping applies to the velocities in each substep.
    pub linear_decay: f32,
    pub angular_decay: f32,
    pub max_linear_speed: f32,
    pub max_angular_speed: f32,
}

impl BodyConstants {
    /// The constants of a body that does not move.
    pub const NONE: Self = Self {
        initial_rotation: Quat::IDENTITY,
        local_inertia: Mat3::ZERO,
        local_inverse_inertia: Mat3::ZERO,
        isotropic: true,
        locked: LockedAxes::NONE,
        h: 0.0,
        moves: false,
        rotates_freely: false,
        inertia_rotates: false,
        gravity: Vec3A::ZERO,
        impulse: Vec3A::ZERO,
        angular_impulse: Vec3A::ZERO,
        linear_decay: 1.0,
        angular_decay: 1.0,
        max_linear_speed: f32::INFINITY,
        max_angular_speed: f32::INFINITY,
    };

    /// `h` is the length of the body's substeps, seconds.
    pub fn new(
        body: &SolverBody,
        forces: &ExternalForces,
        rotation: Quat,
        mobility: Mobility,
        gravity: Vec3,
        h: f32,
    ) -> Self {
        let movable = mobility.has_impulses();
        let inverse = if movable { body.inverse_inertia } else { Mat3::ZERO };
        // A singular inverse has no inertia tensor: the body cannot rotate about some axis. It rotates freely as if
        // isotropic.
        let inertia = inverted(inverse);
        let size = inverse.x_axis.x;
        let isotropic = (inverse - Mat3::from_diagonal(Vec3::splat(size))).abs_diff_eq(Mat3::ZERO, 1e-5 * size);
        let locked = if movable { body.locked_axes } else { LockedAxes::NONE };
        let free = locked.free_rotation() == Vec3::ONE;
        let decay = |rate: f32| if rate > 0.0 { (-rate * h).exp() } else { 1.0 };
        Self {
            initial_rotation: rotation,
            local_inertia: inertia,
            local_inverse_inertia: inverse,
            isotropic,
            locked,
            h,
            moves: matches!(mobility, Mobility::Moving | Mobility::Movable),
            rotates_freely: movable && free && !isotropic && inertia != Mat3::ZERO,
            inertia_rotates: movable && !(free && isotropic),
            gravity: (gravity * (body.gravity_scale * h) * body.locked_axes.free_translation()).into(),
            impulse: (forces.force * h).into(),
            angular_impulse: (forces.torque * h).into(),
            linear_decay: decay(body.linear_damping),
            angular_decay: decay(body.angular_damping),
            max_linear_speed: body.max_linear_speed,
            max_angular_speed: body.max_angular_speed,
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
        let reduced = inverted(mask * inertia * mask + Mat3::from_diagonal(locked));
        if reduced != Mat3::ZERO && self.local_inertia != Mat3::ZERO {
            mask * reduced * mask
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

/// `rotation * v - v`, without cancellation.
pub(super) fn rotation_displacement(rotation: Quat, v: Vec3A) -> Vec3A {
    let (u, w) = (Vec3A::from(rotation.xyz()), rotation.w);
    let t = 2.0 * u.cross(v);
    w * t + u.cross(t)
}

/// `rotation`, followed by the rotation vector `by` in world axes.
pub(super) fn rotated(rotation: Quat, by: Vec3) -> Quat {
    (Quat::from_scaled_axis(by) * rotation).normalize()
}

/// The inverse of a tensor, or zero.
fn inverted(tensor: Mat3) -> Mat3 {
    invert_inertia(tensor.as_dmat3()).as_mat3()
}
