//! [`Stage`]: the stages of a step by name.

/// The stages in the order they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Finds pairs of bodies whose bounding spheres overlap.
    BroadPhase,
    /// Computes each pair's relative pose, rejects what a support plane separates, and looks up what the ends see.
    Angles,
    /// Tests triangles against triangles.
    TriangleTest,
    /// Finds the points at which bodies push each other.
    Manifolds,
    /// Sums impulses per body; with [`Response::Contacts`](crate::types::settings::Response) in many passes, between which bodies
    /// move.
    ForceScan,
    /// Moves the bodies.
    Integrate,
}

impl Stage {
    /// How many there are.
    pub const COUNT: usize = 6;

    /// All of them, in order.
    pub const ALL: [Self; Self::COUNT] = [
        Self::BroadPhase,
        Self::Angles,
        Self::TriangleTest,
        Self::Manifolds,
        Self::ForceScan,
        Self::Integrate,
    ];

    /// Its name in reports and JSON.
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
