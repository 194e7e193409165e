//! Parameters of a step that hold for all bodies.

use crate::types::limits::StepLimits;
use crate::types::settings::Response;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3;

/// Parameters of a step that hold for all bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepConfig {
    /// Length of the step in seconds, positive.
    pub dt: f32,
    /// Gravity, m/s^2.
    pub gravity: Vec3,
    /// How bodies that touch respond.
    pub response: Response,
    /// Settings of the contact solver.
    pub solver: SolverSettings,
    /// Limits on the lists of a step on the CPU.
    pub limits: StepLimits,
    /// Whether intersecting faces are listed. Without it a GPU only counts them.
    pub face_lists: bool,
}

impl Default for StepConfig {
    fn default() -> Self {
        Self {
            dt: 1.0 / 64.0,
            gravity: Vec3::ZERO,
            response: Response::Impulse,
            solver: SolverSettings::default(),
            limits: StepLimits::default(),
            face_lists: true,
        }
    }
}

impl StepConfig {
    /// The parameters of each of `collision_substeps` equal collision substeps.
    pub(crate) fn per_collision_substep(&self, collision_substeps: u32) -> Self {
        Self {
            dt: self.dt / collision_substeps.max(1) as f32,
            ..*self
        }
    }
}
