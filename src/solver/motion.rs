//! Velocities and poses of bodies during a collision substep: they are integrated, and impulses change them.

use super::bodies::{SolverBodies, SolverBody, SolverMotion};
use super::body_constants::{BodyConstants, rotated};
use super::islands::Mobility;
use super::pace::Pace;
use crate::types::body::ExternalForces;
use glam::{DQuat, Mat3A, Quat, Vec3, Vec3A};
use std::ops::Range;

/// Velocity of a body in world axes, m/s and rad/s.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Velocity {
    pub linear: Vec3A,
    pub angular: Vec3A,
}

/// How impulses change the velocity of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mass {
    /// Along each world axis, 1/kg; zero along locked axes and for bodies that impulses do not move.
    pub inverse_mass: Vec3A,
    /// In world axes, 1/(kg m^2).
    pub inverse_inertia: Mat3A,
}

/// Change of a body's pose since the start of the collision substep. It is separate from the pose because small numbers
/// have a finer resolution.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseChange {
    pub translation: Vec3A,
    /// In world axes.
    pub rotation: Quat,
}

/// The states of bodies, one for each slot of the [`Islands`](super::islands::Islands).
#[derive(Clone, Debug, Default)]
pub(super) struct BodyStates {
    velocities: Vec<Velocity>,
    initial_velocities: Vec<Velocity>,
    masses: Vec<Mass>,
    pose_changes: Vec<PoseChange>,
    constants: Vec<BodyConstants>,
}

/// The states of the bodies of one or more bundles.
pub(super) struct StatesMut<'a> {
    pub velocities: &'a mut [Velocity],
    /// Velocities before the impulses of the substep.
    pub initial_velocities: &'a mut [Velocity],
    pub masses: &'a mut [Mass],
    pub pose_changes: &'a mut [PoseChange],
    constants: &'a mut [BodyConstants],
}

impl BodyStates {
    /// States without meaning for `count` slots.
    pub fn resize(&mut self, count: usize) -> StatesMut<'_> {
        self.velocities.resize(count, Velocity::default());
        self.initial_velocities.resize(count, Velocity::default());
        self.masses.resize(count, Mass::NONE);
        self.pose_changes.resize(count, PoseChange::NONE);
        self.constants.resize(count, BodyConstants::NONE);
        StatesMut {
            velocities: &mut self.velocities,
            initial_velocities: &mut self.initial_velocities,
            masses: &mut self.masses,
            pose_changes: &mut self.pose_changes,
            constants: &mut self.constants,
        }
    }

    /// Writes the new pose and velocity of the body of a slot.
    pub fn write_back(&self, slot: usize, motion: &mut SolverMotion) {
        let (velocity, change) = (&self.velocities[slot], &self.pose_changes[slot]);
        motion.center += Vec3::from(change.translation).as_dvec3();
        motion.rotation = (change.rotation.as_dquat() * motion.rotation).normalize();
        if !motion.rotation.is_finite() {
            motion.rotation = DQuat::IDENTITY;
        }
        motion.linear_velocity = velocity.linear.into();
        motion.angular_velocity = velocity.angular.into();
    }
}

impl<'a> StatesMut<'a> {
    /// The first `slots` states, and the rest.
    pub fn split_at(self, slots: usize) -> (Self, Self) {
        let (velocities, more_velocities) = self.velocities.split_at_mut(slots);
        let (initial_velocities, more_initial_velocities) = self.initial_velocities.split_at_mut(slots);
        let (masses, more_masses) = self.masses.split_at_mut(slots);
        let (pose_changes, more_pose_changes) = self.pose_changes.split_at_mut(slots);
        let (constants, more_constants) = self.constants.split_at_mut(slots);
        let first = Self {
            velocities,
            initial_velocities,
            masses,
            pose_changes,
            constants,
        };
        let rest = Self {
            velocities: more_velocities,
            initial_velocities: more_initial_velocities,
            masses: more_masses,
            pose_changes: more_pose_changes,
            constants: more_constants,
        };
        (first, rest)
    }

    /// Loads pose, velocity and mass of a body, and applies its external impulses. `h` is the length of its substeps,
    /// seconds.
    pub fn load(&mut self, slot: usize, bodies: &SolverBodies, body: usize, mobility: Mobility, gravity: Vec3, h: f32) {
        let (properties, motion, forces) = (&bodies.bodies[body], &bodies.motions[body], &bodies.forces[body]);
        let constants = BodyConstants::new(properties, forces, unit(motion.rotation), mobility, gravity, h);
        let (mut velocity, mut mass) = (Velocity::default(), Mass::NONE);
        if mobility != Mobility::Fixed {
            velocity.linear = motion.linear_velocity.into();
            velocity.angular = motion.angular_velocity.into();
        }
        if properties.has_mass() {
            if mobility.has_impulses() {
                mass = Mass::new(properties, &constants);
            }
            velocity = velocity.after_impulses(&mass, forces, free_axes(properties));
        }
        self.velocities[slot] = velocity;
        self.masses[slot] = mass;
        self.pose_changes[slot] = PoseChange::NONE;
        self.constants[slot] = constants;
    }

    /// Applies gravity, external forces, damping and speed limits over one substep to the bodies of some slots.
    pub fn integrate_velocities(&mut self, slots: Range<usize>) {
        let states = self.velocities[slots.clone()]
            .iter_mut()
            .zip(&self.masses[slots.clone()]);
        for ((velocity, mass), constants) in states.zip(&self.constants[slots]) {
            if mass.is_immovable() {
                continue;
            }
            let mut next = *velocity;
            next.apply_impulse(mass, constants.impulse, constants.angular_impulse);
            next.linear = (next.linear + constants.gravity) * constants.linear_decay;
            next.angular *= constants.angular_decay;
            if next.is_finite() {
                *velocity = next;
            }
            velocity.limit(constants);
        }
    }

    /// Moves and rotates the bodies of some slots over one substep.
    pub fn integrate_poses(&mut self, slots: Range<usize>) {
        let states = self.velocities[slots.clone()]
            .iter_mut()
            .zip(&mut self.masses[slots.clone()])
            .zip(&mut self.pose_changes[slots.clone()]);
        for (((velocity, mass), pose_change), constants) in states.zip(&self.constants[slots]) {
            if !constants.moves {
                continue;
            }
            let h = constants.h;
            velocity.limit(constants);
            pose_change.translation += velocity.linear * h;
            if velocity.angular == Vec3A::ZERO {
                continue;
            }
            if constants.rotates_freely && mass.inverse_inertia != Mat3A::ZERO {
                let rotation_change = &mut pose_change.rotation;
                velocity.angular = constants
                    .rotate_freely(velocity.angular.into(), rotation_change, h)
                    .into();
            } else {
                pose_change.rotation = rotated(pose_change.rotation, (velocity.angular * h).into());
            }
            if constants.inertia_rotates && mass.inverse_inertia != Mat3A::ZERO {
                mass.inverse_inertia = constants
                    .inverse_inertia(pose_change.rotation * constants.initial_rotation)
                    .into();
            }
        }
    }

    /// Limits the speeds that contacts caused in the last substep, for the bodies of some slots.
    pub fn limit_speeds(&mut self, slots: Range<usize>) {
        for (velocity, constants) in self.velocities[slots.clone()].iter_mut().zip(&self.constants[slots]) {
            if constants.moves {
                velocity.limit(constants);
            }
        }
    }
}

impl Mass {
    /// The mass of a body that no impulse moves.
    const NONE: Self = Self {
        inverse_mass: Vec3A::ZERO,
        inverse_inertia: Mat3A::ZERO,
    };

    /// The mass of a body in its initial rotation.
    fn new(body: &SolverBody, constants: &BodyConstants) -> Self {
        Self {
            inverse_mass: (body.inverse_mass * body.locked_axes.free_translation()).into(),
            inverse_inertia: constants.inverse_inertia(constants.initial_rotation).into(),
        }
    }

    /// Whether no impulse changes its velocity.
    pub fn is_immovable(&self) -> bool {
        self.inverse_mass == Vec3A::ZERO && self.inverse_inertia == Mat3A::ZERO
    }
}

impl PoseChange {
    const NONE: Self = Self {
        translation: Vec3A::ZERO,
        rotation: Quat::IDENTITY,
    };
}

impl Velocity {
    fn apply_impulse(&mut self, mass: &Mass, linear: Vec3A, angular: Vec3A) {
        self.linear += mass.inverse_mass * linear;
        self.angular += mass.inverse_inertia * angular;
    }

    /// The velocity along the `free` axes after external impulses; this one if that is not finite.
    fn after_impulses(self, mass: &Mass, forces: &ExternalForces, free: [Vec3; 2]) -> Self {
        let mut next = self;
        next.apply_impulse(mass, forces.impulse.into(), forces.angular_impulse.into());
        next.linear *= Vec3A::from(free[0]);
        next.angular *= Vec3A::from(free[1]);
        if next.is_finite() { next } else { self }
    }

    pub fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.angular.is_finite()
    }

    fn limit(&mut self, constants: &BodyConstants) {
        self.linear = limited(self.linear, constants.max_linear_speed);
        self.angular = limited(self.angular, constants.max_angular_speed);
    }
}

/// `v`, shortened to the length `limit` if it is longer. Negative and NaN limits have no effect.
fn limited(v: Vec3A, limit: f32) -> Vec3A {
    let square = v.length_squared();
    if limit >= 0.0 && square > limit * limit {
        v * (limit / square.sqrt())
    } else {
        v
    }
}

/// `rotation` in single precision and of unit length; the identity if its length is zero or not finite.
pub(super) fn unit(rotation: DQuat) -> Quat {
    let length = rotation.length();
    if length > 1.0e-6 && length.is_finite() {
        (rotation / length).as_quat().normalize()
    } else {
        Quat::IDENTITY
    }
}

/// 1 for each axis along which, and for each about which, the body may move.
fn free_axes(body: &SolverBody) -> [Vec3; 2] {
    [body.locked_axes.free_translation(), body.locked_axes.free_rotation()]
}

/// The linear and angular velocity of a body after external impulses; `None` if these do not move it.
pub(super) fn velocity_after(body: &SolverBody, motion: &SolverMotion, impulses: &ExternalForces) -> Option<[Vec3; 2]> {
    if !body.has_mass() || !motion.is_finite() {
        return None;
    }
    let constants = BodyConstants::new(
        body,
        impulses,
        unit(motion.rotation),
        Mobility::Movable,
        Vec3::ZERO,
        0.0,
    );
    let before = Velocity {
        linear: motion.linear_velocity.into(),
        angular: motion.angular_velocity.into(),
    };
    let mass = Mass::new(body, &constants);
    let mut after = before.after_impulses(&mass, impulses, free_axes(body));
    after.limit(&constants);
    Some([after.linear.into(), after.angular.into()])
}

/// What can change the velocity and the pose of a body.
pub(super) fn mobility(bodies: &SolverBodies, body: usize, pace: Pace) -> Mobility {
    let properties: &SolverBody = &bodies.bodies[body];
    let is_body = bodies.body_of(body as u32) == body as u32;
    if !is_body || !properties.moves() || !bodies.motions[body].is_finite() || bodies.sleep[body].asleep {
        Mobility::Fixed
    } else if properties.has_mass() && has_freedom(properties) {
        if pace.is_done() {
            Mobility::Done
        } else {
            Mobility::Movable
        }
    } else if pace.is_done() {
        Mobility::Fixed
    } else {
        Mobility::Moving
    }
}

/// Whether some impulse changes its velocity: not if all axes are locked.
fn has_freedom(body: &SolverBody) -> bool {
    let free = body.locked_axes;
    free.free_translation() != Vec3::ZERO
        || (free.free_rotation() != Vec3::ZERO && body.inverse_inertia != glam::Mat3::ZERO)
}
