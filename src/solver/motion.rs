//! Velocities and poses of bodies during a collision substep: they are integrated, and impulses change them.

use super::adjacency::PairAdjacency;
use super::bodies::{SolverBodies, SolverBody};
use super::body_constants::BodyConstants;
use super::constraints::{Impulse, Pair};
use glam::{DQuat, Mat3A, Quat, Vec3, Vec3A};
use rayon::prelude::*;

/// Smallest number of bodies per task: smaller tasks cost more to schedule than to run.
const GRAIN: usize = 1024;

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
    /// Into how many bodies it is split in this substep: its number of active pairs, at least 1.
    pub split_count: f32,
}

/// Change of a body's pose since the start of the collision substep. It is separate from the pose because small numbers
/// have a finer resolution.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseChange {
    pub translation: Vec3A,
    /// In world axes.
    pub rotation: Quat,
}

/// The states of all bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct BodyStates {
    pub velocities: Vec<Velocity>,
    pub masses: Vec<Mass>,
    pub pose_changes: Vec<PoseChange>,
    constants: Vec<BodyConstants>,
}

impl BodyStates {
    pub fn len(&self) -> usize {
        self.velocities.len()
    }

    /// Whether impulses change the body's velocity.
    pub fn has_mass(&self, body: usize) -> bool {
        let mass = &self.masses[body];
        mass.inverse_mass != Vec3A::ZERO || mass.inverse_inertia != Mat3A::ZERO
    }

    /// From a body's axes to the world's at the start of the collision substep.
    pub fn initial_rotation(&self, body: usize) -> Quat {
        self.constants[body].initial_rotation
    }

    /// Loads poses and velocities, and applies external impulses. `h` is the length of a substep, seconds.
    pub fn begin(&mut self, bodies: &mut SolverBodies, h: f32) {
        let count = bodies.len();
        self.velocities.resize(count, Velocity::default());
        self.masses.resize(count, Mass::NONE);
        self.pose_changes.resize(count, PoseChange::NONE);
        self.constants.resize(count, BodyConstants::NONE);
        let states = (
            &mut self.velocities,
            &mut self.masses,
            &mut self.pose_changes,
            &mut self.constants,
        );
        let inputs = (&bodies.bodies, &bodies.motions, &bodies.sleep, &mut bodies.forces);
        (states.into_par_iter(), inputs.into_par_iter())
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(
                |((velocity, mass, pose_change, constants), (body, motion, sleep, forces))| {
                    let moves = body.moves() && motion.is_finite() && !sleep.asleep;
                    let movable = moves && body.has_mass();
                    *constants = BodyConstants::new(body, unit(motion.rotation), moves, movable, h);
                    *pose_change = PoseChange::NONE;
                    *mass = Mass::NONE;
                    *velocity = Velocity::default();
                    if moves {
                        velocity.linear = motion.linear_velocity.into();
                        velocity.angular = motion.angular_velocity.into();
                    }
                    if movable {
                        mass.inverse_mass = (body.inverse_mass * body.locked_axes.free_translation()).into();
                        mass.inverse_inertia = constants.inverse_inertia(constants.initial_rotation).into();
                        let mut next = *velocity;
                        next.apply_impulse(mass, Impulse::new(forces.impulse, forces.angular_impulse));
                        next.linear *= Vec3A::from(body.locked_axes.free_translation());
                        next.angular *= Vec3A::from(body.locked_axes.free_rotation());
                        if next.is_finite() {
                            *velocity = next;
                        }
                    }
                    if !sleep.asleep {
                        forces.impulse = Vec3::ZERO;
                        forces.angular_impulse = Vec3::ZERO;
                    }
                },
            );
    }

    /// Applies gravity, external forces, damping and speed limits over one substep.
    pub fn integrate_velocities(&mut self, bodies: &SolverBodies, gravity: Vec3, h: f32) {
        (
            &mut self.velocities,
            &self.masses,
            &self.constants,
            &bodies.bodies,
            &bodies.forces,
        )
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(|(velocity, mass, constants, body, forces)| {
                if mass.inverse_mass == Vec3A::ZERO && mass.inverse_inertia == Mat3A::ZERO {
                    return;
                }
                let gravity = gravity * (body.gravity_scale * h) * body.locked_axes.free_translation();
                let mut next = *velocity;
                next.apply_impulse(mass, Impulse::new(forces.force * h, forces.torque * h));
                next.linear = (next.linear + Vec3A::from(gravity)) * constants.linear_decay;
                next.angular *= constants.angular_decay;
                if next.is_finite() {
                    *velocity = next;
                }
                velocity.limit(body);
            });
    }

    /// Splits the mass of each body among its active pairs.
    pub fn split_masses(&mut self, pairs: &[Pair], adjacency: &PairAdjacency) {
        self.masses
            .par_iter_mut()
            .with_min_len(GRAIN)
            .enumerate()
            .for_each(|(i, mass)| {
                let sides = adjacency.sides_of(i).iter();
                let active = sides.filter(|&&side| pairs[side as usize / 2].active);
                mass.split_count = active.count().max(1) as f32;
            });
    }

    /// Applies to each body the sum of the impulses of its pairs.
    pub fn apply_impulses(&mut self, impulses: &[[Impulse; 2]], adjacency: &PairAdjacency) {
        (&mut self.velocities, &self.masses)
            .into_par_iter()
            .with_min_len(GRAIN)
            .enumerate()
            .for_each(|(i, (velocity, mass))| {
                let sides = adjacency.sides_of(i);
                if sides.is_empty() {
                    return;
                }
                let sum = sides.iter().fold(Impulse::default(), |sum, &side| {
                    let impulse = &impulses[side as usize / 2][side as usize % 2];
                    Impulse {
                        linear: sum.linear + impulse.linear,
                        angular: sum.angular + impulse.angular,
                    }
                });
                let mut next = *velocity;
                next.apply_impulse(mass, sum);
                if next.is_finite() {
                    *velocity = next;
                }
            });
    }

    /// Moves and rotates the bodies over one substep.
    pub fn integrate_poses(&mut self, bodies: &SolverBodies, h: f32) {
        (
            &mut self.velocities,
            &mut self.masses,
            &mut self.pose_changes,
            &self.constants,
            &bodies.bodies,
        )
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(|(velocity, mass, pose_change, constants, body)| {
                if !constants.moves {
                    return;
                }
                velocity.limit(body);
                pose_change.translation += velocity.linear * h;
                if velocity.angular == Vec3A::ZERO {
                    return;
                }
                if mass.inverse_inertia == Mat3A::ZERO
                    || constants.isotropic
                    || constants.locked.free_rotation() != Vec3::ONE
                {
                    pose_change.rotation = rotated(pose_change.rotation, (velocity.angular * h).into());
                } else {
                    let rotation_change = &mut pose_change.rotation;
                    velocity.angular = constants
                        .rotate_freely(velocity.angular.into(), rotation_change, h)
                        .into();
                }
                if mass.inverse_inertia != Mat3A::ZERO {
                    mass.inverse_inertia = constants
                        .inverse_inertia(pose_change.rotation * constants.initial_rotation)
                        .into();
                }
            });
    }

    /// Writes the new poses and velocities to `bodies`.
    pub fn write_back(&mut self, bodies: &mut SolverBodies) {
        (
            &mut bodies.motions,
            &bodies.bodies,
            &mut self.velocities,
            &self.pose_changes,
            &self.constants,
        )
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(|(motion, body, velocity, pose_change, constants)| {
                if !constants.moves {
                    return;
                }
                velocity.limit(body);
                motion.center += Vec3::from(pose_change.translation).as_dvec3();
                motion.rotation = (pose_change.rotation.as_dquat() * motion.rotation).normalize();
                if !motion.rotation.is_finite() {
                    motion.rotation = DQuat::IDENTITY;
                }
                motion.linear_velocity = velocity.linear.into();
                motion.angular_velocity = velocity.angular.into();
            });
    }
}

impl Mass {
    /// That of a body that no impulse moves.
    const NONE: Self = Self {
        inverse_mass: Vec3A::ZERO,
        inverse_inertia: Mat3A::ZERO,
        split_count: 1.0,
    };
}

impl PoseChange {
    const NONE: Self = Self {
        translation: Vec3A::ZERO,
        rotation: Quat::IDENTITY,
    };
}

impl Velocity {
    fn apply_impulse(&mut self, mass: &Mass, impulse: Impulse) {
        self.linear += mass.inverse_mass * impulse.linear;
        self.angular += mass.inverse_inertia * impulse.angular;
    }

    fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.angular.is_finite()
    }

    fn limit(&mut self, body: &SolverBody) {
        self.linear = limited(self.linear, body.max_linear_speed);
        self.angular = limited(self.angular, body.max_angular_speed);
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

/// `rotation * v - v`, without cancellation.
pub(super) fn rotation_displacement(rotation: Quat, v: Vec3A) -> Vec3A {
    let (u, w) = (Vec3A::from(rotation.xyz()), rotation.w);
    let t = 2.0 * u.cross(v);
    w * t + u.cross(t)
}

/// `rotation` in single precision and of unit length; the identity if its length is zero or not finite.
fn unit(rotation: DQuat) -> Quat {
    let length = rotation.length();
    if length > 1.0e-6 && length.is_finite() {
        (rotation / length).as_quat().normalize()
    } else {
        Quat::IDENTITY
    }
}

/// `rotation`, followed by the rotation vector `by` in world axes.
pub(super) fn rotated(rotation: Quat, by: Vec3) -> Quat {
    (Quat::from_scaled_axis(by) * rotation).normalize()
}
