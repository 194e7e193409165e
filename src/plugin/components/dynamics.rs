//! Dynamics of a body: mass, inertia, gravity, damping, speed limits, continuous collision detection and sleep.
//!
//! [`GravityScale`] takes effect with every [`Response`](crate::types::settings::Response). [`Mass`], [`Density`] and
//! [`AngularInertia`] take effect with [`Response::Contacts`](crate::types::settings::Response::Contacts) and
//! [`Response::Impulse`](crate::types::settings::Response::Impulse), and the others with `Response::Contacts` only.

pub use crate::types::body::{ExternalForces, LockedAxes};
pub use crate::types::material::CombineRule;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Mass of a body in kilograms. Overrides [`Density`]. The inertia is scaled with it. Default 1.
///
/// Without it the mass is density times volume. The volume of a mesh before scaling is
/// [`CollisionMesh::mass`](crate::asset::BakedMesh::mass)`.volume`.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mass(pub f32);

impl Default for Mass {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Density in kilograms per cubic metre: of a collider, or on a body, of its colliders without a density. Default 1. In
/// a body with [`Mass`] it only distributes that mass.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct Density(pub f32);

impl Default for Density {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Inertia tensor about the centre of mass in the body's own axes, in kg m^2. Overrides the inertia of the shape.
///
/// It must be symmetric and positive definite. [`AngularInertia::principal`] makes one from principal moments. Default
/// 1 about every axis.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct AngularInertia(pub Mat3);

impl AngularInertia {
    /// The tensor with these principal moments about the body's own axes, in kg m^2.
    pub fn principal(moments: Vec3) -> Self {
        Self(Mat3::from_diagonal(moments))
    }
}

/// Factor on [`Gravity`](crate::plugin::settings::Gravity) for one body. Default 1.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct GravityScale(pub f32);

impl Default for GravityScale {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Rate at which the linear velocity decays, in 1/s: a free body keeps the fraction `exp(-rate)` of it per second.
/// Default 0. Negative rates count as 0.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearDamping(pub f32);

/// Rate at which the angular velocity decays, in 1/s, like [`LinearDamping`]. Default 0. Negative rates count as 0.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct AngularDamping(pub f32);

/// Largest speed of a body's centre of mass, in m/s. Without this component, or if it is negative, there is no limit.
/// Default infinite.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaxLinearSpeed(pub f32);

impl Default for MaxLinearSpeed {
    fn default() -> Self {
        Self(f32::INFINITY)
    }
}

/// Largest angular speed of a body, in rad/s. Without this component, or if it is negative, there is no limit. Default
/// infinite.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaxAngularSpeed(pub f32);

impl Default for MaxAngularSpeed {
    fn default() -> Self {
        Self(f32::INFINITY)
    }
}

/// Continuous collision detection (CCD): a dynamic body with this component does not pass through thin bodies, however
/// fast it is.
///
/// At the time of impact, when the body first comes nearer to another solid body than the gap between bodies at rest,
/// it loses its motion relative to that body. For the rest of the collision substep it moves with the other body, for
/// example with a closing door. Two bodies with this component continue with their common velocity. The body keeps its
/// own velocity, and the contact solver handles the contact in the next collision substep. Bodies with this component
/// cause more collision substeps only after they met something.
///
/// * It costs a search for each body near the path. A search takes some microseconds if the two stay apart, and tens to
///   hundreds of microseconds near many triangles. When bodies have met, each of their neighbours costs another search.
///   A pile of 100 balls costs about ten times as much if all have this component.
/// * Add it to fast bodies, not to the bodies that they may hit. Doors and crates need it only if they are fast
///   themselves.
/// * A body squeezed between two others may overlap one of them: a dynamic body rather than a kinematic one, and a
///   kinematic body rather than a static one.
/// * A body that already overlaps another one is pushed out by its contacts only.
/// * Sensors do not stop the body, but they detect it along its path, from the first touch
///   ([`Collision::passing`](crate::plugin::collisions::Collision::passing)). On a sensor or a kinematic body the
///   component has only this effect.
/// * Planes do not need it: no body passes through them.
/// * Steps with such bodies stay on the GPU, with the same guarantees. The CPU stops these bodies during the step. For
///   that it waits for the GPU once in each collision substep, or up to three times if something is near a path, and
///   once more at the end of the step. It also does so with
///   [`Readback::Latent`](crate::plugin::settings::Readback::Latent) and
///   [`Readback::Resident`](crate::plugin::settings::Readback::Resident), whose results come as late as in other steps.
///   [`StepReport::waits`](crate::plugin::collisions::StepReport::waits) counts how often it waits.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContinuousCollision;

/// Keeps a body awake, and with it all bodies that it touches.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[reflect(Component, Default, Debug, PartialEq, Serialize, Deserialize)]
pub struct SleepingDisabled;
