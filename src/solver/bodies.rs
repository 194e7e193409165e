//! Bodies as the solver sees them: what they are, how they move, what acts on them.

use crate::types::body::{ExternalForces, LockedAxes, RigidBody};
use crate::types::material::CombineRule;
use glam::{DQuat, DVec3, Mat3, Vec3};

/// What a body is; does not change within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverBody {
    /// How it moves.
    pub kind: RigidBody,
    /// 1/kg. A dynamic body whose value is not positive and finite moves as a kinematic one.
    pub inverse_mass: f32,
    /// In the body's own axes, 1/(kg m^2). Zero for what cannot be turned.
    pub inverse_inertia: Mat3,
    /// Of the bounding sphere around the centre of mass, metres.
    pub radius: f32,
    /// Of the thinnest part, metres; infinite for a half-space.
    pub thickness: f32,
    /// Outgoing over incoming speed, 0 to 1.
    pub restitution: f32,
    /// How the restitution of a pair follows from both bodies'.
    pub restitution_combine: CombineRule,
    /// Coulomb's coefficient, 0 or more, the same for sticking and sliding.
    pub friction: f32,
    /// How the friction of a pair follows from both bodies'.
    pub friction_combine: CombineRule,
    /// Factor on gravity.
    pub gravity_scale: f32,
    /// Rate at which linear velocity decays, 1/s.
    pub linear_damping: f32,
    /// Rate at which angular velocity decays, 1/s.
    pub angular_damping: f32,
    /// Largest speed of the centre of mass, m/s.
    pub max_linear_speed: f32,
    /// Largest angular speed, rad/s.
    pub max_angular_speed: f32,
    /// World axes along and about which it does not move.
    pub locked_axes: LockedAxes,
    /// Whether it takes part in contacts; sensors do not.
    pub solid: bool,
    /// Whether someone else looks after it when it is fast: it does not make a step be cut up.
    pub continuous: bool,
}

impl SolverBody {
    /// Moved by forces and contacts.
    pub fn dynamic(mass: f32, inertia: Mat3, radius: f32) -> Self {
        Self {
            kind: RigidBody::Dynamic,
            inverse_mass: 1.0 / mass,
            inverse_inertia: inertia.inverse(),
            ..Self::immovable(RigidBody::Static, radius)
        }
    }

    /// Without mass: static or kinematic.
    pub fn immovable(kind: RigidBody, radius: f32) -> Self {
        Self {
            kind,
            inverse_mass: 0.0,
            inverse_inertia: Mat3::ZERO,
            radius,
            thickness: f32::INFINITY,
            restitution: 0.0,
            restitution_combine: CombineRule::Average,
            friction: 0.5,
            friction_combine: CombineRule::Average,
            gravity_scale: 1.0,
            linear_damping: 0.0,
            angular_damping: 0.0,
            max_linear_speed: f32::INFINITY,
            max_angular_speed: f32::INFINITY,
            locked_axes: LockedAxes::NONE,
            solid: true,
            continuous: false,
        }
    }

    /// Whether it changes its place at all.
    pub(crate) fn moves(&self) -> bool {
        self.kind != RigidBody::Static
    }

    /// Whether forces and contacts move it.
    pub(crate) fn has_mass(&self) -> bool {
        self.kind == RigidBody::Dynamic
            && self.inverse_mass > 0.0
            && self.inverse_mass.is_finite()
            && self.inverse_inertia.is_finite()
    }
}

/// Where a body is and how it moves. Double precision where small steps add up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverMotion {
    /// Centre of mass in the world.
    pub center: DVec3,
    /// From the body's axes to the world's; of unit length.
    pub rotation: DQuat,
    /// Of the centre of mass, m/s.
    pub linear_velocity: Vec3,
    /// World axes, rad/s.
    pub angular_velocity: Vec3,
}

impl SolverMotion {
    /// At rest, unturned.
    pub fn at(center: DVec3) -> Self {
        Self {
            center,
            rotation: DQuat::IDENTITY,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.center.is_finite()
            && self.rotation.is_finite()
            && self.linear_velocity.is_finite()
            && self.angular_velocity.is_finite()
    }
}

/// Whether a body is frozen, and since when it has been at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SleepState {
    /// Frozen: its velocity is zero and it is as good as static, until something wakes it.
    pub asleep: bool,
    /// For how long it has been slow, seconds.
    pub rest_time: f32,
    /// What it touched when it fell asleep, as a sum of hashes of keys.
    pub neighbours: u64,
}

/// All bodies; one entry per body in every array.
#[derive(Clone, Debug, Default)]
pub struct SolverBodies {
    /// What tells a body from others from step to step, however the bodies are numbered: an entity's bits, for example. No
    /// two bodies share one.
    pub keys: Vec<u64>,
    /// What they are.
    pub bodies: Vec<SolverBody>,
    /// How they move.
    pub motions: Vec<SolverMotion>,
    /// What acts on them.
    pub forces: Vec<ExternalForces>,
    /// Which are frozen.
    pub sleep: Vec<SleepState>,
}

impl SolverBodies {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Removes all, keeping the memory.
    pub fn clear(&mut self) {
        // Every array by name, so that a new one cannot be forgotten.
        let Self {
            keys,
            bodies,
            motions,
            forces,
            sleep,
        } = self;
        keys.clear();
        bodies.clear();
        motions.clear();
        forces.clear();
        sleep.clear();
    }

    /// Adds a body on which nothing acts, awake, and returns its number.
    pub fn push(&mut self, key: u64, body: SolverBody, motion: SolverMotion) -> u32 {
        let number = self.keys.len() as u32;
        self.keys.push(key);
        self.bodies.push(body);
        self.motions.push(motion);
        self.forces.push(ExternalForces::default());
        self.sleep.push(SleepState::default());
        number
    }
}
