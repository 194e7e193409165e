//! Soft constraints: the damped spring of a contact.

use crate::types::solver_settings::SolverSettings;
use std::f32::consts::TAU;

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
        let angular_frequency = TAU * settings.frequency / h;
        let a1 = 2.0 * settings.damping_ratio + h * angular_frequency;
        let a2 = h * angular_frequency * a1;
        let a3 = 1.0 / (1.0 + a2);
        Self {
            bias_rate: angular_frequency / a1,
            mass_scale: a2 * a3,
            impulse_scale: a3,
        }
    }
}
