//! Restitution: impacts reverse the normal velocity (Newton's law of restitution).
//!
//! Impacts are resolved in the substep in which they occur, with all contacts of the island at once: no point's total
//! impulse is negative, and its velocity is at least the reversed one. Such a solution keeps the energy of elastic
//! bodies, however many points meet at once.

use super::batch::{Batch, PointLanes};
use super::motion::Velocity;
use super::velocities::PairVelocities;
use crate::simd::lanes::{Select, Simd, SimdBase, bitmask, f32x8, lanes, load, splat, store};

/// Passes end when no normal velocity changes by more than this fraction of the speed of the fastest impact.
pub(super) const TOLERANCE: f32 = 1.0e-5;

/// Marks the points of a batch that have an impact faster than `threshold`, m/s, in this substep, and returns for each
/// lane the speed of the fastest one that needs restitution; 0 if there is none. `before` are the velocities before the
/// impulses of the substep.
#[inline(always)]
pub(super) fn find_impacts<S: Simd>(
    simd: S,
    batch: &Batch,
    points: &mut [PointLanes],
    before: &[Velocity],
    threshold: f32,
) -> f32x8<S> {
    let zero = splat(simd, 0.0);
    if batch.active & batch.elastic == 0 {
        return zero;
    }
    let before = PairVelocities::load(simd, batch, before);
    let mut fastest = zero;
    for point in points.iter_mut().filter(|point| point.active != 0) {
        let velocity = before.along(&point.rows[0]);
        let impact = load(simd, &point.normal_impulse).simd_gt(zero) & velocity.simd_lt(splat(simd, -threshold));
        let elastic = point.active & batch.elastic;
        point.impact_velocity = store(velocity);
        point.has_impact = point.may_impact & elastic & bitmask(impact);
        // With a point that separates, an impact elsewhere may reverse its velocity too. If its velocity only fell to
        // zero, the impulse would add energy.
        point.rebounds = point.has_impact | elastic & bitmask(velocity.simd_gt(zero));
        fastest = lanes(simd, point.has_impact).select(-velocity, zero).max(fastest);
    }
    fastest
}

/// Ends the impacts of a batch: the bodies separate, so the impulses must not be applied again.
#[inline(always)]
pub(super) fn end_impacts<S: Simd>(simd: S, points: &mut [PointLanes]) {
    let zero = splat(simd, 0.0);
    for point in points.iter_mut().filter(|point| point.has_impact != 0) {
        let ends = lanes(simd, point.has_impact);
        let impulse = load(simd, &point.normal_impulse);
        let total = load(simd, &point.total_normal_impulse);
        point.total_normal_impulse = store(ends.select(total + impulse, total));
        point.normal_impulse = store(ends.select(zero, impulse));
        for impulse in &mut point.friction_impulse {
            *impulse = store(ends.select(zero, load(simd, impulse)));
        }
        point.bounced |= point.has_impact;
    }
}
