//! What a body is and how it moves, in the words that users spawn and the stages read.

#[cfg(feature = "bevy")]
use bevy::prelude::*;
use glam::Vec3;

/// How a body moves. Pairs are tested if one of the two is dynamic, or one a [`Sensor`] and one kinematic.
///
/// A body is an entity with a [`MeshCollider`] and a `RigidBody`; its pose is its [`Transform`], taken as a pose in the
/// world (spawn bodies as root entities), scale included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq),
    require(Transform, LinearVelocity, AngularVelocity, Sleeping, CenterOfMass)
)]
pub enum RigidBody {
    /// Moved by forces and collisions.
    #[default]
    Dynamic,
    /// Moved by its velocity alone; pushes dynamic bodies and is never pushed. It turns about its centre of mass, as all bodies
    /// do: give a door that turns about a hinge the [`LinearVelocity`] that its centre has, or set its `Transform` in every step.
    Kinematic,
    /// Does not move by itself.
    Static,
}

/// Velocity of the centre of mass in metres per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref, DerefMut),
    reflect(Component, Default, Debug, PartialEq)
)]
pub struct LinearVelocity(pub Vec3);

/// Angular velocity about the centre of mass in radians per second, as axis times speed, in world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref, DerefMut),
    reflect(Component, Default, Debug, PartialEq)
)]
pub struct AngularVelocity(pub Vec3);

/// Where a body's centre of mass is, in the space of its mesh: unscaled, unrotated, not moved. A [`RigidBody`](super::RigidBody)
/// brings it; on a static collider without one, insert it yourself. The step writes it once the mesh is loaded.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// /// Pushes every body upward at its right edge.
/// fn lift(mut bodies: Query<(&Transform, &CenterOfMass, &mut ExternalForces)>) {
///     for (transform, center, mut forces) in &mut bodies {
///         let edge = transform.transform_point(Vec3::X);
///         forces.add_impulse_at(Vec3::Y, edge, center.in_world(transform));
///     }
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref),
    reflect(Component, Default, Debug, PartialEq)
)]
pub struct CenterOfMass(pub(crate) Vec3);

#[cfg(feature = "bevy")]
impl CenterOfMass {
    /// Where it is in the world, with the body there.
    pub fn in_world(&self, transform: &Transform) -> Vec3 {
        transform.transform_point(self.0)
    }
}

/// Whether a dynamic body is frozen because all it touches has been at rest for a while (see
/// [`SolverSettings::sleeping`](crate::types::solver_settings::SolverSettings)). Written by the step.
///
/// A body wakes, with all that lies on it or under it, when it is moved, given a velocity, a force or an impulse, or
/// touched; when what it touches moves or is gone; when its shape or [`Gravity`](crate::plugin::settings::Gravity) changes; and
/// when this is set to false. To set it to true has no effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref),
    reflect(Component, Default, Debug, PartialEq)
)]
pub struct Sleeping(pub bool);

/// What acts on a body from outside, beside gravity.
///
/// Forces hold until they are changed; impulses are used up by the next step, which sets them to zero. As a component:
/// add to it, or set it anew, in every step in which something else acts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq)
)]
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
    /// [`CenterOfMass::in_world`](crate::types::body::CenterOfMass::in_world).
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq)
)]
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

/// Which bodies may collide: `a` and `b` do if each is in a layer that the other's filter names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq)
)]
pub struct CollisionLayers {
    /// One bit for each layer the body is in.
    pub memberships: u32,
    /// One bit for each layer it collides with.
    pub filters: u32,
}

impl Default for CollisionLayers {
    fn default() -> Self {
        Self {
            memberships: 1,
            filters: u32::MAX,
        }
    }
}

impl CollisionLayers {
    /// Whether two bodies in these layers collide.
    pub fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}
