//! Restitution: impacts reverse the normal velocity (Newton's law of restitution).
//!
//! Impacts are resolved in the substep in which they occur, with all contacts of the island at once: no point's total
//! impulse is negative, and its velocity is at least the reversed one. Such a solution keeps the energy of elastic
//! bodies, however many points meet at once.

use super::contact::{Pair, Point};
use super::motion::StatesMut;
use super::solve::PairVelocities;

/// Passes end when no normal velocity changes by more than this fraction of the speed of the fastest impact.
pub(super) const TOLERANCE: f32 = 1.0e-5;

/// Marks the points of a pair that have an impact faster than `threshold`, m/s, in this substep, and returns the speed
/// of the fastest one that needs restitution; 0 if there is none.
pub(super) fn find_impacts(pair: &Pair, points: &mut [Point], states: &StatesMut, threshold: f32) -> f32 {
    if !pair.active || pair.depenetrating || pair.restitution <= 0.0 {
        return 0.0;
    }
    let velocities = PairVelocities::before(pair, states);
    let mut fastest = 0.0f32;
    for point in points.iter_mut().filter(|point| point.active) {
        point.impact_velocity = velocities.along(&point.rows[0]);
        point.has_impact = point.may_impact && point.normal_impulse > 0.0 && point.impact_velocity < -threshold;
        // With a point that separates, an impact elsewhere may reverse its velocity too. If its velocity only fell to
        // zero, the impulse would add energy.
        point.rebounds = point.has_impact || point.impact_velocity > 0.0;
        if point.has_impact {
            fastest = fastest.max(-point.impact_velocity);
        }
    }
    fastest
}

/// Ends the impacts of a pair: the bodies separate, so the impulses must not be applied again.
pub(super) fn end_impacts(pair: &Pair, points: &mut [Point]) {
    if !pair.active {
        return;
    }
    for point in points.iter_mut().filter(|point| point.has_impact) {
        point.total_normal_impulse += point.normal_impulse;
        point.normal_impulse = 0.0;
        point.friction_impulse = [0.0; 2];
        point.bounced = true;
    }
}
