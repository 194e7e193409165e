//! Soft constraints: the damped spring of a contact.

use super::bodies::SolverBody;
use crate::types::body::RigidBody;
use crate::types::solver_settings::SolverSettings;
use std::f32::consts::TAU;

/// The contact spring of a kinematic body is at most this many times as soft as that of a static one.
pub(super) const SOFTEST: f32 = 100.0;
/// How much more a body gives way at its corners, where contact points are, than at its centre. That of a cube.
pub(super) const CORNER: f32 = 4.0;

/// The contact springs of an island that gets fewer passes than this are damped less. Impulses that are far from
/// converged would keep a large pile in motion for ever: each substep would take back another part of them.
pub(super) const FEW_PASSES: u32 = 7;
/// The largest damping ratio of such springs. They give way as far under a load, and forget a larger part of impulses.
const FEW_PASSES_DAMPING_RATIO: f32 = 1.5;

/// Coefficients of a damped spring that is integrated by implicit Euler (Catto, "Soft Constraints", GDC 2011).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Softness {
    /// Bias velocity per metre of overlap, 1/s.
    pub bias_rate: f32,
    /// Factor on the impulse of a rigid constraint.
    pub mass_scale: f32,
    /// Fraction of the accumulated impulse that is subtracted.
    pub impulse_scale: f32,
}

impl Softness {
    /// The contact spring for a substep of `h` seconds.
    pub fn new(settings: &SolverSettings, h: f32) -> Self {
        Self::damped(settings, h, settings.damping_ratio)
    }

    /// The contact spring of an island that gets few passes.
    pub fn of_few_passes(settings: &SolverSettings, h: f32) -> Self {
        Self::damped(settings, h, settings.damping_ratio.min(FEW_PASSES_DAMPING_RATIO))
    }

    fn damped(settings: &SolverSettings, h: f32, damping_ratio: f32) -> Self {
        let angular_frequency = TAU * settings.frequency / h;
        let a1 = 2.0 * damping_ratio + h * angular_frequency;
        let a2 = h * angular_frequency * a1;
        let a3 = 1.0 / (1.0 + a2);
        Self {
            bias_rate: angular_frequency / a1,
            mass_scale: a2 * a3,
            impulse_scale: a3,
        }
    }
}

/// How much softer the contact spring of these bodies is than that of a static body and the movable one.
///
/// The stiffness of a contact spring is proportional to the effective mass. A kinematic body counts with the mass that
/// it would have if it were dynamic. Otherwise one of several equal supports would carry more than the others once it
/// is kinematic: up to twice as much beside supports as heavy as their load, and nearly the whole load if that is
/// heavy.
pub(super) fn beside_kinematic(bodies: [&SolverBody; 2]) -> f32 {
    let softness = |kinematic: &SolverBody, other: &SolverBody| {
        (kinematic.kind == RigidBody::Kinematic && other.has_mass())
            .then(|| 1.0 + CORNER * kinematic.own_inverse_mass / other.inverse_mass)
            .filter(|softness| softness.is_finite())
            .map(|softness| softness.clamp(1.0, SOFTEST))
    };
    let [a, b] = bodies;
    softness(a, b).or_else(|| softness(b, a)).unwrap_or(1.0)
}
