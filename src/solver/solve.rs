//! The passes over a batch: impulses that change the velocities of its bodies.

use super::batch::{Batch, PointLanes};
use super::colors::ALL_LANES;
use super::friction::friction_impulse;
use super::motion::Velocity;
use super::pass::Pass;
use super::velocities::PairVelocities;
use crate::simd::lanes::{
    Select, Simd, SimdBase, bitmask, cross, dot, f32x8, lanes, load, load_points, mask32x8, scale, splat, store, sub,
};

/// A point is active in a substep if the gap beyond the rest offset will be less than this many rest offsets.
pub(super) const ACTIVATION_DISTANCE: f32 = 5.0;
/// An error is too large if it moves a body by this fraction of D within a substep, however slow that is.
pub(super) const MAX_STEP_ERROR: f32 = 1.0e-4;

/// A pair is far from converged if a pass changes its velocity by this multiple of what counts.
const FAR: f32 = 4.0;

/// Decides which points of a batch are active in this substep. They are up to date with the poses.
#[inline(always)]
pub(super) fn begin_substep<S: Simd>(
    simd: S,
    batch: &mut Batch,
    points: &mut [PointLanes],
    velocities: &[Velocity],
    pass: &Pass,
) {
    let zero = splat(simd, 0.0);
    let h = splat(simd, pass.h);
    let velocities = PairVelocities::load(simd, batch, velocities);
    let tangent_velocity = load_points(simd, &batch.tangent_velocity);
    let activation_distance = splat(simd, ACTIVATION_DISTANCE) * load(simd, &batch.rest_offset);
    batch.active = 0;
    for point in points.iter_mut().filter(|point| point.valid != 0) {
        // The point moves along an arc.
        let [spin_a, spin_b] = velocities.angular;
        let [anchor_a, anchor_b] = &point.anchors;
        let arc_a = cross(spin_a, cross(spin_a, load_points(simd, anchor_a)));
        let arc_b = cross(spin_b, cross(spin_b, load_points(simd, anchor_b)));
        let drift = scale(sub(arc_b, arc_a), splat(simd, 0.5) * h);
        for i in 0..2 {
            let tangent = load_points(simd, &point.rows[i + 1].direction);
            let surface_speed = dot(tangent_velocity, tangent);
            point.surface_speed[i] = store(surface_speed);
            point.drift[i] = store(dot(drift, tangent) + surface_speed);
        }
        // All points are judged by the velocities before the warm start.
        let normal_velocity = velocities.along(&point.rows[0]);
        let impulse = load(simd, &point.normal_impulse);
        point.total_normal_impulse = store(load(simd, &point.total_normal_impulse) + impulse);
        let pushes = impulse.simd_gt(zero);
        let meets = (load(simd, &point.separation) + normal_velocity * h).simd_lt(activation_distance);
        point.may_impact = point.valid & !bitmask(pushes);
        point.has_impact = 0;
        point.rebounds = 0;
        point.touched |= bitmask(pushes);
        point.active = point.valid & bitmask(pushes | meets);
        batch.active |= point.active;
        let active = lanes(simd, point.active);
        for impulse in &mut point.friction_impulse {
            *impulse = store(active.select(load(simd, impulse), zero));
        }
    }
    pass.aim(simd, batch, points);
}

/// Applies the impulses of a batch, times `factor`.
#[inline(always)]
pub(super) fn apply_impulses<S: Simd>(
    simd: S,
    batch: &Batch,
    points: &[PointLanes],
    velocities: &mut [Velocity],
    factor: f32x8<S>,
) {
    if batch.active == 0 {
        return;
    }
    let mut changed = PairVelocities::load(simd, batch, velocities);
    for point in points.iter().filter(|point| point.active != 0) {
        let [t, u] = &point.friction_impulse;
        changed.apply(batch, &point.rows[0], factor * load(simd, &point.normal_impulse));
        changed.apply(batch, &point.rows[1], factor * load(simd, t));
        changed.apply(batch, &point.rows[2], factor * load(simd, u));
    }
    changed.store(batch, velocities);
}

/// How far a pass changed the impulses of an island.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residual<S: Simd> {
    /// The largest change of a normal velocity, over that below which its pair has converged.
    pub velocity: f32x8<S>,
    /// The sum of the squared changes of impulses, each over its effective mass, joules.
    pub energy: f32x8<S>,
}

impl<S: Simd> Residual<S> {
    #[inline(always)]
    pub fn zero(simd: S) -> Self {
        Self {
            velocity: splat(simd, 0.0),
            energy: splat(simd, 0.0),
        }
    }

    /// Adds the residual of a batch whose lanes have pairs of different islands.
    #[inline(always)]
    pub fn add(&mut self, batch: Self) {
        self.velocity = batch.velocity.max(self.velocity);
        self.energy += batch.energy;
    }

    /// Adds the residual of a batch whose first `pairs` lanes have pairs of one island. The energies are added pair by
    /// pair, as if each pair were a batch.
    #[inline(always)]
    pub fn add_pairs(&mut self, batch: Self, pairs: usize) {
        let mut sum = self.energy.to_array()[0];
        for energy in &batch.energy.to_array()[..pairs] {
            sum += energy;
        }
        self.velocity = batch.velocity.max(self.velocity);
        self.energy = splat(self.energy.simd, sum);
    }

    /// Lanes with a pair that is far from converged.
    #[inline(always)]
    pub fn far(&self) -> u32 {
        bitmask(self.velocity.simd_gt(splat(self.velocity.simd, FAR)))
    }

    /// Lanes in which all pairs have converged.
    #[inline(always)]
    pub fn converged(&self) -> u32 {
        ALL_LANES & !bitmask(self.velocity.simd_gt(splat(self.velocity.simd, 1.0)))
    }
}

/// One pass over the active points of a batch: first the normals, then friction. Impulses change in the lanes `live`.
#[inline(always)]
pub(super) fn solve<S: Simd>(
    simd: S,
    batch: &Batch,
    points: &mut [PointLanes],
    velocities: &mut [Velocity],
    pass: &Pass,
    live: mask32x8<S>,
) -> Residual<S> {
    let mut residual = Residual::zero(simd);
    if batch.active == 0 {
        return residual;
    }
    let zero = splat(simd, 0.0);
    let mut changed = PairVelocities::load(simd, batch, velocities);
    let mut largest_change = zero;
    for point in points.iter_mut().filter(|point| point.active != 0) {
        let before = load(simd, &point.normal_impulse);
        let velocity_error = changed.along(&point.rows[0]) + load(simd, &point.aim.bias);
        let wanted =
            load(simd, &point.aim.normal_response) * velocity_error + load(simd, &point.aim.impulse_scale) * before;
        let impulse = live.select((before - wanted).max(zero), before);
        let change = impulse - before;
        changed.apply(batch, &point.rows[0], change);
        let velocity_change = change * load(simd, &point.inverse_effective_mass[0]);
        largest_change = velocity_change.abs().max(largest_change);
        residual.energy += change * velocity_change;
        point.change[0] = store(change);
        point.normal_impulse = store(impulse);
        point.touched |= bitmask(impulse.simd_gt(zero));
    }
    let friction = load(simd, &batch.friction);
    for point in points.iter_mut().filter(|point| point.active != 0) {
        let limit = friction * load(simd, &point.normal_impulse);
        let impulses = friction_impulse(simd, &changed, point, limit);
        let inverse_effective_mass = load(simd, &point.inverse_effective_mass[1]);
        for (i, impulse) in impulses.into_iter().enumerate() {
            let before = load(simd, &point.friction_impulse[i]);
            let impulse = live.select(impulse, before);
            let change = impulse - before;
            changed.apply(batch, &point.rows[i + 1], change);
            residual.energy += change * change * inverse_effective_mass;
            point.change[i + 1] = store(change);
            point.friction_impulse[i] = store(impulse);
        }
    }
    // A light body passes on only a small part of what a heavy one needs, so it must be more exact.
    let step_error = splat(simd, MAX_STEP_ERROR) * load(simd, &batch.diameter) / splat(simd, pass.h);
    let converged = load(simd, &pass.convergence_speed).min(step_error) / load(simd, &batch.mass_ratio);
    residual.velocity = (largest_change / converged).max(residual.velocity);
    changed.store(batch, velocities);
    residual
}

/// Begins the search along the changes of the last pass. It has no direction before.
pub(super) fn begin_search(points: &mut [PointLanes]) {
    for point in points {
        point.search = point.change;
    }
}

/// Moves the impulses of the lanes `live` on along the search direction. `keep` is the part of the last direction that
/// the new one keeps.
#[inline(always)]
pub(super) fn extrapolate<S: Simd>(
    simd: S,
    batch: &Batch,
    points: &mut [PointLanes],
    velocities: &mut [Velocity],
    live: mask32x8<S>,
    keep: f32x8<S>,
) {
    if batch.active == 0 {
        return;
    }
    let zero = splat(simd, 0.0);
    let mut changed = PairVelocities::load(simd, batch, velocities);
    for point in points.iter_mut().filter(|point| point.active != 0) {
        let before = load(simd, &point.normal_impulse);
        let normal = keep * load(simd, &point.search[0]);
        let impulse = live.select((before + normal).max(zero), before);
        changed.apply(batch, &point.rows[0], impulse - before);
        point.normal_impulse = store(impulse);
        point.search[0] = store(normal + load(simd, &point.change[0]));
        for i in 0..2 {
            let along = live.select(keep * load(simd, &point.search[i + 1]), zero);
            changed.apply(batch, &point.rows[i + 1], along);
            point.friction_impulse[i] = store(load(simd, &point.friction_impulse[i]) + along);
            point.search[i + 1] = store(along + load(simd, &point.change[i + 1]));
        }
    }
    changed.store(batch, velocities);
}
