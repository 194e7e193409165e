//! A collision substep of a bundle: its substeps, and the passes of each.
//!
//! Islands side by side are independent: each has its own number of substeps and of passes, and the lane of a converged
//! island keeps its impulses while others go on. So an island moves with the same bits in any bundle.
//!
//! A pass of projected Gauss-Seidel visits all pairs. Its impulses are extrapolated along a search direction, as in the
//! method of conjugate gradients (Silcowitz-Hansen et al., "A Nonsmooth Nonlinear Conjugate Gradient Method for
//! Interactive Contact Force Problems", 2010). A tower of ten cubes needs a quarter of the passes then.

use super::batch::{Batch, Batches, PointLanes, load_batches, store_batches};
use super::colors::{ALL_LANES, LANES};
use super::constraints::BundlesMut;
use super::direct::{Direct, DirectIslands};
use super::group::Group;
use super::islands::Island;
use super::load;
use super::motion::StatesMut;
use super::pace::Pace;
use super::pass::Pass;
use super::points::update_points;
use super::prepare::Source;
use super::restitution;
use super::softness::{FEW_PASSES, Softness};
use super::solve::{self, Residual};
use crate::simd::lanes::{Select, Simd, SimdBase, bitmask, bits, f32x8, lanes, load as load_lanes, splat, store};
use crate::simd::level::with_simd;
use crate::types::solver_settings::SolverSettings;

/// Points times passes of an island in one part of a substep. An island of more points than that over the iterations
/// gets fewer passes: a pile needs less than a tower, and must not stop the game.
pub(super) const PASS_BUDGET: u32 = 2000;

impl BundlesMut<'_> {
    /// Makes the constraints of one bundle and moves its bodies over the collision substep. `members` are the bodies of
    /// its slots.
    pub fn run(&mut self, source: &Source, islands: &[Island], members: &[u32]) {
        let all = Group::all(islands);
        let pace = islands[0].pace;
        self.load_bodies(source, members, &all, pace);
        if self.pairs.is_empty() {
            for _ in 0..pace.substeps {
                self.integrate_velocities(&all);
                self.integrate_poses(&all);
            }
            self.limit_speeds(&all);
            return;
        }
        source.fill_all(self.pairs, self.points, pace);
        self.load_constraints(&all);
        let point_counts = self.point_counts(&all);
        let mut direct = DirectIslands::default();
        let factors = load::hold(self, &all, &point_counts, source, pace, &mut direct);
        let mut rest = all;
        while !rest.is_empty() {
            let group;
            (group, rest) = rest.split(&factors);
            let factor = factors[group.first()];
            if factor > 1 {
                self.load_bodies(source, members, &group, pace.refined(factor));
            }
            if !group.is_whole() {
                self.load_constraints(&group);
            }
            let passes = Passes::new(source.settings, &group, &point_counts);
            let h = pace.refined(factor).h();
            let pass = Pass::new(source.settings, h, passes.softness(h));
            with_simd!(simd => {
                self.scale_impulses(simd, 1.0 / factor as f32);
                for _ in 0..pace.refined(factor).substeps {
                    self.substep(simd, &group, &pass, &passes, &mut direct);
                }
                // The saved impulses belong to a substep of the common length.
                self.scale_impulses(simd, factor as f32);
            });
            store_batches(self.batches, self.lanes, self.pairs, self.points, group.lanes());
            self.limit_speeds(&group);
        }
    }

    /// Loads the bodies of a group with this pace. A body with another one moves in as many substeps.
    fn load_bodies(&mut self, source: &Source, members: &[u32], group: &Group, pace: Pace) {
        for slot in group.slots().flatten() {
            let body = members[slot] as usize;
            let mobility = source.mobility[body];
            let h = source.paces[body].dt / pace.substeps as f32;
            self.states.load(slot, source.bodies, body, mobility, source.gravity, h);
        }
    }

    /// Loads the pairs of a group.
    pub(super) fn load_constraints(&mut self, group: &Group) {
        let masses = &*self.states.masses;
        load_batches(self.batches, self.lanes, self.pairs, self.points, masses, group.lanes());
        with_simd!(simd => self.update_points(simd));
    }

    /// The number of points of each island of the bundle.
    fn point_counts(&self, group: &Group) -> [u32; LANES] {
        let mut counts = [0; LANES];
        let mut pairs = self.pairs.iter();
        for batch in &*self.batches {
            for (lane, pair) in pairs.by_ref().take(batch.pairs).enumerate() {
                counts[group.island(lane)] += pair.count;
            }
        }
        counts
    }

    fn integrate_velocities(&mut self, group: &Group) {
        group.slots().for_each(|slots| self.states.integrate_velocities(slots));
    }

    fn integrate_poses(&mut self, group: &Group) {
        group.slots().for_each(|slots| self.states.integrate_poses(slots));
    }

    fn limit_speeds(&mut self, group: &Group) {
        group.slots().for_each(|slots| self.states.limit_speeds(slots));
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
        for point in Batches::new(self.batches, self.lanes).flat_map(|(_, points)| points) {
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
    fn substep<S: Simd>(&mut self, simd: S, group: &Group, pass: &Pass, passes: &Passes, direct: &mut DirectIslands) {
        self.integrate_velocities(group);
        self.states.initial_velocities.copy_from_slice(self.states.velocities);
        for (batch, points) in Batches::new(self.batches, self.lanes) {
            solve::begin_substep(simd, batch, points, self.states.initial_velocities, pass);
            solve::apply_impulses(simd, batch, points, self.states.velocities, splat(simd, 1.0));
        }
        let settings = passes.settings;
        let unconverged = self.solve(simd, pass, passes, settings.bias_iterations, ALL_LANES, false, direct);
        self.integrate_poses(group);
        let pass = pass.relaxing();
        let impulses_move = unconverged != 0 || self.batches.iter().any(|batch| batch.bounces_off != 0);
        if impulses_move {
            for (batch, points) in Batches::new(self.batches, self.lanes) {
                move_impulses(simd, batch, points, &mut self.states, unconverged);
                pass.aim(simd, batch, points);
            }
        }
        self.solve(
            simd,
            &pass,
            passes,
            settings.relax_iterations,
            ALL_LANES,
            !impulses_move,
            direct,
        );
        self.apply_restitution(simd, &pass, passes, direct);
    }

    /// Passes over all pairs of the islands in the lanes `live` until they have converged, at least `least` passes.
    /// Returns the lanes with pairs of islands whose passes have not.
    ///
    /// If the points have to move with their bodies before, the first pass moves those of each batch: in a large island
    /// they would not be in the cache any more.
    #[inline(always)]
    fn solve<S: Simd>(
        &mut self,
        simd: S,
        pass: &Pass,
        passes: &Passes,
        least: u32,
        mut live: u32,
        moves: bool,
        direct: &mut DirectIslands,
    ) -> u32 {
        let zero = splat(simd, 0.0);
        let mut last_energy = zero;
        let mut unconverged = 0;
        for iteration in 1.. {
            let live_lanes = lanes(simd, live);
            let mut residual = Residual::zero(simd);
            for (batch, points) in Batches::new(self.batches, self.lanes) {
                if moves && iteration == 1 {
                    update_points(simd, batch, points, &self.states);
                    pass.aim(simd, batch, points);
                }
                let own = solve::solve(simd, batch, points, self.states.velocities, pass, live_lanes);
                if passes.side_by_side {
                    residual.add(own);
                } else {
                    residual.add_pairs(own, batch.pairs);
                }
            }
            let converged = residual.converged();
            let ended = passes.ended(iteration, least, converged);
            let given_up = live & ended & !converged;
            if given_up != 0 {
                self.solve_directly(passes, given_up, residual.far(), direct);
                unconverged |= if passes.side_by_side { given_up } else { ALL_LANES };
            }
            live &= !ended;
            if live == 0 {
                break;
            }
            // The first direction has no predecessor, and one that leads away is dropped.
            let energy = residual.energy;
            let keep = energy.simd_lt(last_energy).select(energy / last_energy, zero);
            last_energy = energy;
            if bitmask(keep.simd_gt(zero)) & live == 0 {
                if !passes.are_last(iteration + 1, least, live) {
                    solve::begin_search(self.lanes);
                }
                continue;
            }
            let live_lanes = lanes(simd, live);
            for (batch, points) in Batches::new(self.batches, self.lanes) {
                solve::extrapolate(simd, batch, points, self.states.velocities, live_lanes, keep);
            }
        }
        unconverged
    }

    /// Solves the islands of some lanes directly, if they are solved so: their passes have not converged. Those of the
    /// lanes `far` are far from it.
    fn solve_directly(&mut self, passes: &Passes, wanted: u32, far: u32, direct: &mut DirectIslands) {
        let far = passes.islands(far);
        for number in bits(passes.islands(wanted)) {
            if far >> number & 1 == 0 && !direct.is_loaded(number) {
                continue;
            }
            let lane = passes.side_by_side.then_some(number);
            if let Some(island) = direct.get(number, || Direct::new(self.batches, &self.states, lane, false)) {
                island.solve(self.batches, self.lanes, &mut self.states);
            }
        }
    }

    #[inline(always)]
    fn apply_restitution<S: Simd>(&mut self, simd: S, pass: &Pass, passes: &Passes, direct: &mut DirectIslands) {
        let mut fastest = splat(simd, 0.0);
        for (batch, points) in Batches::new(self.batches, self.lanes) {
            let before = &*self.states.initial_velocities;
            let speed = restitution::find_impacts(simd, batch, points, before, passes.settings.restitution_threshold);
            fastest = speed.max(fastest);
        }
        let fastest = passes.of_island(fastest);
        let live = bitmask(fastest.simd_gt(splat(simd, 0.0)));
        if live != 0 {
            let pass = pass.with_restitution(store(splat(simd, restitution::TOLERANCE) * fastest));
            for (batch, points) in Batches::new(self.batches, self.lanes) {
                pass.aim(simd, batch, points);
            }
            self.solve(
                simd,
                &pass,
                passes,
                passes.settings.restitution_iterations,
                live,
                false,
                direct,
            );
            for (_, points) in Batches::new(self.batches, self.lanes) {
                restitution::end_impacts(simd, points);
            }
        }
    }
}

/// When the passes over the islands of a group end.
struct Passes<'a> {
    settings: &'a SolverSettings,
    /// Whether each lane has pairs of another island.
    side_by_side: bool,
    /// The largest number of passes over the island in each lane.
    most: [u32; LANES],
}

impl<'a> Passes<'a> {
    /// `point_counts` are the numbers of points of the bundle's islands.
    fn new(settings: &'a SolverSettings, group: &Group, point_counts: &[u32; LANES]) -> Self {
        let most = |lane| {
            let points = point_counts[group.island(lane)].max(1);
            settings.max_iterations.min(PASS_BUDGET / points)
        };
        Self {
            settings,
            side_by_side: group.is_side_by_side(),
            most: std::array::from_fn(most),
        }
    }

    /// The contact springs for substeps of `h` seconds. Islands side by side have so few points that none of them gets
    /// few passes, unless the settings allow few.
    fn softness(&self, h: f32) -> Softness {
        if self.most[0] < FEW_PASSES {
            Softness::of_few_passes(self.settings, h)
        } else {
            Softness::new(self.settings, h)
        }
    }

    /// The lanes whose islands need no pass after this one, if `converged` are those whose pairs have converged.
    #[inline(always)]
    fn ended(&self, iteration: u32, least: u32, converged: u32) -> u32 {
        let converged = if iteration < least {
            0
        } else if self.side_by_side || converged == ALL_LANES {
            converged
        } else {
            0
        };
        bits(ALL_LANES & !converged)
            .filter(|&lane| iteration >= self.most[lane].max(least))
            .fold(converged, |ended, lane| ended | 1 << lane)
    }

    /// Whether the passes over the islands in the lanes `live` end with this one.
    fn are_last(&self, iteration: u32, least: u32, live: u32) -> bool {
        bits(live).all(|lane| iteration >= self.most[lane].max(least))
    }

    /// The numbers of the islands that have pairs in these lanes.
    fn islands(&self, lanes: u32) -> u32 {
        if self.side_by_side {
            lanes
        } else {
            u32::from(lanes != 0)
        }
    }

    /// In each lane the largest number of its island.
    #[inline(always)]
    fn of_island<S: Simd>(&self, largest: f32x8<S>) -> f32x8<S> {
        if self.side_by_side {
            return largest;
        }
        let of_all = largest.to_array().into_iter().fold(0.0, f32::max);
        splat(largest.simd, of_all)
    }
}

/// Updates the points of a batch after its bodies have moved.
///
/// Impulses stay where they acted, which keeps the angular momentum, or move with the points, which keeps the energy.
/// An elastic body that meets an immovable one keeps its energy. So does an island in the lanes `unconverged`: its
/// impulses can be large and cancel each other, as in a taut chain, and would push it along if some of them had other
/// directions.
#[inline(always)]
fn move_impulses<S: Simd>(simd: S, batch: &Batch, points: &mut [PointLanes], states: &mut StatesMut, unconverged: u32) {
    let moving = batch.bounces_off | unconverged;
    let [zero, one] = [splat(simd, 0.0), splat(simd, 1.0)];
    let factor = lanes(simd, moving).select(one, zero);
    if moving != 0 {
        solve::apply_impulses(simd, batch, points, states.velocities, -factor);
    }
    update_points(simd, batch, points, states);
    if moving != 0 {
        solve::apply_impulses(simd, batch, points, states.velocities, factor);
    }
}
