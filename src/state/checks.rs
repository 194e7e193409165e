//! What is wrong with a body or a collider.

use super::body::Body;
use super::fault::{BodyFault, MAX_GRAVITY_SCALE, MAX_SPEED, MIN_RADIUS};
use crate::asset::CollisionMesh;
use crate::types::body::{ExternalForces, RigidBody};
use glam::{BVec3, DMat3, DQuat, Mat3, Vec3};

/// Validates what does not depend on a mesh.
///
/// # Errors
/// The first fault that it finds.
pub(crate) fn check_body(body: &Body) -> Result<(), BodyFault> {
    check_collider(body)?;
    if body.mass == Some(f32::INFINITY) {
        return Err(BodyFault::Infinite("Mass"));
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
    if body.gravity_scale.abs() > MAX_GRAVITY_SCALE {
        return Err(BodyFault::GravityScale(body.gravity_scale));
    }
    let is_weightless = |mass: f32| mass == 0.0 || (1.0 / mass).is_infinite();
    let is_bad = |mass: &f32| *mass < 0.0 || body.kind == RigidBody::Dynamic && is_weightless(*mass);
    if let Some(mass) = body.mass.filter(is_bad) {
        return Err(BodyFault::Mass(mass));
    }
    if body.inertia.is_some_and(|inertia| !is_inertia(&inertia)) {
        return Err(BodyFault::Inertia);
    }
    Ok(())
}

/// Validates the pose and what belongs to a collider.
///
/// # Errors
/// The first fault that it finds.
pub(super) fn check_collider(body: &Body) -> Result<(), BodyFault> {
    let pose_finite = body.position.is_finite() && body.rotation.is_finite() && body.scale.is_finite();
    if !pose_finite {
        return Err(BodyFault::NonFinitePose);
    }
    check_rotation(body.rotation.as_dquat())?;
    if body.density == f32::INFINITY {
        return Err(BodyFault::Infinite("Density"));
    }
    let finite = [
        ("Density", body.density.is_finite()),
        ("Restitution", body.restitution.is_finite()),
        ("Friction", body.params.friction.coefficient.is_finite()),
    ];
    if let Some((name, _)) = finite.into_iter().find(|(_, finite)| !finite) {
        return Err(BodyFault::NonFinite(name));
    }
    // Bodies that nothing can push need no mass.
    let is_bad = body.density < 0.0 || body.density == 0.0 && body.kind == RigidBody::Dynamic;
    if body.mass.is_none() && is_bad {
        return Err(BodyFault::Mass(body.density));
    }
    Ok(())
}

/// Validates rotation and scale of a mesh. Returns the unit rotation, the scale and the scaled radius.
///
/// Along an axis on which all of the mesh is at 0 any scale gives the same shape, so a scale of 0 counts as the largest
/// of the others.
pub(crate) fn check_pose(mesh: &CollisionMesh, rotation: DQuat, scale: Vec3) -> Result<(DQuat, Vec3, f32), BodyFault> {
    check_rotation(rotation)?;
    let largest = scale.abs().max_element();
    let flat = if scale.cmpeq(Vec3::ZERO).any() {
        mesh.flat_axes()
    } else {
        BVec3::FALSE
    };
    let used = Vec3::select(flat & scale.cmpeq(Vec3::ZERO), Vec3::splat(largest), scale);
    let radius = mesh.radius * largest;
    let thinnest = mesh.radius * used.abs().min_element();
    if thinnest < MIN_RADIUS || radius > 1.0e6 * thinnest {
        return Err(BodyFault::ZeroScale(scale));
    }
    Ok((rotation.normalize(), used, radius))
}

fn check_rotation(rotation: DQuat) -> Result<(), BodyFault> {
    if rotation.length_squared() < 1.0e-12 {
        return Err(BodyFault::ZeroRotation);
    }
    Ok(())
}

/// Whether a tensor and its inverse are finite, and the tensor is symmetric and positive definite.
fn is_inertia(tensor: &Mat3) -> bool {
    // The determinants of tiny and of huge tensors are beyond single precision.
    let tensor = tensor.as_dmat3();
    let largest = tensor.x_axis.x.max(tensor.y_axis.y).max(tensor.z_axis.z);
    let symmetric = (tensor - tensor.transpose()).abs_diff_eq(DMat3::ZERO, 1.0e-4 * largest);
    // Sylvester's criterion.
    let minor = tensor.x_axis.x * tensor.y_axis.y - tensor.x_axis.y * tensor.y_axis.x;
    let definite = tensor.x_axis.x > 0.0 && minor > 0.0 && tensor.determinant() > 0.0;
    tensor.is_finite() && symmetric && definite && tensor.inverse().as_mat3().is_finite()
}

/// Name of the first component that holds NaN, or an infinity where that is not a valid limit.
fn not_finite(body: &Body) -> Option<&'static str> {
    let params = &body.params;
    let ExternalForces {
        force,
        torque,
        impulse,
        angular_impulse,
    } = params.forces;
    let finite = [
        ("LinearVelocity", body.linear_velocity.is_finite()),
        ("AngularVelocity", body.angular_velocity.is_finite()),
        ("Mass", body.mass.is_none_or(f32::is_finite)),
        ("GravityScale", body.gravity_scale.is_finite()),
        ("LinearDamping", params.linear_damping.is_finite()),
        ("AngularDamping", params.angular_damping.is_finite()),
        ("MaxLinearSpeed", !params.max_linear_speed.is_nan()),
        ("MaxAngularSpeed", !params.max_angular_speed.is_nan()),
        (
            "ExternalForces",
            [force, torque, impulse, angular_impulse].iter().all(|v| v.is_finite()),
        ),
    ];
    finite.into_iter().find_map(|(name, finite)| (!finite).then_some(name))
}
