//! A collision substep of one island: its substeps, and the passes of each.
//!
//! A pass of projected Gauss-Seidel visits all pairs. Its impulses are extrapolated along a search direction, as in the
//! method of conjugate gradients (Silcowitz-Hansen et al., "A Nonsmooth Nonlinear Conjugate Gradient Method for
//! Interactive Contact Force Problems", 2010). A tower of ten cubes needs a quarter of the passes then.

use super::constraints::IslandsMut;
use super::contact::{Pair, Point};
use super::load;
use super::motion::StatesMut;
use super::pace::Pace;
use super::prepare::Source;
use super::restitution;
use super::solve::{self, Pass, Residual};
use crate::types::solver_settings::SolverSettings;

/// Points times passes of an island in one part of a substep. An island of more points than that over the iterations
/// gets fewer passes: a pile needs less than a tower, and must not stop the game.
pub(super) const PASS_BUDGET: usize = 2000;

impl IslandsMut<'_> {
    /// Makes the constraints of an island and moves its bodies over the collision substep. `members` are the bodies of
    /// its slots.
    pub fn run(&mut self, source: &Source, members: &[u32]) {
        let settings = source.settings;
        let paces = members.iter().map(|&body| source.paces[body as usize]);
        let common = paces.fold(Pace::DONE, Pace::and);
        let mut pace = common;
        self.load_bodies(source, members, pace);
        if self.pairs.is_empty() {
            for _ in 0..pace.substeps {
                self.states.integrate_velocities();
                self.states.integrate_poses();
            }
            self.states.limit_speeds();
            return;
        }
        self.for_each_pair(|pair, points, states| {
            source.fill(pair, points, common);
            solve::update_points(pair, points, states);
        });
        let factor = load::substep_factor(self, source, common);
        if factor > 1 {
            pace = common.refined(factor);
            self.load_bodies(source, members, pace);
            self.points
                .iter_mut()
                .for_each(|point| point.scale_impulses(1.0 / factor as f32));
        }
        let pass = Pass::new(settings, pace.h());
        for _ in 0..pace.substeps {
            self.substep(&pass, settings);
        }
        // The saved impulses are those of a substep of the common length.
        self.points
            .iter_mut()
            .for_each(|point| point.scale_impulses(factor as f32));
        self.states.limit_speeds();
    }

    /// Loads the bodies of an island with this pace. A body with another one moves in as many substeps.
    fn load_bodies(&mut self, source: &Source, members: &[u32], pace: Pace) {
        for (slot, &body) in members.iter().enumerate() {
            let mobility = source.mobility[body as usize];
            let h = source.paces[body as usize].dt / pace.substeps as f32;
            self.states
                .load(slot, source.bodies, body as usize, mobility, source.gravity, h);
        }
    }

    fn substep(&mut self, pass: &Pass, settings: &SolverSettings) {
        self.states.integrate_velocities();
        self.for_each_pair(|pair, points, states| solve::begin_substep(pair, points, states, pass));
        self.states.initial_velocities.copy_from_slice(self.states.velocities);
        self.for_each_pair(|pair, points, states| solve::apply_impulses(pair, points, states, 1.0));
        self.solve(pass, settings.bias_iterations, settings);
        self.states.integrate_poses();
        self.for_each_pair(move_impulses);
        let pass = pass.relaxing();
        self.solve(&pass, settings.relax_iterations, settings);
        self.apply_restitution(&pass, settings);
    }

    /// Passes over all pairs, at least so many, until they have converged.
    fn solve(&mut self, pass: &Pass, least: u32, settings: &SolverSettings) {
        let most = settings
            .max_iterations
            .min((PASS_BUDGET / self.points.len()) as u32)
            .max(least);
        let mut last_energy = 0.0;
        for iteration in 1..=most {
            let mut residual = Residual::default();
            self.for_each_pair(|pair, points, states| solve::solve(pair, points, states, pass, &mut residual));
            if iteration == most || (iteration >= least && residual.has_converged()) {
                break;
            }
            // The first direction has no predecessor, and one that leads away is dropped.
            let keep = if residual.energy < last_energy {
                residual.energy / last_energy
            } else {
                0.0
            };
            self.for_each_pair(|pair, points, states| solve::extrapolate(pair, points, states, keep));
            last_energy = residual.energy;
        }
    }

    fn apply_restitution(&mut self, pass: &Pass, settings: &SolverSettings) {
        let mut fastest = 0.0f32;
        self.for_each_pair(|pair, points, states| {
            let speed = restitution::find_impacts(pair, points, states, settings.restitution_threshold);
            fastest = fastest.max(speed);
        });
        if fastest > 0.0 {
            let pass = pass.with_restitution(restitution::TOLERANCE * fastest);
            self.solve(&pass, settings.restitution_iterations, settings);
            self.for_each_pair(|pair, points, _| restitution::end_impacts(pair, points));
        }
    }
}

/// Updates the points of a pair after its bodies have moved.
///
/// An elastic body that meets an immovable one keeps its energy: its impulses move with the points. Between two bodies
/// they stay where they acted, which keeps the angular momentum.
fn move_impulses(pair: &mut Pair, points: &mut [Point], states: &mut StatesMut) {
    let is_immovable = |slot: u32| states.masses[slot as usize].is_immovable();
    let moves = pair.restitution > 0.0 && pair.slots.into_iter().any(is_immovable);
    if moves {
        solve::apply_impulses(pair, points, states, -1.0);
    }
    solve::update_points(pair, points, states);
    if moves {
        solve::apply_impulses(pair, points, states, 1.0);
    }
}
