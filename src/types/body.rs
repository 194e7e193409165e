//! Components of a body: its kind, velocities, forces, locked axes and collision layers.

#[cfg(feature = "bevy")]
use bevy::ecs::VariantDefaults;
#[cfg(feature = "bevy")]
use bevy::prelude::*;
use glam::{Mat3, Vec3};
use serde::{Deserialize, Serialize};

/// How a body moves.
///
/// A body is an entity with a `RigidBody`. Its shape consists of the
/// [`MeshCollider`](crate::plugin::components::MeshCollider)s on it and on its descendants, down to the next
/// `RigidBody`. Mass, centre of mass and inertia add up, and colliders of one body never collide with each other. A
/// collider without a `RigidBody` on it or above it is static.
///
/// A body may be anywhere in the hierarchy. A dynamic body keeps its pose in the world when what is above it moves: the
/// step writes its `Transform` so that its `GlobalTransform` is right. A kinematic or static body follows what is above
/// it. Scale counts, also where it is unequal. Where an unequal scale above a turned collider shears its mesh, it gets
/// a copy of the mesh with the shear, baked in the background and shared by all colliders with the same shear.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// fn hammer(mut commands: Commands, assets: Res<AssetServer>) {
///     let cube: Handle<CollisionMesh> = assets.load("cube.bake.ron");
///     commands.spawn((
///         RigidBody::Dynamic,
///         Transform::from_xyz(0.0, 2.0, 0.0),
///         children![
///             (MeshCollider(cube.clone()), Transform::from_scale(Vec3::new(0.1, 1.0, 0.1)), Density(0.7)),
///             (
///                 MeshCollider(cube),
///                 Transform::from_xyz(0.0, 0.6, 0.0).with_scale(Vec3::new(0.5, 0.2, 0.2)),
///                 Density(7.8),
///             ),
///         ],
///     ));
/// }
/// ```
///
/// A pair of colliders is tested if at least one of the two is dynamic. A pair with a
/// [`Sensor`](crate::plugin::components::Sensor) is tested if at least one of the two is dynamic or kinematic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, VariantDefaults),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize),
    require(Transform, LinearVelocity, AngularVelocity, Sleeping, ComputedCenterOfMass)
)]
pub enum RigidBody {
    /// Moved by forces and collisions.
    #[default]
    Dynamic,
    /// Moved by the game. It pushes dynamic bodies and is never pushed. There are two ways:
    ///
    /// * **By its velocity**, while [`LinearVelocity`] or [`AngularVelocity`] is not zero. Like every body it rotates
    ///   about its centre of mass. A written `Transform` places it.
    /// * **By its `Transform`**, while no velocity is set: a lift, a door that turns about its hinge, an animated part
    ///   of a scene. In the next step it goes from its last pose to the new one, and with
    ///   [`Response::Contacts`](crate::types::settings::Response::Contacts) its contacts have the velocity of that
    ///   move. At the end of the step it is exactly where it was put. Write the `Transform`, or that of an entity above
    ///   it, in `FixedUpdate`: in `Update` a frame may have no step or several, and the velocity jerks. To place it
    ///   without a velocity insert [`Teleport`](crate::plugin::components::Teleport) too. Sensors are always placed.
    ///
    ///   After the step [`LinearVelocity`] and [`AngularVelocity`] hold the velocity of that move, and zero when it
    ///   stands still. They do not move it again: only another value sets a velocity. If it becomes dynamic, it goes on
    ///   with them. A scene that is saved while it moves has them as its velocity, unless a
    ///   [`Snapshot`](crate::plugin::snapshot::Snapshot) is restored too.
    Kinematic,
    /// Never moved by the step.
    Static,
}

/// Velocity of the centre of mass in metres per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref, DerefMut),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct LinearVelocity(pub Vec3);

/// Angular velocity about the centre of mass in radians per second, as axis times speed, in world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref, DerefMut),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct AngularVelocity(pub Vec3);

/// Overrides the centre of mass of a body, in the coordinates of its entity: before its `Transform` is applied. The
/// inertia is that of its colliders about this point. Without this component the centre of mass is that of the
/// colliders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref, DerefMut),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct CenterOfMass(pub Vec3);

/// The centre of mass of a body in the coordinates of its entity, before its `Transform` is applied. In metres.
///
/// The step writes it once the mesh is loaded. [`RigidBody`] requires it; insert it yourself on a static collider
/// without a `RigidBody`.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// /// Pushes every body upward at its right edge.
/// fn lift(mut bodies: Query<(&Transform, &ComputedCenterOfMass, &mut ExternalForces)>) {
///     for (transform, center, mut forces) in &mut bodies {
///         let edge = transform.transform_point(Vec3::X);
///         forces.add_impulse_at(Vec3::Y, edge, center.in_world(transform));
///     }
/// }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct ComputedCenterOfMass(pub(crate) Vec3);

#[cfg(feature = "bevy")]
impl ComputedCenterOfMass {
    /// The centre of mass in the world, for a body placed at `transform`: its `Transform` or, if it is a child, that of
    /// its `GlobalTransform`.
    pub fn in_world(&self, transform: &Transform) -> Vec3 {
        transform.transform_point(self.0)
    }
}

/// Whether a dynamic body sleeps. The step writes it.
///
/// An island of bodies in contact falls asleep when all of them have been at rest for a while; see
/// [`SolverSettings::sleeping`](crate::types::solver_settings::SolverSettings::sleeping). Bodies asleep are not
/// simulated.
///
/// A body wakes, together with its island, when
/// * it is moved, touched, or given a velocity, a force or an impulse,
/// * a body that it touches moves, changes its shape or is removed,
/// * its shape, its [`GravityScale`](crate::plugin::components::GravityScale), its [`LockedAxes`] or
///   [`Gravity`](crate::plugin::settings::Gravity) changes,
/// * this component is set to false. Setting it to true has no effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect, Deref),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
pub struct Sleeping(pub bool);

/// External forces and impulses on a body, in addition to gravity. Insert it beside the [`RigidBody`], which does not
/// require it.
///
/// Forces act until you change them. Impulses act once: the next step applies them and sets them to zero. However large
/// they are, a body becomes no faster than its [`MaxLinearSpeed`](crate::plugin::components::MaxLinearSpeed), and than
/// 1e9 m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct ExternalForces {
    /// Force at the centre of mass in newtons, in world axes.
    pub force: Vec3,
    /// Torque in newton metres, in world axes.
    pub torque: Vec3,
    /// Impulse at the centre of mass in newton seconds, in world axes.
    pub impulse: Vec3,
    /// Angular impulse in newton metre seconds, in world axes.
    pub angular_impulse: Vec3,
}

impl ExternalForces {
    /// Adds a force in newtons that acts at `point`. `center` is the body's centre of mass,
    /// [`ComputedCenterOfMass::in_world`]. Both are in world coordinates.
    pub fn add_force_at(&mut self, force: Vec3, point: Vec3, center: Vec3) {
        self.force += force;
        self.torque += (point - center).cross(force);
    }

    /// Adds an impulse in newton seconds that acts at `point`, like [`ExternalForces::add_force_at`].
    pub fn add_impulse_at(&mut self, impulse: Vec3, point: Vec3, center: Vec3) {
        self.impulse += impulse;
        self.angular_impulse += (point - center).cross(impulse);
    }

    /// The acceleration of the centre of mass by the force, m/s², and an upper bound of the angular acceleration by the
    /// torque, rad/s². The inverse inertia tensor may be in any axes.
    pub(crate) fn accelerations(&self, inverse_mass: f32, inverse_inertia: &Mat3) -> (Vec3, f32) {
        // The matrix lengthens no vector by more than its Frobenius norm.
        let Mat3 { x_axis, y_axis, z_axis } = inverse_inertia;
        let norm = Vec3::new(x_axis.length(), y_axis.length(), z_axis.length()).length();
        (self.force * inverse_mass, norm * self.torque.length())
    }

    /// Forces that change velocities within a second as much as the impulses do at once.
    #[cfg(feature = "gpu")]
    pub(crate) fn in_a_second(&self) -> Self {
        Self {
            force: self.impulse,
            torque: self.angular_impulse,
            ..Self::default()
        }
    }

    /// A copy that is weaker where a force would accelerate the body by more than `most` m/s² or rad/s², or an impulse
    /// change its velocities by more than `most`. No speed can be as large, and products of larger numbers overflow.
    pub(crate) fn bounded(&self, inverse_mass: f32, inverse_inertia: &Mat3, most: f32) -> Self {
        let Mat3 { x_axis, y_axis, z_axis } = inverse_inertia;
        let norm = Vec3::new(x_axis.length(), y_axis.length(), z_axis.length()).length();
        let weaker = |push: Vec3, response: f32| {
            let change = push.as_dvec3().length() * f64::from(response);
            if change > f64::from(most) {
                (push.as_dvec3() * (f64::from(most) / change)).as_vec3()
            } else {
                push
            }
        };
        Self {
            force: weaker(self.force, inverse_mass),
            torque: weaker(self.torque, norm),
            impulse: weaker(self.impulse, inverse_mass),
            angular_impulse: weaker(self.angular_impulse, norm),
        }
    }

    /// Whether all forces and impulses are zero.
    pub fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}

/// World axes along which a body does not translate, and about which it does not rotate.
///
/// Combine them with `|`: `LockedAxes::ROTATION | LockedAxes::TRANSLATION_Z`. For contacts and forces the body has
/// infinite mass along a locked axis, or infinite inertia about it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    // Opaque, so that no other bits are ever set.
    reflect(opaque, Component, Clone, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(from = "u8", into = "u8")]
pub struct LockedAxes(u8);

impl LockedAxes {
    /// No axis is locked.
    pub const NONE: Self = Self(0);
    /// No translation along x.
    pub const TRANSLATION_X: Self = Self(1);
    /// No translation along y.
    pub const TRANSLATION_Y: Self = Self(2);
    /// No translation along z.
    pub const TRANSLATION_Z: Self = Self(4);
    /// No rotation about x.
    pub const ROTATION_X: Self = Self(8);
    /// No rotation about y.
    pub const ROTATION_Y: Self = Self(16);
    /// No rotation about z.
    pub const ROTATION_Z: Self = Self(32);
    /// No translation.
    pub const TRANSLATION: Self = Self(7);
    /// No rotation.
    pub const ROTATION: Self = Self(56);

    /// Locks from bits 0 to 5: translation along x, y, z, then rotation about x, y, z. Other bits are ignored.
    pub fn from_bits(bits: u8) -> Self {
        Self(bits & 63)
    }

    /// The bits that [`LockedAxes::from_bits`] takes.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// 1 for each axis along which the body may translate, else 0.
    pub fn free_translation(self) -> Vec3 {
        self.free(0)
    }

    /// 1 for each axis about which the body may rotate, else 0.
    pub fn free_rotation(self) -> Vec3 {
        self.free(3)
    }

    fn free(self, shift: u8) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| f32::from(!self.0 >> (shift + axis) & 1)))
    }
}

impl From<u8> for LockedAxes {
    /// [`LockedAxes::from_bits`].
    fn from(bits: u8) -> Self {
        Self::from_bits(bits)
    }
}

impl From<LockedAxes> for u8 {
    /// [`LockedAxes::bits`].
    fn from(axes: LockedAxes) -> Self {
        axes.bits()
    }
}

impl std::ops::BitOr for LockedAxes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Which colliders may collide. Two collide if each is in a layer that the other one's filter contains.
///
/// A collider without this component has that of its body. By default a collider is in layer 0 and collides with all
/// layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)
)]
#[serde(default, deny_unknown_fields)]
pub struct CollisionLayers {
    /// One bit for each layer that contains the collider. Default 1.
    pub memberships: u32,
    /// One bit for each layer that the collider collides with. Default all.
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
    /// Whether a body with these layers may collide with one with the `other` layers.
    pub fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}
