//! What holds for all bodies in a step.

use crate::types::settings::Response;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3;

/// What holds for all bodies in a step.
#[derive(Clone, Copy, Debug)]
pub struct StepConfig {
    /// Length of the step in seconds, more than 0.
    pub dt: f32,
    /// Acceleration in m/s^2.
    pub gravity: Vec3,
    /// What happens to bodies that touch.
    pub response: Response,
    /// How contacts are solved.
    pub solver: SolverSettings,
}

impl Default for StepConfig {
    fn default() -> Self {
        Self {
            dt: 1.0 / 64.0,
            gravity: Vec3::ZERO,
            response: Response::Impulse,
            solver: SolverSettings::default(),
        }
    }
}

impl StepConfig {
    /// What holds in each of `collision_substeps` collision substeps of the step.
    pub(crate) fn of_interval(&self, collision_substeps: u32) -> Self {
        Self {
            dt: self.dt / collision_substeps.max(1) as f32,
            ..*self
        }
    }
}
