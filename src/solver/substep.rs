//! A collision substep of one island: its substeps, and the passes of each.
//!
//! A pass of projected Gauss-Seidel visits all pairs. Its impulses are extrapolated along a search direction, as in the
//! method of conjugate gradients (Silcowitz-Hansen et al., "A Nonsmooth Nonlinear Conjugate Gradient Method for
//! Interactive Contact Force Problems", 2010). A tower of ten cubes needs a quarter of the passes then.

use super::batch::{Batch, Batches, PointLanes};
use super::constraints::IslandsMut;
use super::load;
use super::motion::StatesMut;
use super::pace::Pace;
use super::pass::Pass;
use super::points::update_points;
use super::prepare::Source;
use super::restitution;
use super::solve::{self, Residual};
use crate::simd::lanes::{Select, Simd, lanes, load as load_lanes, splat, store};
use crate::simd::level::with_simd;
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
        for (pair, points) in self.pairs_with_points() {
            source.fill(pair, points, common);
        }
        self.load_batches();
        with_simd!(simd => self.update_points(simd));
        let factor = load::substep_factor(self, source, common);
        if factor > 1 {
            pace = common.refined(factor);
            self.load_bodies(source, members, pace);
        }
        let pass = Pass::new(settings, pace.h());
        with_simd!(simd => {
            self.scale_impulses(simd, 1.0 / factor as f32);
            for _ in 0..pace.substeps {
                self.substep(simd, &pass, settings);
            }
            // The saved impulses are those of a substep of the common length.
            self.scale_impulses(simd, factor as f32);
        });
        self.store_batches();
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

    #[inline(always)]
    fn update_points<S: Simd>(&mut self, simd: S) {
        for (batch, points) in Batches::new(self.batches, self.lanes) {
            update_points(simd, batch, points, &self.states);
        }
    }

    /// Multiplies all impulses, for substeps of another length. The totals of the collision substep stay.
    #[inline(always)]
    fn scale_impulses<S: Simd>(&mut self, simd: S, factor: f32) {
        if factor == 1.0 {
            return;
        }
        let factor = splat(simd, factor);
        for point in self.lanes.iter_mut() {
            let before = load_lanes(simd, &point.normal_impulse);
            let impulse = factor * before;
            let total = load_lanes(simd, &point.total_normal_impulse);
            point.total_normal_impulse = store(total + (before - impulse));
            point.normal_impulse = store(impulse);
            for impulse in &mut point.friction_impulse {
                *impulse = store(factor * load_lanes(simd, impulse));
            }
        }
    }

    #[inline(always)]
    fn substep<S: Simd>(&mut self, simd: S, pass: &Pass, settings: &SolverSettings) {
        self.states.integrate_velocities();
        self.states.initial_velocities.copy_from_slice(self.states.velocities);
        for (batch, points) in Batches::new(self.batches, self.lanes) {
            solve::begin_substep(simd, batch, points, self.states.initial_velocities, pass);
        }
        for (batch, points) in Batches::new(self.batches, self.lanes) {
            solve::apply_impulses(simd, batch, points, self.states.velocities, splat(simd, 1.0));
        }
        self.solve(simd, pass, settings.bias_iterations, settings);
        self.states.integrate_poses();
        let pass = pass.relaxing();
        for (batch, points) in Batches::new(self.batches, self.lanes) {
            move_impulses(simd, batch, points, &mut self.states);
            pass.aim(simd, batch, points);
        }
        self.solve(simd, &pass, settings.relax_iterations, settings);
        self.apply_restitution(simd, &pass, settings);
    }

    /// Passes over all pairs, at least so many, until they have converged.
    #[inline(always)]
    fn solve<S: Simd>(&mut self, simd: S, pass: &Pass, least: u32, settings: &SolverSettings) {
        let most = settings
            .max_iterations
            .min((PASS_BUDGET / self.points.len()) as u32)
            .max(least);
        let mut last_energy = 0.0;
        for iteration in 1..=most {
            let mut residual = Residual::new(simd);
            for (batch, points) in Batches::new(self.batches, self.lanes) {
                solve::solve(simd, batch, points, self.states.velocities, pass, &mut residual);
            }
            if iteration == most || (iteration >= least && residual.has_converged()) {
                break;
            }
            // The first direction has no predecessor, and one that leads away is dropped.
            let energy = residual.energy();
            let keep = if energy < last_energy {
                energy / last_energy
            } else {
                0.0
            };
            for (batch, points) in Batches::new(self.batches, self.lanes) {
                solve::extrapolate(simd, batch, points, self.states.velocities, keep);
            }
            last_energy = energy;
        }
    }

    #[inline(always)]
    fn apply_restitution<S: Simd>(&mut self, simd: S, pass: &Pass, settings: &SolverSettings) {
        let mut fastest = 0.0f32;
        for (batch, points) in Batches::new(self.batches, self.lanes) {
            let before = &*self.states.initial_velocities;
            let speed = restitution::find_impacts(simd, batch, points, before, settings.restitution_threshold);
            fastest = fastest.max(speed);
        }
        if fastest > 0.0 {
            let pass = pass.with_restitution(restitution::TOLERANCE * fastest);
            for (batch, points) in Batches::new(self.batches, self.lanes) {
                pass.aim(simd, batch, points);
            }
            self.solve(simd, &pass, settings.restitution_iterations, settings);
            restitution::end_impacts(simd, self.lanes);
        }
    }
}

/// Updates the points of a batch after its bodies have moved.
///
/// An elastic body that meets an immovable one keeps its energy: its impulses move with the points. Between two bodies
/// they stay where they acted, which keeps the angular momentum.
#[inline(always)]
fn move_impulses<S: Simd>(simd: S, batch: &Batch, points: &mut [PointLanes], states: &mut StatesMut) {
    let moves = batch.bounces_off != 0;
    let [zero, one] = [splat(simd, 0.0), splat(simd, 1.0)];
    let factor = lanes(simd, batch.bounces_off).select(one, zero);
    if moves {
        solve::apply_impulses(simd, batch, points, states.velocities, -factor);
    }
    update_points(simd, batch, points, states);
    if moves {
        solve::apply_impulses(simd, batch, points, states.velocities, factor);
    }
}
