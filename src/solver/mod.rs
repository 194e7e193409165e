//! The solver: contact points in, moved bodies out.
//!
//! Contacts are damped springs solved as velocity constraints over small substeps ("soft step": Catto, "Solver2D", 2024).
//! Each substep speeds up the bodies, applies last substep's impulses again, lets bias passes push overlapping bodies apart,
//! moves the bodies, and lets relax passes take out the velocity of the push.
//!
//! Within a pass every pair works by itself, from the same velocities (Gauss-Seidel over its own points, Jacobi across
//! pairs), and leaves one impulse per end; every body then sums the impulses of its ends, in the order of pairs. Both halves are plain
//! loops over flat `f32` data without order among their turns: the result has the same bits for any number of threads.
//! A body that takes part in `n` pairs counts as `n` bodies of `1/n` its mass, one for each (mass splitting: Tonge,
//! "Mass Splitting for Jitter-Free Parallel Rigid Body Simulation", 2012): without it the sum of all answers explodes.
//!
//! | file | holds |
//! |---|---|
//! | `adapter` | the way from a step's bodies to these and back |
//! | [`bodies`] | what bodies are, how they move, what acts on them |
//! | [`speeds`] | how fast bodies move against each other |
//! | `constraints` | a pair's points as the solver works on them, and how they are made |
//! | `pairs` | what a pair does in a pass |
//! | `motion` | what a body does in a pass |
//! | `ends` | which ends of pairs a body has |
//! | `overlap` | what is made of points that disagree |
//! | [`warm_start`] | what is kept from one interval to the next |
//! | `gpu` | the same on a device, with the feature `gpu` |
//!
//! What can be set is in [`SolverSettings`]. Half-spaces take part as static bodies.

mod adapter;
pub mod bodies;
mod constraints;
mod ends;
#[cfg(feature = "gpu")]
pub mod gpu;
mod motion;
mod overlap;
mod pairs;
pub(crate) mod softness;
pub mod speeds;
pub mod warm_start;

pub use bodies::{SleepState, SolverBodies, SolverBody, SolverMotion};
pub use warm_start::WarmStart;

use crate::state::{Manifolds, StepConfig};
use crate::types::solver_settings::SolverSettings;
use constraints::Constraints;
use ends::Ends;
use glam::Vec3;
use motion::Movers;
use pairs::Pass;

/// A stretch of time over which contact points hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Its length, seconds.
    pub dt: f32,
    /// Into how many substeps it is cut; see [`SolverSettings::substeps_per_collision_substep`].
    pub substeps: u32,
    /// Acceleration of bodies, m/s^2.
    pub gravity: Vec3,
}

impl Interval {
    /// One of `collision_substeps` collision substeps of a step.
    pub fn of(config: &StepConfig, collision_substeps: u32) -> Self {
        Self {
            dt: config.per_collision_substep(collision_substeps).dt,
            substeps: config.solver.substeps_per_collision_substep(collision_substeps),
            gravity: config.gravity,
        }
    }
}

/// Moves bodies that touch. Holds nothing but memory, so that a solver can serve several worlds in turn.
#[derive(Clone, Debug, Default)]
pub struct Solver {
    movers: Movers,
    constraints: Constraints,
    ends: Ends,
}

impl Solver {
    /// Moves `bodies` over one collision substep, on rayon's current thread pool.
    ///
    /// `manifolds` are the contact points at its start, `warm` what the last interval left behind; an empty one works, and
    /// costs some sinking. Impulses in [`SolverBodies::forces`] are used up.
    ///
    /// Bad input is left out: pairs that name no two different bodies, points with numbers that are not finite or with
    /// normals that are not of unit length, and bodies whose motion is not finite, which stay as they are. So does
    /// everything if the interval is empty.
    pub fn solve(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        warm: &mut WarmStart,
        settings: &SolverSettings,
        interval: &Interval,
    ) {
        let substeps = interval.substeps.max(1);
        let h = interval.dt / substeps as f32;
        if !(h > 0.0 && h.is_finite() && interval.gravity.is_finite()) {
            return;
        }
        let Self {
            movers,
            constraints,
            ends,
        } = self;
        movers.begin(bodies, h);
        constraints.prepare(bodies, movers, manifolds, warm, settings, h, interval.dt);
        ends.build(constraints.pairs(), movers);

        let pass = Pass::new(settings, h);
        for _ in 0..substeps {
            movers.accelerate(bodies, interval.gravity, h);
            constraints.begin_substep(movers, &pass);
            movers.share_out(constraints.pairs(), ends);
            movers.take(constraints.impulses(), ends);
            for _ in 0..settings.bias_iterations {
                constraints.solve(movers, &pass);
                movers.take(constraints.impulses(), ends);
            }
            movers.advance(bodies, h);
            constraints.begin_relaxing(movers);
            let pass = pass.relaxing();
            for _ in 0..settings.relax_iterations {
                constraints.solve(movers, &pass);
                movers.take(constraints.impulses(), ends);
            }
        }
        if constraints.begin_bounce(settings.restitution_threshold) {
            movers.share_out(constraints.pairs(), ends);
            for _ in 0..settings.restitution_iterations {
                constraints.bounce(movers);
                movers.take(constraints.impulses(), ends);
            }
        }
        movers.finish(bodies);
        warm.keep(constraints, movers, bodies, h);
    }

    /// The normal impulse that point `index` of the last call's [`Manifolds::points`] gave over the whole interval, newton
    /// seconds; 0 for one that is not there.
    pub fn impulse_of(&self, index: usize) -> f32 {
        self.constraints.impulse_of(index)
    }

    /// Whether that point pushed in the last call, or, if both bodies sleep, when they fell asleep.
    pub(crate) fn pushes(&self, index: usize) -> bool {
        self.constraints.pushes(index)
    }
}
