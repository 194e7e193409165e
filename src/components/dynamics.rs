//! How a body answers contacts and forces. All of it takes effect with [`Response::Contacts`](crate::settings::Response).

pub use crate::stages::solver::{CombineRule, ExternalForces, LockedAxes};

use bevy::prelude::*;

/// Mass in kilograms; overrules [`Density`]. Inertia follows from the shape, filled evenly.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, PartialEq)]
pub struct Mass(pub f32);

/// Kilograms per cubic metre of a body without [`Mass`]. Default 1.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct Density(pub f32);

impl Default for Density {
    fn default() -> Self {
        Self(1.0)
    }
}

/// The inertia tensor about the centre of mass, in the body's own axes, kg m^2; instead of that which follows from the
/// shape. Symmetric and positive definite; [`AngularInertia::principal`] makes one of principal moments.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, PartialEq)]
pub struct AngularInertia(pub Mat3);

impl AngularInertia {
    /// With these moments about the body's own axes, kg m^2.
    pub fn principal(moments: Vec3) -> Self {
        Self(Mat3::from_diagonal(moments))
    }
}

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
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct CenterOfMass(pub(crate) Vec3);

impl CenterOfMass {
    /// Where it is in the world, with the body there.
    pub fn in_world(&self, transform: &Transform) -> Vec3 {
        transform.transform_point(self.0)
    }
}

/// Bounciness: 0 does not bounce, 1 keeps all speed. Default 0. Bodies that meet slower than
/// [`SolverSettings::restitution_threshold`](crate::settings::SolverSettings) do not bounce.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct Restitution {
    /// Outgoing speed over incoming speed, 0 to 1; what is beyond counts as the nearest of the two.
    pub coefficient: f32,
    /// How that of a pair follows from both bodies'. With [`Response::Impulse`](crate::settings::Response) always their
    /// mean.
    pub combine: CombineRule,
}

impl Restitution {
    /// A restitution of `coefficient`, 0 to 1, of which two bodies take the mean.
    pub fn new(coefficient: f32) -> Self {
        Self {
            coefficient,
            combine: CombineRule::Average,
        }
    }

    /// The same with another rule.
    pub fn with_combine(self, combine: CombineRule) -> Self {
        Self { combine, ..self }
    }
}

/// Coulomb friction, the same for sticking and sliding. Default 0.5, of which two bodies take the mean.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct Friction {
    /// Largest friction over normal force: the tangent of the slope on which a body just holds. A negative one counts as 0.
    pub coefficient: f32,
    /// How that of a pair follows from both bodies'.
    pub combine: CombineRule,
}

impl Default for Friction {
    fn default() -> Self {
        Self::new(0.5)
    }
}

impl Friction {
    /// A friction of `coefficient`, 0 or more, of which two bodies take the mean.
    pub fn new(coefficient: f32) -> Self {
        Self {
            coefficient,
            combine: CombineRule::Average,
        }
    }

    /// The same with another rule.
    pub fn with_combine(self, combine: CombineRule) -> Self {
        Self { combine, ..self }
    }
}

/// Factor on [`Gravity`](crate::settings::Gravity) for one body. Default 1.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct GravityScale(pub f32);

impl Default for GravityScale {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Rate at which linear velocity decays, 1/s: without anything else a body keeps `exp(-rate)` of it each second. Default 0; a
/// negative one counts as 0.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct LinearDamping(pub f32);

/// Rate at which angular velocity decays, 1/s. Default 0; a negative one counts as 0.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct AngularDamping(pub f32);

/// Largest speed of a body's centre of mass, m/s. Without it, or if it is negative, there is no limit.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, PartialEq)]
pub struct MaxLinearSpeed(pub f32);

/// Largest angular speed of a body, rad/s. Without it, or if it is negative, there is no limit.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, PartialEq)]
pub struct MaxAngularSpeed(pub f32);

/// Whether a dynamic body is frozen because all it touches has been at rest for a while (see
/// [`SolverSettings::sleeping`](crate::settings::SolverSettings)). Written by the step.
///
/// A body wakes, with all that lies on it or under it, when it is moved, given a velocity, a force or an impulse, or
/// touched; when what it touches moves or is gone; when its shape or [`Gravity`](crate::settings::Gravity) changes; and
/// when this is set to false. To set it to true has no effect.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deref)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct Sleeping(pub bool);

/// Lets a dynamic body that is faster than its size per step not pass what is thin (continuous collision detection).
///
/// Where it first comes nearer to another solid body than bodies at rest lie, within a step or detection interval, it loses its
/// motion relative to that one: for the rest of the interval it is carried by it, by a closing door for example. Two with this go
/// on with their common velocity. It keeps its own velocity, and meets the other one as usual in the next interval. Bodies
/// with this make a step be cut into more detection intervals only after they met something.
///
/// * It costs a search per body within reach of such a body's way: some microseconds where it flies past, tens to
///   hundreds where it comes near many triangles, and another one for each neighbour of those that met. A heap of 100
///   balls that all have it costs some ten times as much as one without.
/// * Flag what is fast, not what is in its way. Doors and crates need it only if they are fast themselves.
/// * A body squeezed between two others may overlap one of them: the dynamic one before the kinematic one, that before the
///   static one.
/// * A body that overlaps another is pushed out of it by contacts alone.
/// * It is not stopped by sensors, but these notice it on its way, from the first touch
///   ([`Collision::passing`](crate::collisions::Collision::passing)). On a sensor or a kinematic body it
///   only lets sensors be noticed.
/// * Planes need none of it: nothing passes them.
/// * A GPU does not do it: while there is such a body in the world, steps run on the CPU.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct ContinuousCollision;

/// Keeps a body awake, and all that it touches.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, PartialEq)]
pub struct SleepingDisabled;
