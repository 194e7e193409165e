//! How a body answers contacts and forces. All of it takes effect with [`Response::Contacts`](crate::types::settings::Response).

pub use crate::types::body::{ExternalForces, LockedAxes};
pub use crate::types::material::CombineRule;

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

/// Factor on [`Gravity`](crate::plugin::settings::Gravity) for one body. Default 1.
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
///   ([`Collision::passing`](crate::plugin::collisions::Collision::passing)). On a sensor or a kinematic body it
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
