//! Restitution: impulses after the last substep that reverse the impact velocity (Newton's law of restitution).

use super::constraints::{Impulse, Pair, Point};
use super::friction::friction_impulse;
use super::motion::BodyStates;
use super::solve::PairVelocities;

/// Gauss-Seidel sweeps over the points of a pair in one restitution pass. Restitution runs once per collision substep
/// and no later pass corrects it, so it needs more sweeps than a substep.
pub(super) const RESTITUTION_SWEEPS: u32 = 6;

/// Makes a pair active if some of its points met faster than `threshold`, m/s.
pub(super) fn begin_restitution(pair: &mut Pair, points: &mut [Point], threshold: f32) {
    pair.active = false;
    if pair.frozen || pair.depenetrating || pair.restitution <= 0.0 {
        return;
    }
    for point in points {
        point.active = point.valid && point.impact_velocity < -threshold && point.max_normal_impulse > 0.0;
        pair.active |= point.active;
    }
}

/// One restitution pass over a pair's active points, with the friction that follows from the additional normal impulse.
pub(super) fn apply_restitution(pair: &Pair, points: &mut [Point], states: &BodyStates) -> [Impulse; 2] {
    if !pair.active {
        return [Impulse::default(); 2];
    }
    let mut velocities = PairVelocities::new(pair, states);
    for _ in 0..RESTITUTION_SWEEPS {
        for point in points.iter_mut().filter(|p| p.active) {
            let Some([k_normal, k_tangent]) = velocities.inverse_effective_mass(point) else {
                continue;
            };
            let velocity_error = velocities.along(&point.rows[0]) + pair.restitution * point.impact_velocity;
            let impulse = (point.restitution_impulse - velocity_error / k_normal).max(0.0);
            velocities.apply(&point.rows[0], impulse - point.restitution_impulse);
            point.restitution_impulse = impulse;

            let friction = friction_impulse(
                &velocities,
                point,
                k_tangent,
                point.restitution_friction_impulse,
                1.0,
                pair.friction * impulse,
            );
            velocities.apply(&point.rows[1], friction[0] - point.restitution_friction_impulse[0]);
            velocities.apply(&point.rows[2], friction[1] - point.restitution_friction_impulse[1]);
            point.restitution_friction_impulse = friction;
        }
    }
    velocities.impulses()
}
