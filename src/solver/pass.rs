//! What the passes of a substep aim at.

use super::batch::{Batch, PointLanes};
use super::colors::{ALL_LANES, LANES};
use super::softness::Softness;
use crate::geometry::lanes::Stored;
use crate::simd::lanes::{Select, Simd, SimdBase, bitmask, f32x8, lanes, load, splat, store};
use crate::types::solver_settings::SolverSettings;

/// What a pass is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Purpose {
    /// Overlapping bodies get a bias velocity that pushes them apart.
    Bias,
    /// Removes the velocity that the bias added.
    Relax,
    /// Points with an impact separate as Newton's law of restitution tells.
    Restitution,
}

/// Parameters of a pass, the same for all pairs of a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Length of the substep, seconds.
    pub h: f32,
    softness: Softness,
    max_depenetration_speed: f32,
    deep_depenetration_speed: f32,
    purpose: Purpose,
    /// In each lane; see [`SolverSettings::convergence_speed`].
    pub convergence_speed: Stored,
}

impl Pass {
    /// A pass with bias velocity in a substep of `h` seconds, with these contact springs.
    pub fn new(settings: &SolverSettings, h: f32, softness: Softness) -> Self {
        Self {
            h,
            softness,
            max_depenetration_speed: settings.max_depenetration_speed,
            deep_depenetration_speed: settings.deep_depenetration_speed,
            purpose: Purpose::Bias,
            convergence_speed: Stored([settings.convergence_speed; LANES]),
        }
    }

    /// This pass without bias velocity.
    pub fn relaxing(self) -> Self {
        Self {
            purpose: Purpose::Relax,
            ..self
        }
    }

    /// This pass with restitution, until no velocity changes by more than `convergence_speed`.
    pub fn with_restitution(self, convergence_speed: Stored) -> Self {
        Self {
            convergence_speed,
            purpose: Purpose::Restitution,
            ..self
        }
    }

    /// Sets what passes aim at, after separations and effective masses have changed.
    #[inline(always)]
    pub fn aim<S: Simd>(&self, simd: S, batch: &Batch, points: &mut [PointLanes]) {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let h = splat(simd, self.h);
        let bias_rate = splat(simd, self.softness.bias_rate);
        let depenetrating = lanes(simd, batch.depenetrating);
        let ordinary = lanes(simd, ALL_LANES & !batch.depenetrating);
        // Near the surface the bias of a pair in deep penetration falls from the maximum to the bias of an ordinary
        // contact spring.
        let deep = splat(simd, -self.deep_depenetration_speed);
        let fastest = depenetrating.select(deep, splat(simd, -self.max_depenetration_speed));
        let (spring_mass_scale, spring_impulse_scale) = self.spring(simd, batch);
        let driven = lanes(simd, batch.driven);
        // Where a kinematic body moves, no constraint is rigid. A body that it squeezes against another one has no
        // velocity that satisfies both contacts, and rigid constraints would push from both sides, with impulses that
        // grow in each pass.
        let rigid_mass_scale = driven.select(splat(simd, self.softness.mass_scale), one);
        let rigid_impulse_scale = driven.select(splat(simd, self.softness.impulse_scale), zero);
        let mass_scale = depenetrating.select(rigid_mass_scale, spring_mass_scale);
        let impulse_scale = depenetrating.select(rigid_impulse_scale, spring_impulse_scale);
        let restitution = load(simd, &batch.restitution);
        for point in points.iter_mut().filter(|point| point.active != 0) {
            let active = lanes(simd, point.active);
            let separation = load(simd, &point.separation);
            let is_apart = separation.simd_gt(zero);
            // Speculative contact: the gap may close by the end of the substep, and no sooner.
            let closing = separation / h;
            let (bias, mass_scale, impulse_scale) = match self.purpose {
                Purpose::Bias => {
                    let wanted = bias_rate * separation;
                    let too_fast = wanted.simd_lt(fastest) & ordinary;
                    let (mut mass_scale, mut impulse_scale) = (mass_scale, impulse_scale);
                    if bitmask(too_fast) != 0 {
                        let (mass, impulse) = self.deep_spring(simd, batch, fastest / wanted);
                        mass_scale = too_fast.select(mass, mass_scale);
                        impulse_scale = too_fast.select(impulse, impulse_scale);
                    }
                    (
                        is_apart.select(closing, wanted.max(fastest)),
                        is_apart.select(rigid_mass_scale, mass_scale),
                        is_apart.select(rigid_impulse_scale, impulse_scale),
                    )
                }
                Purpose::Relax => (is_apart.select(closing, zero), rigid_mass_scale, rigid_impulse_scale),
                Purpose::Restitution => {
                    let rebound = restitution * load(simd, &point.impact_velocity);
                    let bias = lanes(simd, point.rebounds).select(rebound, is_apart.select(closing, zero));
                    (bias, one, zero)
                }
            };
            let [normal, tangent] = &point.inverse_effective_mass;
            let (normal, tangent) = (load(simd, normal), load(simd, tangent));
            let solved = active & normal.simd_gt(zero);
            point.aim.bias = store(bias);
            point.aim.normal_response = store(solved.select(mass_scale / normal, zero));
            point.aim.impulse_scale = store(solved.select(impulse_scale, zero));
            point.aim.friction_response = store((active & tangent.simd_gt(zero)).select(one / tangent, zero));
            point.aim.surface_speed = if self.purpose == Purpose::Bias {
                point.drift
            } else {
                point.surface_speed
            };
        }
    }

    /// The factors of the contact springs of a batch: on the impulse of a rigid constraint, and on the impulse that is
    /// subtracted.
    #[inline(always)]
    fn spring<S: Simd>(&self, simd: S, batch: &Batch) -> (f32x8<S>, f32x8<S>) {
        let mass_scale = splat(simd, self.softness.mass_scale);
        let impulse_scale = splat(simd, self.softness.impulse_scale);
        if batch.softened == 0 {
            return (mass_scale, impulse_scale);
        }
        let softened = lanes(simd, batch.softened);
        let (mass, impulse) = self.spring_of(simd, load(simd, &batch.softness));
        (
            softened.select(mass, mass_scale),
            softened.select(impulse, impulse_scale),
        )
    }

    /// The factors of springs at depths where they may push only with this fraction of their speed.
    ///
    /// The force goes on growing with the depth. So a body that is squeezed between two others, which push it at the
    /// same speed, overlaps both equally, whatever their kinds.
    #[inline(always)]
    fn deep_spring<S: Simd>(&self, simd: S, batch: &Batch, fraction: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
        let one = splat(simd, 1.0);
        let softness = one + (load(simd, &batch.softness) - one) * fraction;
        self.spring_of(simd, softness * fraction)
    }

    /// The factors of springs that are softer by this factor.
    #[inline(always)]
    fn spring_of<S: Simd>(&self, simd: S, softness: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
        let mass_scale = splat(simd, self.softness.mass_scale);
        let softer = softness * splat(simd, self.softness.impulse_scale);
        let sum = mass_scale + softer;
        (mass_scale / sum, softer / sum)
    }
}
