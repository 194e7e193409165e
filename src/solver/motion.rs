//! What a body does in a pass: take impulses, speed up, move.

use super::bodies::{SolverBodies, SolverBody};
use super::constraints::{Impulse, Pair};
use super::ends::Ends;
use crate::types::body::LockedAxes;
use glam::{DQuat, Mat3, Mat3A, Quat, Vec3, Vec3A};
use rayon::prelude::*;

/// Bodies per task: fewer cost more to hand out than to do.
const GRAIN: usize = 1024;

/// Free rotation is followed in angles of at most this many radians...
pub(super) const FREE_ANGLE: f32 = 0.25;
/// ...of which there are at most this many in a substep.
pub(super) const MAX_ROUNDS: f32 = 32.0;

/// How a body moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Velocity {
    pub linear: Vec3A,
    pub angular: Vec3A,
}

/// How a body gives way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mass {
    /// Along each world axis; zero for what is not pushed and along locked axes.
    pub inverse_mass: Vec3A,
    /// In world axes.
    pub inverse_inertia: Mat3A,
    /// Into how many bodies it is split in this substep: the pairs that push it, at least 1.
    pub share: f32,
}

/// How far a body has come since the start of the interval. Kept apart from its pose because small numbers are finer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shift {
    pub moved: Vec3A,
    pub turned: Quat,
}

/// What about a body's inertia holds for an interval.
#[derive(Clone, Copy, Debug)]
struct Spin {
    /// At the start of the interval.
    rotation: Quat,
    own_inertia: Mat3,
    local_inverse_inertia: Mat3,
    /// Whether the inertia is the same about all axes: it need not be turned, and spin does not change by itself.
    isotropic: bool,
    /// Whether it takes part at all; one whose motion is not finite does not.
    moves: bool,
    locked: LockedAxes,
    /// What is left of the velocities after a substep.
    linear_decay: f32,
    angular_decay: f32,
}

/// All bodies in motion.
#[derive(Clone, Debug, Default)]
pub(super) struct Movers {
    pub velocities: Vec<Velocity>,
    pub masses: Vec<Mass>,
    pub shifts: Vec<Shift>,
    spins: Vec<Spin>,
}

impl Movers {
    pub fn len(&self) -> usize {
        self.velocities.len()
    }

    /// Whether contacts push the body.
    pub fn has_mass(&self, body: usize) -> bool {
        let mass = &self.masses[body];
        mass.inverse_mass != Vec3A::ZERO || mass.inverse_inertia != Mat3A::ZERO
    }

    /// From a body's axes to the world's at the start of the interval.
    pub fn rotation(&self, body: usize) -> Quat {
        self.spins[body].rotation
    }

    /// Takes over poses and velocities, and applies impulses from outside.
    pub fn begin(&mut self, bodies: &mut SolverBodies, h: f32) {
        let count = bodies.len();
        self.velocities.resize(count, Velocity::default());
        self.masses.resize(count, Mass::NONE);
        self.shifts.resize(count, Shift::NONE);
        self.spins.resize(count, Spin::NONE);
        let own = (
            &mut self.velocities,
            &mut self.masses,
            &mut self.shifts,
            &mut self.spins,
        );
        let given = (&bodies.bodies, &bodies.motions, &bodies.sleep, &mut bodies.forces);
        (own.into_par_iter(), given.into_par_iter())
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(|((velocity, mass, shift, spin), (body, motion, sleep, forces))| {
                let moves = body.moves() && motion.is_finite() && !sleep.asleep;
                let pushed = moves && body.has_mass();
                *spin = Spin::new(body, unit(motion.rotation), moves, pushed, h);
                *shift = Shift::NONE;
                *mass = Mass::NONE;
                *velocity = Velocity::default();
                if moves {
                    velocity.linear = motion.linear_velocity.into();
                    velocity.angular = motion.angular_velocity.into();
                }
                if pushed {
                    mass.inverse_mass = (body.inverse_mass * body.locked_axes.free_translation()).into();
                    mass.inverse_inertia = spin.inverse_inertia(spin.rotation).into();
                    let mut next = *velocity;
                    next.take(mass, Impulse::new(forces.impulse, forces.angular_impulse));
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
            });
    }

    /// Gravity, outer forces, damping and speed limits over one substep.
    pub fn accelerate(&mut self, bodies: &SolverBodies, gravity: Vec3, h: f32) {
        (
            &mut self.velocities,
            &self.masses,
            &self.spins,
            &bodies.bodies,
            &bodies.forces,
        )
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(|(velocity, mass, spin, body, forces)| {
                if mass.inverse_mass == Vec3A::ZERO && mass.inverse_inertia == Mat3A::ZERO {
                    return;
                }
                let fall = gravity * (body.gravity_scale * h) * body.locked_axes.free_translation();
                let mut next = *velocity;
                next.take(mass, Impulse::new(forces.force * h, forces.torque * h));
                next.linear = (next.linear + Vec3A::from(fall)) * spin.linear_decay;
                next.angular *= spin.angular_decay;
                if next.is_finite() {
                    *velocity = next;
                }
                velocity.limit(body);
            });
    }

    /// Counts the pairs that push each body in this substep.
    pub fn share_out(&mut self, pairs: &[Pair], ends: &Ends) {
        self.masses
            .par_iter_mut()
            .with_min_len(GRAIN)
            .enumerate()
            .for_each(|(i, mass)| {
                let active = ends.of(i).iter().filter(|&&end| pairs[end as usize / 2].active);
                mass.share = active.count().max(1) as f32;
            });
    }

    /// Takes the sum of the impulses at each body's ends.
    pub fn take(&mut self, impulses: &[[Impulse; 2]], ends: &Ends) {
        (&mut self.velocities, &self.masses)
            .into_par_iter()
            .with_min_len(GRAIN)
            .enumerate()
            .for_each(|(i, (velocity, mass))| {
                let mine = ends.of(i);
                if mine.is_empty() {
                    return;
                }
                let sum = mine.iter().fold(Impulse::default(), |sum, &end| {
                    let impulse = &impulses[end as usize / 2][end as usize % 2];
                    Impulse {
                        linear: sum.linear + impulse.linear,
                        angular: sum.angular + impulse.angular,
                    }
                });
                let mut next = *velocity;
                next.take(mass, sum);
                if next.is_finite() {
                    *velocity = next;
                }
            });
    }

    /// Moves and turns the bodies over one substep.
    pub fn advance(&mut self, bodies: &SolverBodies, h: f32) {
        (
            &mut self.velocities,
            &mut self.masses,
            &mut self.shifts,
            &self.spins,
            &bodies.bodies,
        )
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(|(velocity, mass, shift, spin, body)| {
                if !spin.moves {
                    return;
                }
                velocity.limit(body);
                shift.moved += velocity.linear * h;
                if velocity.angular == Vec3A::ZERO {
                    return;
                }
                if mass.inverse_inertia == Mat3A::ZERO || spin.isotropic || spin.locked.free_rotation() != Vec3::ONE {
                    shift.turned = turn((velocity.angular * h).into(), shift.turned);
                } else {
                    velocity.angular = spin.turn_freely(velocity.angular.into(), &mut shift.turned, h).into();
                }
                if mass.inverse_inertia != Mat3A::ZERO {
                    mass.inverse_inertia = spin.inverse_inertia(shift.turned * spin.rotation).into();
                }
            });
    }

    /// Hands the results back.
    pub fn finish(&mut self, bodies: &mut SolverBodies) {
        (
            &mut bodies.motions,
            &bodies.bodies,
            &mut self.velocities,
            &self.shifts,
            &self.spins,
        )
            .into_par_iter()
            .with_min_len(GRAIN)
            .for_each(|(motion, body, velocity, shift, spin)| {
                if !spin.moves {
                    return;
                }
                velocity.limit(body);
                motion.center += Vec3::from(shift.moved).as_dvec3();
                motion.rotation = (shift.turned.as_dquat() * motion.rotation).normalize();
                if !motion.rotation.is_finite() {
                    motion.rotation = DQuat::IDENTITY;
                }
                motion.linear_velocity = velocity.linear.into();
                motion.angular_velocity = velocity.angular.into();
            });
    }
}

impl Mass {
    /// That of what nothing moves.
    const NONE: Self = Self {
        inverse_mass: Vec3A::ZERO,
        inverse_inertia: Mat3A::ZERO,
        share: 1.0,
    };
}

impl Shift {
    const NONE: Self = Self {
        moved: Vec3A::ZERO,
        turned: Quat::IDENTITY,
    };
}

impl Velocity {
    fn take(&mut self, mass: &Mass, impulse: Impulse) {
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

/// `v`, or a vector along it of length `limit` if it is longer. Negative and NaN limits limit nothing.
fn limited(v: Vec3A, limit: f32) -> Vec3A {
    let square = v.length_squared();
    if limit >= 0.0 && square > limit * limit {
        v * (limit / square.sqrt())
    } else {
        v
    }
}

impl Spin {
    const NONE: Self = Self {
        rotation: Quat::IDENTITY,
        own_inertia: Mat3::ZERO,
        local_inverse_inertia: Mat3::ZERO,
        isotropic: true,
        moves: false,
        locked: LockedAxes::NONE,
        linear_decay: 1.0,
        angular_decay: 1.0,
    };

    fn new(body: &SolverBody, rotation: Quat, moves: bool, pushed: bool, h: f32) -> Self {
        let inverse = if pushed { body.inverse_inertia } else { Mat3::ZERO };
        let inertia = inverse.inverse();
        // A body that cannot be turned about some axis has no inertia to speak of: it turns as if it were a ball.
        let regular = inertia.is_finite();
        let size = inverse.x_axis.x;
        let isotropic =
            !regular || (inverse - Mat3::from_diagonal(Vec3::splat(size))).abs_diff_eq(Mat3::ZERO, 1e-5 * size);
        let decay = |rate: f32| if rate > 0.0 { (-rate * h).exp() } else { 1.0 };
        Self {
            rotation,
            own_inertia: if regular { inertia } else { Mat3::ZERO },
            local_inverse_inertia: inverse,
            isotropic,
            moves,
            locked: if pushed { body.locked_axes } else { LockedAxes::NONE },
            linear_decay: decay(body.linear_damping),
            angular_decay: decay(body.angular_damping),
        }
    }

    /// In world axes, for a body turned by `rotation`.
    fn inverse_inertia(&self, rotation: Quat) -> Mat3 {
        let free = self.locked.free_rotation();
        if self.isotropic && free == Vec3::ONE {
            return self.local_inverse_inertia;
        }
        let turn = Mat3::from_quat(rotation);
        let inverse = turn * self.local_inverse_inertia * turn.transpose();
        if free == Vec3::ONE {
            return inverse;
        }
        // What holds an axis takes up its moment. What is left of the inertia tensor without the axis is inverted; the
        // inverse tensor without the axis would be that of a body that still gives way about it.
        let inertia = turn * self.own_inertia * turn.transpose();
        let held = Vec3::ONE - free;
        let mask = Mat3::from_diagonal(free);
        let left = (mask * inertia * mask + Mat3::from_diagonal(held)).inverse();
        let left = mask * left * mask;
        if left.is_finite() && self.own_inertia != Mat3::ZERO {
            left
        } else {
            mask * inverse * mask
        }
    }

    /// Turns a body on which nothing acts and returns its angular velocity afterwards.
    ///
    /// Seen from the body, its angular momentum turns backward, and angular velocity follows from it: momentum stays what it was.
    /// The angle is that of the implicit midpoint rule, which is symmetric in time and so keeps the energy in bounds too.
    /// Everything is summed as changes: what rounding makes of unit quaternions, and of inertia times its inverse, would add
    /// up otherwise, to 0.3 % in a minute.
    fn turn_freely(&self, angular: Vec3, turned: &mut Quat, h: f32) -> Vec3 {
        let rounds = (angular.length() * h / FREE_ANGLE).ceil().max(1.0);
        if rounds > MAX_ROUNDS {
            // Nobody sees where a body points that turns more than a radian in a millisecond.
            *turned = turn(angular * h, *turned);
            return angular;
        }
        let h = h / rounds;
        let (mut next, mut pose) = (angular, *turned);
        for _ in 0..rounds as u32 {
            let axes = Mat3::from_quat((pose * self.rotation).normalize());
            let inertia = axes * self.own_inertia * axes.transpose();
            let inverse = axes * self.local_inverse_inertia * axes.transpose();
            let momentum = inertia * next;
            // In axes that turn with the body and start as the world's.
            let after =
                |angle: Vec3| next + inverse * Vec3::from(change(Quat::from_scaled_axis(-angle), momentum.into()));
            let mut middle = next;
            for _ in 0..3 {
                middle = after(middle * (0.5 * h));
            }
            let own = after(middle * h);
            next = own + Vec3::from(change(Quat::from_scaled_axis(middle * h), own.into()));
            pose = turn(middle * h, pose);
        }
        if !(next.is_finite() && pose.is_finite()) {
            return angular;
        }
        *turned = pose;
        next
    }
}

/// `turn * v - v`, without the rounding of either.
pub(super) fn change(turn: Quat, v: Vec3A) -> Vec3A {
    let (u, w) = (Vec3A::from(turn.xyz()), turn.w);
    let t = 2.0 * u.cross(v);
    w * t + u.cross(t)
}

/// `rotation` in single precision and of unit length; the identity for what is no rotation.
fn unit(rotation: DQuat) -> Quat {
    let length = rotation.length();
    if length > 1.0e-6 && length.is_finite() {
        (rotation / length).as_quat().normalize()
    } else {
        Quat::IDENTITY
    }
}

/// `rotation`, turned on by an angle vector in world axes.
fn turn(by: Vec3, rotation: Quat) -> Quat {
    (Quat::from_scaled_axis(by) * rotation).normalize()
}
