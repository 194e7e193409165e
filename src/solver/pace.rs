//! How far a body goes in a collision substep.

/// The part of a step that a body passes through in one collision substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Length, seconds; 0 for a body that has completed its step.
    pub dt: f32,
    /// Number of solver substeps in it, at least 1.
    pub substeps: u32,
}

impl Pace {
    /// The pace of a body that has completed its step.
    pub const DONE: Self = Self { dt: 0.0, substeps: 1 };

    /// Whether the body has completed its step.
    pub fn is_done(&self) -> bool {
        self.dt == 0.0
    }

    /// Sorts equal paces together.
    pub(super) fn key(&self) -> (u32, u32) {
        (self.dt.to_bits(), self.substeps)
    }

    /// Length of a solver substep, seconds.
    pub fn h(&self) -> f32 {
        self.dt / self.substeps as f32
    }

    /// The pace of an island whose bodies have these two paces. The bodies of an island nearly always have the same
    /// pace. They differ only if an impulse in this step changed a velocity beyond what was foreseen.
    pub fn and(self, other: Self) -> Self {
        Self {
            dt: self.dt.max(other.dt),
            substeps: self.substeps.max(other.substeps),
        }
    }

    /// This pace with `factor` times as many substeps.
    pub fn refined(self, factor: u32) -> Self {
        Self {
            substeps: self.substeps * factor,
            ..self
        }
    }
}
