//! Friction: tangential impulses within Coulomb's cone.

use super::constraints::Point;
use super::solve::PairVelocities;

/// The friction impulse that stops the sliding at a point, clamped to the length `limit`.
///
/// `friction_impulse` is the impulse so far, and `relaxation` the fraction of the correction that is applied.
pub(super) fn friction_impulse(
    velocities: &PairVelocities,
    point: &Point,
    inverse_effective_mass: f32,
    friction_impulse: [f32; 2],
    relaxation: f32,
    limit: f32,
) -> [f32; 2] {
    if inverse_effective_mass <= 0.0 {
        return friction_impulse;
    }
    let unclamped = [0, 1].map(|d| {
        let sliding = velocities.along(&point.rows[d + 1]);
        friction_impulse[d] - relaxation * sliding / inverse_effective_mass
    });
    let square = unclamped[0] * unclamped[0] + unclamped[1] * unclamped[1];
    if square > limit * limit {
        unclamped.map(|impulse| impulse * (limit / square.sqrt()))
    } else {
        unclamped
    }
}
