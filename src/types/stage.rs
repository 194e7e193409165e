//! [`Stage`]: the stages of a step, in order.

/// A stage of the step. The stages run in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Finds pairs of bodies whose bounding spheres overlap.
    BroadPhase,
    /// Computes each pair's relative pose, rejects pairs that a support axis separates, and looks up the visible
    /// faces.
    Angles,
    /// Tests triangles against triangles.
    TriangleTest,
    /// Computes contact manifolds: the points at which bodies push each other.
    Manifolds,
    /// Sums the impulses of each body. With [`Response::Contacts`](crate::types::settings::Response::Contacts) it runs
    /// the solver's substeps, in which bodies move.
    ForceScan,
    /// Moves the bodies.
    Integrate,
}

impl Stage {
    /// Number of stages.
    pub const COUNT: usize = 6;

    /// All stages, in order.
    pub const ALL: [Self; Self::COUNT] = [
        Self::BroadPhase,
        Self::Angles,
        Self::TriangleTest,
        Self::Manifolds,
        Self::ForceScan,
        Self::Integrate,
    ];

    /// The stage's name in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::BroadPhase => "broad_phase",
            Self::Angles => "angles",
            Self::TriangleTest => "triangle_test",
            Self::Manifolds => "manifolds",
            Self::ForceScan => "force_scan",
            Self::Integrate => "integrate",
        }
    }
}
