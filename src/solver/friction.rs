//! Friction: tangential impulses within Coulomb's cone.

use super::batch::PointLanes;
use super::velocities::PairVelocities;
use crate::simd::lanes::{Select, Simd, SimdBase, SimdFloat, bitmask, f32x8, load};

/// The friction impulses that stop the sliding at a point, clamped to the length `limit`.
///
/// In passes with bias velocity a point is at rest in the mean of the substep: its drift counts as sliding. A body on a
/// turntable moves straight on while what is below it moves along an arc. Otherwise it would creep out by 1 mm/s at 1
/// rad/s and 1 m/s.
#[inline(always)]
pub(super) fn friction_impulse<S: Simd>(
    simd: S,
    velocities: &PairVelocities<S>,
    point: &PointLanes,
    limit: f32x8<S>,
) -> [f32x8<S>; 2] {
    let response = load(simd, &point.aim.friction_response);
    let [along_t, along_u] = [velocities.along(&point.rows[1]), velocities.along(&point.rows[2])];
    let [t, u] = &point.friction_impulse;
    let [speed_t, speed_u] = &point.aim.surface_speed;
    let t = load(simd, t) - (along_t + load(simd, speed_t)) * response;
    let u = load(simd, u) - (along_u + load(simd, speed_u)) * response;
    let square = t * t + u * u;
    let slides = square.simd_gt(limit * limit);
    if bitmask(slides) == 0 {
        return [t, u];
    }
    let factor = limit / square.sqrt();
    [slides.select(t * factor, t), slides.select(u * factor, u)]
}
