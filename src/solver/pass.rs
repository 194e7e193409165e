//! What the passes of a substep aim at.

use super::batch::{Batch, PointLanes};
use super::colors::LANES;
use super::softness::Softness;
use crate::geometry::lanes::Stored;
use crate::simd::lanes::{Select, Simd, SimdBase, lanes, load, splat, store};
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
    /// A pass with bias velocity in a substep of `h` seconds.
    pub fn new(settings: &SolverSettings, h: f32) -> Self {
        Self {
            h,
            softness: Softness::new(settings, h),
            max_depenetration_speed: settings.max_depenetration_speed,
            deep_depenetration_speed: settings.deep_depenetration_speed,
            purpose: Purpose::Bias,
            convergence_speed: Stored([settings.convergence_speed; LANES]),
        }
    }

    /// The same pass without bias velocity.
    pub fn relaxing(self) -> Self {
        Self {
            purpose: Purpose::Relax,
            ..self
        }
    }

    /// The same pass with restitution, until no velocity changes by more than `convergence_speed`.
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
        // Near the surface the bias of a pair in deep penetration falls below the maximum, to that of the contact spring
        // of other pairs.
        let deep = splat(simd, -self.deep_depenetration_speed);
        let fastest = depenetrating.select(deep, splat(simd, -self.max_depenetration_speed));
        let mass_scale = depenetrating.select(one, splat(simd, self.softness.mass_scale));
        let impulse_scale = depenetrating.select(zero, splat(simd, self.softness.impulse_scale));
        let restitution = load(simd, &batch.restitution);
        for point in points.iter_mut().filter(|point| point.active != 0) {
            let active = lanes(simd, point.active);
            let separation = load(simd, &point.separation);
            let is_apart = separation.simd_gt(zero);
            // Speculative contact: the gap may close by the end of the substep, and no sooner.
            let closing = separation / h;
            let (bias, mass_scale, impulse_scale) = match self.purpose {
                Purpose::Bias => (
                    is_apart.select(closing, (bias_rate * separation).max(fastest)),
                    is_apart.select(one, mass_scale),
                    is_apart.select(zero, impulse_scale),
                ),
                Purpose::Relax => (is_apart.select(closing, zero), one, zero),
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
}
