//! Vectors and poses of parry, whose glam may be another version than ours.

use crate::parry::math::{Pose, Vector};
use glam::{DQuat, DVec3, Vec3};

pub fn to_parry(v: Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

/// Rounded to single precision.
pub fn narrow(v: DVec3) -> Vector {
    to_parry(v.as_vec3())
}

pub fn from_parry(v: Vector) -> Vec3 {
    Vec3::from_array(v.to_array())
}

pub fn translation(pose: &Pose) -> DVec3 {
    from_parry(pose.translation).as_dvec3()
}

pub fn rotation(pose: &Pose) -> DQuat {
    DQuat::from_array(pose.rotation.to_array().map(f64::from))
}
