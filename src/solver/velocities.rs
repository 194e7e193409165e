//! The velocities of the bodies of a batch during a pass, and how impulses change them.

use super::batch::{Batch, RowLanes, gather};
use super::motion::Velocity;
use crate::geometry::lanes::StoredPoints;
use crate::simd::lanes::{
    Points, Simd, SimdBase, add, bitmask, bits, dot, f32x8, lane_of, load_points, mask32x8, mul, scale, splat,
    store_points, sub,
};

/// The velocities of the bodies of a batch during a pass.
pub(super) struct PairVelocities<S: Simd> {
    /// Linear velocities of both sides, before the pass.
    linear: [StoredPoints; 2],
    /// Linear velocity of the second side relative to the first: before the pass, and now.
    apart_before: Points<S>,
    apart: Points<S>,
    /// Angular velocities of both sides, now.
    pub angular: [Points<S>; 2],
}

impl<S: Simd> PairVelocities<S> {
    #[inline(always)]
    pub fn load(simd: S, batch: &Batch, velocities: &[Velocity]) -> Self {
        let of = |slot: usize| {
            let [x, y, z] = velocities[slot].linear.to_array();
            let [p, q, r] = velocities[slot].angular.to_array();
            [x, y, z, p, q, r]
        };
        let ([a, b, c, d, e, f], [p, q, r, s, t, u]) = (gather(batch, 0, of), gather(batch, 1, of));
        let linear = [[a, b, c], [p, q, r]];
        let apart = sub(load_points(simd, &linear[1]), load_points(simd, &linear[0]));
        Self {
            linear,
            apart_before: apart,
            apart,
            angular: [load_points(simd, &[d, e, f]), load_points(simd, &[s, t, u])],
        }
    }

    /// Velocities of the second bodies relative to the first along a row's directions. Along the normal they are
    /// positive when the bodies separate.
    #[inline(always)]
    pub fn along(&self, row: &RowLanes) -> f32x8<S> {
        let simd = self.apart[0].simd;
        let [a, b] = &row.moments;
        let turning = dot(load_points(simd, b), self.angular[1]) - dot(load_points(simd, a), self.angular[0]);
        dot(load_points(simd, &row.direction), self.apart) + turning
    }

    /// Applies impulses to the second bodies, and their opposites to the first.
    #[inline(always)]
    pub fn apply(&mut self, batch: &Batch, row: &RowLanes, impulse: f32x8<S>) {
        let simd = impulse.simd;
        let push = scale(load_points(simd, &row.direction), impulse);
        self.apart = add(self.apart, mul(load_points(simd, &batch.inverse_mass), push));
        let [a, b] = &row.angular_responses;
        self.angular[0] = sub(self.angular[0], scale(load_points(simd, a), impulse));
        self.angular[1] = add(self.angular[1], scale(load_points(simd, b), impulse));
    }

    /// Stores the velocities of bodies that impulses move. Numbers that are not finite are dropped.
    #[inline(always)]
    pub fn store(&self, batch: &Batch, velocities: &mut [Velocity]) {
        let simd = self.apart[0].simd;
        let change = sub(self.apart, self.apart_before);
        let [a, b] = &batch.shares;
        let a = sub(load_points(simd, &self.linear[0]), mul(load_points(simd, a), change));
        let b = add(load_points(simd, &self.linear[1]), mul(load_points(simd, b), change));
        self.store_side(batch, 0, a, velocities);
        self.store_side(batch, 1, b, velocities);
    }

    #[inline(always)]
    fn store_side(&self, batch: &Batch, side: usize, linear: Points<S>, velocities: &mut [Velocity]) {
        let angular = self.angular[side];
        let finite = bitmask(are_finite(linear) & are_finite(angular));
        let (linear, angular): (StoredPoints, StoredPoints) = (store_points(linear), store_points(angular));
        for lane in bits(finite & batch.movable[side]) {
            velocities[batch.slots[side][lane] as usize] = Velocity {
                linear: lane_of(&linear, lane).into(),
                angular: lane_of(&angular, lane).into(),
            };
        }
    }
}

/// Lanes of vectors without infinite numbers and NaN.
#[inline(always)]
fn are_finite<S: Simd>([x, y, z]: Points<S>) -> mask32x8<S> {
    let limit = splat(x.simd, f32::INFINITY);
    x.abs().simd_lt(limit) & y.abs().simd_lt(limit) & z.abs().simd_lt(limit)
}
