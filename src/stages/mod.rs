//! The fixed step: five stages in order, each in a folder of its own with one file per backend.
//!
//! | stage | reads | writes |
//! |---|---|---|
//! | [`broad_phase`] | bounding spheres | pairs whose spheres overlap |
//! | [`angles`] | those pairs, poses, support heights, face tables | pairs that no support plane separates, with relative poses and what is seen of each end |
//! | [`triangle_test`] | those pairs, triangles | touching pairs, intersecting faces, contacts |
//! | [`force_scan`] | contacts | one sum of impulses per body |
//! | [`integrate`] | the sums, gravity | velocities and poses |
//!
//! Each stage has a file per backend: `cpu.rs` runs on rayon, `gpu.rs` declares the kernels in `shaders/` that do the same
//! on a device (see `crate::gpu`).
//!
//! Two more lie ready that the step does not run yet: [`manifolds`] finds the points at which bodies push each other, and
//! [`solver`] moves the bodies by them. It does what [`force_scan`] and [`integrate`] do, with friction, over several substeps.
//!
//! [`state`] holds every array that passes between them. Stages know nothing of the ECS: the plugin copies components
//! in and results out.

pub mod angles;
pub mod bodies;
pub mod broad_phase;
pub mod continuous;
pub mod force_scan;
pub(crate) mod in_order;
pub mod integrate;
pub mod manifolds;
pub mod mesh_arena;
pub(crate) mod per_thread;
pub mod solver;
pub mod state;
pub mod triangle_test;

use state::StepState;

/// The stages in the order they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Finds pairs of bodies whose bounding spheres overlap.
    BroadPhase,
    /// Computes each pair's relative pose, rejects what a support plane separates, and looks up what the ends see.
    Angles,
    /// Tests triangles against triangles.
    TriangleTest,
    /// Sums impulses per body.
    ForceScan,
    /// Moves the bodies.
    Integrate,
}

impl Stage {
    /// All of them, in order.
    pub const ALL: [Self; 5] = [
        Self::BroadPhase,
        Self::Angles,
        Self::TriangleTest,
        Self::ForceScan,
        Self::Integrate,
    ];

    /// Its name in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::BroadPhase => "broad_phase",
            Self::Angles => "angles",
            Self::TriangleTest => "triangle_test",
            Self::ForceScan => "force_scan",
            Self::Integrate => "integrate",
        }
    }

    /// Runs this stage on the CPU, on rayon's current thread pool, and notes how long it took.
    pub fn run_on_cpu(self, state: &mut StepState) {
        let start = std::time::Instant::now();
        match self {
            Self::BroadPhase => broad_phase::cpu::run(state),
            Self::Angles => angles::cpu::run(state),
            Self::TriangleTest => triangle_test::cpu::run(state),
            Self::ForceScan => force_scan::cpu::run(state),
            Self::Integrate => integrate::cpu::run(state),
        }
        state.times[self as usize] = start.elapsed();
    }
}
