//! Bodies as the solver sees them: what they are, how they move, what acts on them.

use crate::components::RigidBody;
use bevy::prelude::{Component, Reflect, ReflectComponent, ReflectDefault};
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
    pub(super) fn moves(&self) -> bool {
        self.kind != RigidBody::Static
    }

    /// Whether forces and contacts move it.
    pub(super) fn has_mass(&self) -> bool {
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

    pub(super) fn is_finite(&self) -> bool {
        self.center.is_finite()
            && self.rotation.is_finite()
            && self.linear_velocity.is_finite()
            && self.angular_velocity.is_finite()
    }
}

/// What acts on a body from outside, beside gravity.
///
/// Forces hold until they are changed; impulses are used up by the next step, which sets them to zero. As a component:
/// add to it, or set it anew, in every step in which something else acts.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct ExternalForces {
    /// At the centre of mass, newtons.
    pub force: Vec3,
    /// Newton metres.
    pub torque: Vec3,
    /// At the centre of mass, newton seconds.
    pub impulse: Vec3,
    /// Newton metre seconds.
    pub angular_impulse: Vec3,
}

impl ExternalForces {
    /// Adds a force, in newtons, that acts at `point` of the world on a body whose centre of mass is at `center` of the world:
    /// [`CenterOfMass::in_world`](crate::components::CenterOfMass::in_world).
    pub fn add_force_at(&mut self, force: Vec3, point: Vec3, center: Vec3) {
        self.force += force;
        self.torque += (point - center).cross(force);
    }

    /// Adds an impulse, in newton seconds, in the same way.
    pub fn add_impulse_at(&mut self, impulse: Vec3, point: Vec3, center: Vec3) {
        self.impulse += impulse;
        self.angular_impulse += (point - center).cross(impulse);
    }

    /// Whether nothing acts.
    pub fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}

/// World axes along which a body does not move, and about which it does not turn: `LockedAxes::ROTATION |
/// LockedAxes::TRANSLATION_Z` for example. Contacts and forces see the body as infinitely heavy there.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct LockedAxes(u8);

impl LockedAxes {
    /// Free.
    pub const NONE: Self = Self(0);
    /// Does not move along x.
    pub const TRANSLATION_X: Self = Self(1);
    /// Does not move along y.
    pub const TRANSLATION_Y: Self = Self(2);
    /// Does not move along z.
    pub const TRANSLATION_Z: Self = Self(4);
    /// Does not turn about x.
    pub const ROTATION_X: Self = Self(8);
    /// Does not turn about y.
    pub const ROTATION_Y: Self = Self(16);
    /// Does not turn about z.
    pub const ROTATION_Z: Self = Self(32);
    /// Does not move.
    pub const TRANSLATION: Self = Self(7);
    /// Does not turn.
    pub const ROTATION: Self = Self(56);

    /// The locks as bits: x, y, z of translation from the lowest, then those of rotation. Other bits are dropped.
    pub fn from_bits(bits: u8) -> Self {
        Self(bits & 63)
    }

    /// See [`LockedAxes::from_bits`].
    pub fn bits(self) -> u8 {
        self.0
    }

    /// 1 for each axis along which the body may move, else 0.
    pub fn free_translation(self) -> Vec3 {
        self.free(0)
    }

    /// 1 for each axis about which the body may turn, else 0.
    pub fn free_rotation(self) -> Vec3 {
        self.free(3)
    }

    fn free(self, shift: u8) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| f32::from(!self.0 >> (shift + axis) & 1)))
    }
}

impl std::ops::BitOr for LockedAxes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// How one coefficient of a pair follows from those of both bodies. If the bodies name different rules, the one that
/// stands later in this list holds.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[reflect(Default, Debug, PartialEq)]
pub enum CombineRule {
    /// Their mean.
    #[default]
    Average,
    /// The root of their product.
    GeometricMean,
    /// The smaller one.
    Min,
    /// Their product.
    Multiply,
    /// The larger one.
    Max,
}

impl CombineRule {
    /// The pair's coefficient; negative or NaN ones count as 0.
    pub fn combine(rules: [Self; 2], coefficients: [f32; 2]) -> f32 {
        // `max` returns the other operand for NaN.
        let [a, b] = coefficients.map(|c| c.max(0.0));
        match rules[0].max(rules[1]) {
            Self::Average => 0.5 * (a + b),
            Self::GeometricMean => (a * b).sqrt(),
            Self::Min => a.min(b),
            Self::Multiply => a * b,
            Self::Max => a.max(b),
        }
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
