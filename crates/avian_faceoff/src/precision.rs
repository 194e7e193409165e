//! Numbers of Avian in double precision. The other ways are Avian's own: `adjust_precision`, `f32`.

#![allow(
    clippy::useless_conversion,
    clippy::unnecessary_cast,
    reason = "they depend on the feature `f64`"
)]

use avian3d::math::{Quaternion, Scalar, Vector};
use bevy::math::{DQuat, DVec3};

pub(crate) fn double(v: Vector) -> DVec3 {
    DVec3::from_array(v.to_array().map(f64::from))
}

pub(crate) fn double_rotation(q: Quaternion) -> DQuat {
    DQuat::from_array(q.to_array().map(f64::from))
}

pub(crate) fn single(x: Scalar) -> f32 {
    x as f32
}
