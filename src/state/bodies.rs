//! How bodies enter a step: what is checked, and what is derived from pose and mesh.

use super::mesh_arena::MeshArena;
use super::{Bodies, Body, Frame, Motion};
use crate::geometry::mesh::MAX_COORDINATE;
use crate::types::body::{ExternalForces, RigidBody};
use glam::{DMat3, DQuat, DVec3, Mat3, Quat, Vec3};
#[cfg(feature = "bevy")]
use std::mem::discriminant;
use thiserror::Error;

/// The smallest bounding radius a body may have in the world, in metres: products of three lengths stay normal `f32`s.
pub const MIN_RADIUS: f32 = 1.0e-9;

/// The largest component a velocity may have, in m/s or rad/s: its square stays far from overflow.
pub const MAX_SPEED: f32 = 1.0e9;

/// Why a body cannot take part in a step.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum BodyFault {
    /// Some number of its pose is NaN or infinite.
    #[error("its Transform is not finite: set it to finite numbers")]
    NonFinitePose,
    /// Some number of the component of this name is NaN or infinite.
    #[error("its {0} is not finite: set it to finite numbers")]
    NonFinite(&'static str),
    /// Its [`Mass`](crate::plugin::components::Mass) or [`Density`](crate::plugin::components::Density) is infinite.
    #[error(
        "its {0} is infinite: for what nothing can push use RigidBody::Static, or RigidBody::Kinematic if it moves by itself"
    )]
    Infinite(&'static str),
    /// Its rotation is the zero quaternion.
    #[error("its rotation is the zero quaternion: use Quat::IDENTITY")]
    ZeroRotation,
    /// Its scale makes it flat or smaller than [`MIN_RADIUS`].
    #[error("its scale {0} makes it flat or vanishingly small: no component may be (nearly) zero")]
    ZeroScale(Vec3),
    /// It is larger, or farther from the origin, than [`MAX_COORDINATE`].
    #[error("it reaches beyond {MAX_COORDINATE:e} m from the origin: move it closer or scale it down")]
    TooFar,
    /// Its mass is not positive, or so small that its inverse is not finite.
    #[error("its mass {0} is not positive or vanishingly small: set a mass of at least 1e-38, or a positive density")]
    Mass(f32),
    /// Its inertia is not finite, not symmetric or not positive definite.
    #[error("its AngularInertia is not symmetric and positive definite: use AngularInertia::principal")]
    Inertia,
    /// It is faster than [`MAX_SPEED`].
    #[error("its velocity has a component of {0:e}, beyond {MAX_SPEED:e}: slow it down")]
    TooFast(f32),
    /// The normal of a plane has no length.
    #[error("the normal {0} of its PlaneCollider has no direction: set a vector of non-zero, finite length")]
    PlaneNormal(Vec3),
    /// It is a child of another entity.
    #[error(
        "it is a child of another entity, so that its Transform is no pose in the world: remove its ChildOf. Parts that stay \
         together are one body: put them into one mesh; what follows another body is a RigidBody::Kinematic of its own, whose \
         pose a system writes. What is only drawn may be a child"
    )]
    Child,
    /// Its mesh is nowhere, and is not on its way either.
    #[error("its CollisionMesh is not in Assets<CollisionMesh>: insert it, or change its MeshCollider")]
    MeshMissing,
    /// It is a body and a plane at once. The body goes on; the plane is left out.
    #[error("it has both a MeshCollider and a PlaneCollider: put the plane on an entity of its own")]
    PlaneOnBody,
    /// The distance of a plane is NaN or infinite.
    #[error("the distance {0} of its PlaneCollider is not finite: set it to a finite number")]
    PlaneDistance(f32),
    /// Its mesh could not be loaded.
    #[error(
        "its CollisionMesh failed to load: see the asset server's error, and despawn it or change its MeshCollider"
    )]
    MeshFailed,
}

impl Bodies {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.mesh.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.mesh.is_empty()
    }

    /// Removes all, keeping the memory.
    pub fn clear(&mut self) {
        // Every array by name, so that a new one cannot be forgotten.
        let Self {
            mesh,
            kind,
            position,
            rotation,
            scale,
            linear_velocity,
            angular_velocity,
            frame,
            center,
            radius,
            own_radius,
            thickness,
            reach,
            inverse_mass,
            own_inverse_inertia,
            inverse_inertia,
            restitution,
            gravity_scale,
            layers,
            sensor,
            culling,
            handling,
        } = self;
        mesh.clear();
        kind.clear();
        position.clear();
        rotation.clear();
        scale.clear();
        linear_velocity.clear();
        angular_velocity.clear();
        frame.clear();
        center.clear();
        radius.clear();
        own_radius.clear();
        thickness.clear();
        reach.clear();
        inverse_mass.clear();
        own_inverse_inertia.clear();
        inverse_inertia.clear();
        restitution.clear();
        gravity_scale.clear();
        layers.clear();
        sensor.clear();
        culling.clear();
        handling.clear();
    }

    /// Where body `i` is after a step and how it moves. What follows from the pose is that of before.
    pub fn motion(&self, i: usize) -> Motion {
        Motion {
            position: self.position[i],
            rotation: self.rotation[i],
            linear_velocity: self.linear_velocity[i],
            angular_velocity: self.angular_velocity[i],
        }
    }

    /// Moves body `i`, without what follows from its pose.
    pub fn set_motion(&mut self, i: usize, motion: &Motion) {
        self.position[i] = motion.position;
        self.rotation[i] = motion.rotation;
        self.linear_velocity[i] = motion.linear_velocity;
        self.angular_velocity[i] = motion.angular_velocity;
    }

    /// Checks `body` and adds it, with all that follows from its pose and mesh.
    pub fn push(&mut self, body: &Body, meshes: &MeshArena) -> Result<(), BodyFault> {
        let pose_finite = body.position.is_finite() && body.rotation.is_finite() && body.scale.is_finite();
        if !pose_finite {
            return Err(BodyFault::NonFinitePose);
        }
        let weights = [("Mass", body.mass), ("Density", Some(body.density))];
        if let Some((name, _)) = weights.into_iter().find(|&(_, weight)| weight == Some(f32::INFINITY)) {
            return Err(BodyFault::Infinite(name));
        }
        if let Some(name) = not_finite(body) {
            return Err(BodyFault::NonFinite(name));
        }
        let speed = body
            .linear_velocity
            .abs()
            .max(body.angular_velocity.abs())
            .max_element();
        if speed > MAX_SPEED {
            return Err(BodyFault::TooFast(speed));
        }
        let slot = &meshes[body.mesh];
        let (rotation, own_radius) = check_pose(slot.mesh.radius, body.rotation.as_dquat(), body.scale)?;
        if let Some(mass) = body.mass.or(Some(body.density)).filter(|&m| m <= 0.0) {
            return Err(BodyFault::Mass(mass));
        }
        if body.inertia.is_some_and(|inertia| !is_inertia(&inertia)) {
            return Err(BodyFault::Inertia);
        }

        let frame = Frame::new(
            body.position.as_dvec3(),
            rotation,
            body.scale.as_dvec3(),
            slot.mesh.mass.center,
        );
        let center = frame.center.as_vec3();
        let reach = center.abs().max(body.position.abs()).max_element() + own_radius;
        if reach.is_nan() || reach > MAX_COORDINATE {
            return Err(BodyFault::TooFar);
        }
        let radius = bounding_radius(own_radius, center);
        let (inverse_mass, own_inertia) = inverse_mass(body, &frame, &slot.mesh.mass);
        let inverse_inertia = frame.rotation * own_inertia * frame.rotation.transpose();
        if !inverse_mass.is_finite() {
            return Err(BodyFault::Mass(body.mass.unwrap_or(0.0)));
        }

        self.mesh.push(body.mesh);
        self.kind.push(body.kind);
        self.position.push(body.position);
        self.rotation.push(unit(body.rotation));
        self.scale.push(body.scale);
        self.linear_velocity.push(body.linear_velocity);
        self.angular_velocity.push(body.angular_velocity);
        self.frame.push(frame);
        self.center.push(center);
        self.radius.push(radius);
        self.own_radius.push(own_radius);
        let thickness = slot.mesh.mass.thickness * body.scale.abs().min_element();
        self.thickness.push(thickness);
        self.reach.push(radius);
        self.inverse_mass.push(inverse_mass);
        self.own_inverse_inertia.push(own_inertia.as_mat3());
        self.inverse_inertia.push(inverse_inertia.as_mat3());
        self.restitution.push(body.restitution.clamp(0.0, 1.0));
        self.gravity_scale.push(body.gravity_scale);
        self.layers.push(body.layers);
        self.sensor.push(body.sensor);
        self.culling.push(body.culling);
        self.handling.push(body.handling);
        Ok(())
    }
}

/// The unit quaternion along this one. What has unit length but for rounding stays as it is: a rotation
/// that a step wrote comes back unchanged.
fn unit(rotation: Quat) -> Quat {
    if (rotation.as_dquat().length_squared() - 1.0).abs() < 1.0e-6 {
        rotation
    } else {
        rotation.normalize()
    }
}

/// The unit rotation of a mesh of this radius, and its radius at this scale, if a body can have them.
pub(crate) fn check_pose(mesh_radius: f32, rotation: DQuat, scale: Vec3) -> Result<(DQuat, f32), BodyFault> {
    if rotation.length_squared() < 1.0e-12 {
        return Err(BodyFault::ZeroRotation);
    }
    let radius = mesh_radius * scale.abs().max_element();
    let thinnest = mesh_radius * scale.abs().min_element();
    if thinnest < MIN_RADIUS || radius > 1.0e6 * thinnest {
        return Err(BodyFault::ZeroScale(scale));
    }
    Ok((rotation.normalize(), radius))
}

/// The radius of a body's bounding sphere. Scaling and rotating its centre rounds it; the sphere grows by what that can cost.
pub(crate) fn bounding_radius(own_radius: f32, center: Vec3) -> f32 {
    own_radius * (1.0 + 1.0e-6) + 4.0 * f32::EPSILON * center.abs().max_element()
}

impl Frame {
    /// `rotation` has unit length; `mesh_center` is the centre of mass in the mesh.
    pub(crate) fn new(position: DVec3, rotation: DQuat, scale: DVec3, mesh_center: Vec3) -> Self {
        let rotation = DMat3::from_quat(rotation);
        Self {
            position,
            rotation,
            scale,
            center: position + rotation * (scale * mesh_center.as_dvec3()),
        }
    }
}

/// Whether a tensor is finite, symmetric and positive definite, its inverse too.
fn is_inertia(tensor: &Mat3) -> bool {
    let symmetric = (*tensor - tensor.transpose()).abs_diff_eq(Mat3::ZERO, 1.0e-4 * tensor.x_axis.x.abs());
    // Sylvester's criterion.
    let minor = tensor.x_axis.x * tensor.y_axis.y - tensor.x_axis.y * tensor.y_axis.x;
    let definite = tensor.x_axis.x > 0.0 && minor > 0.0 && tensor.determinant() > 0.0;
    tensor.is_finite() && symmetric && definite && tensor.inverse().is_finite()
}

/// The component in which a number is NaN, or infinite though it is no limit.
fn not_finite(body: &Body) -> Option<&'static str> {
    let handling = &body.handling;
    let ExternalForces {
        force,
        torque,
        impulse,
        angular_impulse,
    } = handling.forces;
    let finite = [
        ("LinearVelocity", body.linear_velocity.is_finite()),
        ("AngularVelocity", body.angular_velocity.is_finite()),
        ("Mass", body.mass.is_none_or(f32::is_finite)),
        ("Density", body.density.is_finite()),
        ("Restitution", body.restitution.is_finite()),
        ("Friction", handling.friction.coefficient.is_finite()),
        ("GravityScale", body.gravity_scale.is_finite()),
        ("LinearDamping", handling.linear_damping.is_finite()),
        ("AngularDamping", handling.angular_damping.is_finite()),
        ("MaxLinearSpeed", !handling.max_linear_speed.is_nan()),
        ("MaxAngularSpeed", !handling.max_angular_speed.is_nan()),
        (
            "ExternalForces",
            [force, torque, impulse, angular_impulse].iter().all(|v| v.is_finite()),
        ),
    ];
    finite.into_iter().find_map(|(name, finite)| (!finite).then_some(name))
}

impl BodyFault {
    #[cfg(feature = "bevy")]
    /// Whether it is the same fault, whatever its numbers: told before, it is not news.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::NonFinite(this), Self::NonFinite(that)) | (Self::Infinite(this), Self::Infinite(that)) => {
                this == that
            }
            _ => discriminant(self) == discriminant(other),
        }
    }
}

/// Inverse mass and inverse inertia in the body's own axes.
fn inverse_mass(body: &Body, frame: &Frame, mesh: &crate::geometry::MassProperties) -> (f32, DMat3) {
    if body.kind != RigidBody::Dynamic {
        return (0.0, DMat3::ZERO);
    }
    let volume = mesh.volume as f64 * frame.scale.element_product().abs();
    let mass = body.mass.map_or(f64::from(body.density) * volume, f64::from);
    if let Some(inertia) = body.inertia {
        return ((1.0 / mass) as f32, inertia.as_dmat3().inverse());
    }
    let inertia = mesh.inertia(frame.scale, mass);
    let inverse = inertia.inverse();
    let finite = if inverse.as_mat3().is_finite() {
        inverse
    } else {
        DMat3::ZERO
    };
    ((1.0 / mass) as f32, finite)
}
