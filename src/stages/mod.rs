//! The fixed step: its stages in order, each in a folder of its own with one file per backend.
//!
//! | stage | reads | writes |
//! |---|---|---|
//! | [`broad_phase`] | bounding spheres, and how far bodies look | pairs whose spheres overlap |
//! | [`angles`] | those pairs, poses, support heights, face tables | pairs that no support plane separates, with relative poses and what is seen of each end |
//! | [`triangle_test`] | those pairs, triangles | touching pairs, intersecting faces, contacts |
//! | [`manifolds`] | the same pairs, vertices, edges and faces | the points at which bodies push each other |
//! | [`force_scan`] | contacts, or with [`Response::Contacts`](crate::settings::Response) the points, for the [`solver`] | one sum of impulses per body, or motions |
//! | [`integrate`] | those, gravity | velocities and poses |
//!
//! With `Response::Contacts` a step is cut into as many *detection intervals* as its bodies need, by how fast they move against
//! each other, and all stages but
//! the triangle test run in each; see [`solver`].
//!
//! Each stage has a file per backend: `cpu.rs` runs on rayon, `gpu.rs` declares the kernels in `shaders/` that do the same
//! on a device (see `crate::gpu`, and `crate::gpu::contacts` for a step with contacts). Continuous collision is the CPU's alone:
//! steps with a body that asks for it run there.
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

use crate::settings::Response;
use state::StepState;
use std::time::{Duration, Instant};

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
    /// Sums impulses per body; with [`Response::Contacts`](crate::settings::Response) in many passes, between which bodies
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

    /// Runs this stage on the CPU, on rayon's current thread pool, and notes how long it took.
    ///
    /// A step begins with the first stage and ends with the last one, which goes on with all stages for the other detection
    /// intervals, if there are any.
    pub fn run_on_cpu(self, state: &mut StepState) {
        if self == Self::BroadPhase {
            solver::step::begin(state);
        }
        state.times[self as usize] = self.run_once(state);
        if self == Self::Integrate {
            for _ in 1..state.dynamics.intervals() {
                // What the triangle test reports is meant for the beginning of the step.
                for stage in Self::ALL.into_iter().filter(|&stage| stage != Self::TriangleTest) {
                    let time = stage.run_once(state);
                    state.times[stage as usize] += time;
                }
            }
            solver::step::end(state);
        }
    }

    fn run_once(self, state: &mut StepState) -> Duration {
        let start = Instant::now();
        match self {
            Self::BroadPhase => broad_phase::cpu::run(state),
            Self::Angles => angles::cpu::run(state),
            Self::TriangleTest => triangle_test::cpu::run(state),
            Self::Manifolds => manifolds::step::run(state),
            Self::ForceScan if state.config.response == Response::Contacts => solver::step::solve(state),
            Self::ForceScan => force_scan::cpu::run(state),
            Self::Integrate if state.config.response == Response::Contacts => solver::step::move_bodies(state),
            Self::Integrate => integrate::cpu::run(state),
        }
        start.elapsed()
    }
}
