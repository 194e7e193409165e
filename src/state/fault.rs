//! Validation errors of bodies and planes, and how to fix them.

use crate::geometry::mesh::MAX_COORDINATE;
use glam::Vec3;
#[cfg(feature = "bevy")]
use std::mem::discriminant;
use thiserror::Error;

/// The smallest bounding radius of a body in the world, metres. Products of three lengths then stay normal `f32`s.
pub const MIN_RADIUS: f32 = 1.0e-9;

/// The largest component of a velocity, m/s or rad/s. Its square then stays far from overflow.
pub const MAX_SPEED: f32 = 1.0e9;

/// The largest gravity scale. A body that falls with it for a second stays far from overflow.
pub const MAX_GRAVITY_SCALE: f32 = 1.0e6;

/// Why a body cannot take part in a step.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect), reflect(Debug, PartialEq))]
pub enum BodyFault {
    /// A number of the pose is NaN or infinite.
    #[error("its position, rotation or scale is not finite: set it to finite numbers")]
    NonFinitePose,
    /// A number of the named component is NaN or infinite.
    #[error("its {0} is not finite: set it to finite numbers")]
    NonFinite(&'static str),
    /// The [`Mass`](crate::plugin::components::Mass) or [`Density`](crate::plugin::components::Density) is infinite.
    #[error(
        "its {0} is infinite: a body that nothing can push is RigidBody::Static, or RigidBody::Kinematic if it moves by itself"
    )]
    Infinite(&'static str),
    /// The rotation is the zero quaternion.
    #[error("its rotation is the zero quaternion: use Quat::IDENTITY")]
    ZeroRotation,
    /// The scale makes the body flat or smaller than [`MIN_RADIUS`]. A zero along an axis on which all of the mesh is
    /// at 0 is no fault.
    #[error("its scale {0} makes it flat or vanishingly small: no component may be (nearly) zero")]
    ZeroScale(Vec3),
    /// The body is larger, or farther from the origin, than [`MAX_COORDINATE`].
    #[error("it reaches beyond {MAX_COORDINATE:e} m from the origin: move it closer or scale it down")]
    TooFar,
    /// The mass or density is negative; or the body is dynamic, and its mass is zero or so small that its inverse is
    /// not finite.
    #[error("its mass {0} is not positive or vanishingly small: set a mass of at least 1e-38, or a positive density")]
    Mass(f32),
    /// The inertia is not finite, not symmetric or not positive definite.
    #[error("its AngularInertia is not symmetric and positive definite: use AngularInertia::principal")]
    Inertia,
    /// The body is faster than [`MAX_SPEED`].
    #[error("its velocity has a component of {0:e}, beyond {MAX_SPEED:e}: slow it down")]
    TooFast(f32),
    /// The [`GravityScale`](crate::plugin::components::GravityScale) is larger than [`MAX_GRAVITY_SCALE`].
    #[error("its GravityScale is {0:e}, beyond {MAX_GRAVITY_SCALE:e}: choose a smaller one")]
    GravityScale(f32),
    /// The normal of a plane is zero or not finite.
    #[error("the normal {0} of its PlaneCollider has no direction: set a vector of non-zero, finite length")]
    PlaneNormal(Vec3),
    /// The unequal scale of an entity above it shears its mesh, and there is no such mesh: it is flat or too large.
    #[error(
        "the unequal scale of an entity above it, about other axes than its own, shears its mesh, and the sheared mesh \
         cannot be baked: scale it alone, or all axes equally, or turn it by quarter turns only"
    )]
    Sheared,
    /// The mesh does not exist and is not being loaded.
    #[error("its CollisionMesh is not in Assets<CollisionMesh>: insert it, or change its MeshCollider")]
    MeshMissing,
    /// The entity is both a body and a plane. The body takes part; the plane is ignored.
    #[error("it has both a MeshCollider and a PlaneCollider: put the plane on an entity of its own")]
    PlaneOnBody,
    /// The distance of a plane is NaN or infinite, or beyond 1e9 m in a [`Scene`](crate::queries::Scene).
    #[error("the distance {0} of its PlaneCollider is not a number from -1e9 to 1e9: set it to one")]
    PlaneDistance(f32),
    /// The mesh could not be loaded.
    #[error(
        "its CollisionMesh failed to load: see the asset server's error, and despawn it or change its MeshCollider"
    )]
    MeshFailed,
}

impl BodyFault {
    #[cfg(feature = "bevy")]
    /// Whether both are the same kind of fault, whatever the numbers. A fault of the same kind is reported once.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::NonFinite(this), Self::NonFinite(that)) | (Self::Infinite(this), Self::Infinite(that)) => {
                this == that
            }
            _ => discriminant(self) == discriminant(other),
        }
    }
}
