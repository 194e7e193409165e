//! The contact solver: from contact points and velocities to new velocities and poses.
//!
//! Contacts are soft constraints on velocities, solved over small substeps ("soft step": Catto, "Solver2D", 2024). Each
//! substep integrates velocities, warm starts, runs bias passes that push overlapping bodies apart, integrates poses,
//! runs relax passes that remove the velocity the bias added, and resolves impacts.
//!
//! Bodies that contacts connect form an island, and islands are independent. A pass is projected Gauss-Seidel over the
//! pairs of an island with an extrapolation between passes, until the velocities have converged; see `substep`. Pairs
//! are coloured, and pairs of one colour, which have no body in common that impulses move, are solved at once. On the
//! CPU, sparse islands whose passes do not converge are solved directly; see `direct`.
//!
//! On the CPU an island is solved by one thread: its passes are so short that threads would wait for each other longer
//! than they compute. It solves up to eight pairs at once, one in each lane of vector instructions; see `batch`. Small
//! islands are solved side by side, each in a lane; see `bundles`. The result has the same bits for any number of
//! threads and any set of vector instructions, and whatever other islands there are.
//!
//! On the GPU an island is solved by one workgroup, in one dispatch. CPU and GPU visit pairs in another order, and so
//! differ within the tolerance of convergence.
//!
//! | file | contents |
//! |---|---|
//! | `adapter` | conversion between the step's bodies and the solver's |
//! | [`bodies`] | the solver's bodies: properties, motion, forces |
//! | `impulses` | external impulses, at the beginning of a step |
//! | [`speeds`] | bounds on relative speeds, and the number of collision substeps |
//! | `islands` | sets of bodies that contacts connect |
//! | `motion` | velocities and poses of bodies during a collision substep, and their integration |
//! | `body_constants` | properties of a body that are constant during a collision substep; free rotation |
//! | `contact` | the contact constraint of one pair |
//! | `colors` | which pairs of an island are solved at once |
//! | `bundles` | which islands are solved side by side |
//! | `group` | islands of a bundle that go through the same substeps |
//! | `batch` | pairs and points in lanes |
//! | `constraints` | all constraints, and the parallel loop over their bundles |
//! | `prepare` | how constraints are made from manifolds |
//! | `patch` | where friction acts between flat surfaces |
//! | `load` | how stiff contact springs are under load, or how many substeps an island needs |
//! | `direct` | a direct solve of islands whose passes do not converge |
//! | `substep` | a collision substep of one bundle |
//! | `points` | how contact points move with their bodies |
//! | `pass` | what passes aim at |
//! | `solve` | the passes over one batch |
//! | `velocities` | velocities of the bodies of a batch, and how impulses change them |
//! | `friction` | friction impulses |
//! | `restitution` | impacts |
//! | `softness` | the contact spring |
//! | `clearance` | tight fits: what gap opposite contact points keep |
//! | `overlap` | deep penetration, and contact points with opposed normals |
//! | `pace` | how far a body goes in a collision substep |
//! | [`warm_start`] | impulses saved for the next collision substep |
//! | `gpu` | the solver on a GPU, with the feature `gpu` |
//!
//! [`SolverSettings`] has the parameters. Planes take part as static bodies.

mod adapter;
mod batch;
pub mod bodies;
mod body_constants;
mod bundles;
mod clearance;
mod colors;
mod constraints;
mod contact;
mod direct;
mod friction;
#[cfg(feature = "gpu")]
pub mod gpu;
mod group;
mod impulses;
mod islands;
mod load;
#[cfg(feature = "bevy")]
mod loaded;
mod motion;
mod overlap;
mod pace;
mod pass;
mod patch;
mod points;
mod prepare;
mod restitution;
pub(crate) mod softness;
mod solve;
pub mod speeds;
mod substep;
mod velocities;
pub mod warm_start;

#[cfg(any(feature = "bevy", feature = "gpu"))]
pub(crate) use adapter::PLANE_KEY;
pub use bodies::{SleepState, SolverBodies, SolverBody, SolverMotion};
pub use impulses::apply_impulses;
#[cfg(all(feature = "bevy", feature = "gpu"))]
pub(crate) use impulses::apply_impulses_of;
pub use pace::Pace;
pub use warm_start::WarmStart;

use crate::state::revision::Revision;
use crate::state::{Manifolds, StepConfig};
use crate::types::solver_settings::SolverSettings;
use constraints::Constraints;
use glam::Vec3;
use islands::Mobility;
use prepare::Source;

/// A collision substep: the part of a step that is solved with one set of contact points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionSubstep {
    /// Length, seconds.
    pub dt: f32,
    /// Number of solver substeps in it; see [`SolverSettings::substeps_per_collision_substep`].
    pub substeps: u32,
    /// Acceleration of bodies, m/s^2.
    pub gravity: Vec3,
}

impl CollisionSubstep {
    /// One of the `count` collision substeps of a step.
    pub fn of(config: &StepConfig, count: u32) -> Self {
        Self {
            dt: config.per_collision_substep(count).dt,
            substeps: config.solver.substeps_per_collision_substep(count),
            gravity: config.gravity,
        }
    }

    /// The pace of a body that passes through this collision substep like all others.
    pub fn pace(&self) -> Pace {
        Pace {
            dt: self.dt,
            substeps: self.substeps.max(1),
        }
    }
}

/// Solves contacts and moves bodies. It holds only scratch memory, so one solver can serve several worlds in turn.
#[derive(Clone, Debug, Default)]
pub struct Solver {
    constraints: Constraints,
    /// Mobility and pace of each body.
    mobility: Vec<Mobility>,
    paces: Vec<Pace>,
    /// State of the static bodies since which none of them has come or gone.
    base: Revision,
    /// The saved impulses are built here.
    saved: WarmStart,
}

impl Solver {
    /// Moves `bodies` over one collision substep, on rayon's current thread pool, outside of a pool on the
    /// calling thread.
    ///
    /// `manifolds` are the contact points at its start. `warm` has the impulses of the last collision substep and
    /// receives those of this one; an empty one is valid, but bodies at rest sink a little. Impulses in
    /// [`SolverBodies::forces`] are applied and cleared.
    ///
    /// Invalid input is ignored: pairs that do not name two different bodies, and points with numbers that are not
    /// finite or with normals that are not of unit length. Bodies whose motion is not finite do not move. Nothing moves
    /// if the collision substep has no length.
    pub fn solve(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        warm: &mut WarmStart,
        settings: &SolverSettings,
        collision_substep: &CollisionSubstep,
    ) {
        let pace = collision_substep.pace();
        if pace.is_done() {
            return;
        }
        self.solve_each(bodies, manifolds, warm, settings, collision_substep.gravity, |_| pace);
    }

    /// [`Solver::solve`] with a pace for each body. A body that has completed its step keeps its pose, and contacts
    /// between two such bodies are not solved: they keep their impulses.
    pub fn solve_each(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        warm: &mut WarmStart,
        settings: &SolverSettings,
        gravity: Vec3,
        pace_of: impl Fn(usize) -> Pace,
    ) {
        let Self {
            constraints,
            mobility,
            paces,
            base,
            saved,
        } = self;
        let is_valid = |pace: &Pace| pace.dt >= 0.0 && pace.dt.is_finite();
        if !(bodies.movers().all(|i| is_valid(&pace_of(i))) && gravity.is_finite()) {
            return;
        }
        let same = if base.is(bodies.base()) {
            bodies.static_count()
        } else {
            0
        };
        paces.truncate(same);
        paces.resize(bodies.len(), Pace::DONE);
        mobility.truncate(same);
        mobility.resize(bodies.len(), Mobility::Fixed);
        *base = bodies.base();
        for i in bodies.movers() {
            paces[i] = pace_of(i);
            mobility[i] = motion::mobility(bodies, i, paces[i]);
        }
        constraints.begin(bodies, mobility, paces, manifolds, warm);
        let source = Source {
            bodies,
            mobility,
            paces,
            manifolds,
            warm,
            settings,
            gravity,
        };
        constraints.for_each_bundle(|islands, members, bundle| bundle.run(&source, islands, members));
        saved.save(warm, constraints, bodies);
        std::mem::swap(warm, saved);
        constraints.write_back(bodies, mobility);
    }

    /// The total normal impulse of point `index` of the last call's [`Manifolds::points`] over the collision substep,
    /// newton seconds; 0 if there is no such point.
    pub fn impulse_of(&self, index: usize) -> f32 {
        self.constraints.impulse_of(index)
    }

    /// Whether that point applied an impulse in the last call or, if both bodies sleep, when they fell asleep.
    pub(crate) fn pushes(&self, index: usize) -> bool {
        self.constraints.pushes(index)
    }
}
