//! Friction: tangential impulses within Coulomb's cone.

use super::contact::Point;
use super::solve::PairVelocities;

/// The friction impulse that stops the sliding at a point, clamped to the length `limit`.
///
/// If the point `keeps_place`, it is at rest in the mean of the substep: a body on a turntable moves straight on while
/// what is below it moves along an arc. Otherwise it would creep out by 1 mm/s at 1 rad/s and 1 m/s.
pub(super) fn friction_impulse(velocities: &PairVelocities, point: &Point, limit: f32, keeps_place: bool) -> [f32; 2] {
    let [_, k] = point.inverse_effective_mass;
    if k <= 0.0 {
        return point.friction_impulse;
    }
    let unclamped = [0, 1].map(|d| {
        let offset = if keeps_place { point.drift } else { point.surface_speed };
        let sliding = velocities.along(&point.rows[d + 1]) + offset[d];
        point.friction_impulse[d] - sliding / k
    });
    let square = unclamped[0] * unclamped[0] + unclamped[1] * unclamped[1];
    if square > limit * limit {
        unclamped.map(|impulse| impulse * (limit / square.sqrt()))
    } else {
        unclamped
    }
}
