//! All contact constraints of a collision substep in flat lists, and the parallel loop over them.

use super::bodies::SolverBodies;
use super::contact::{Impulse, Pair, Point};
use super::motion::BodyStates;
use super::prepare::Source;
use super::restitution;
use super::solve::{self, Pass};
use super::warm_start::WarmStart;
use crate::state::Manifolds;
use crate::types::solver_settings::SolverSettings;

/// Largest number of pairs per task.
const GRAIN: usize = 128;

/// All constraints of a collision substep.
#[derive(Clone, Debug, Default)]
pub(super) struct Constraints {
    pairs: Vec<Pair>,
    points: Vec<Point>,
    /// The impulses of each pair on its two bodies in the last pass.
    impulses: Vec<[Impulse; 2]>,
}

impl Constraints {
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    pub fn points(&self) -> &[Point] {
        &self.points
    }

    pub fn impulses(&self) -> &[[Impulse; 2]] {
        &self.impulses
    }

    /// The total normal impulse of a point over the collision substep.
    pub fn impulse_of(&self, index: usize) -> f32 {
        self.points.get(index).map_or(0.0, |p| {
            p.total_normal_impulse + p.normal_impulse + p.restitution_impulse
        })
    }

    /// Whether a point has an impulse. Points of frozen pairs have the impulse of their last solved substep.
    pub fn pushes(&self, index: usize) -> bool {
        let point = self.points.get(index);
        point.is_some_and(|p| {
            p.normal_impulse > 0.0 || p.total_normal_impulse + p.normal_impulse + p.restitution_impulse > 0.0
        })
    }

    /// Makes a constraint for every manifold, and warm starts it.
    pub fn prepare(
        &mut self,
        bodies: &SolverBodies,
        states: &BodyStates,
        manifolds: &Manifolds,
        warm: &WarmStart,
        settings: &SolverSettings,
        h: f32,
        dt: f32,
    ) {
        self.pairs.clear();
        self.points.clear();
        self.impulses.clear();
        for manifold in &manifolds.pairs {
            // Points keep their indices. A manifold whose range overlaps an earlier one or exceeds the list gets no
            // points.
            let range = manifold.first_point as u64..manifold.first_point as u64 + manifold.point_count as u64;
            let fits = range.start >= self.points.len() as u64 && range.end <= manifolds.points.len() as u64;
            if fits {
                self.points.resize(range.end as usize, Point::NONE);
            }
            self.pairs.push(Pair {
                bodies: manifold.bodies,
                first: if fits {
                    manifold.first_point
                } else {
                    self.points.len() as u32
                },
                count: if fits { manifold.point_count } else { 0 },
                ..Pair::default()
            });
        }
        self.impulses.resize(self.pairs.len(), [Impulse::default(); 2]);
        let source = Source {
            bodies,
            states,
            manifolds,
            warm,
            settings,
            impulse_scale: warm.impulse_scale(h),
            dt,
        };
        self.for_each(|pair, points, _| source.fill(pair, points));
    }

    pub fn begin_substep(&mut self, states: &BodyStates, pass: &Pass) {
        self.for_each(|pair, points, out| *out = solve::begin_substep(pair, points, states, pass));
    }

    pub fn solve(&mut self, states: &BodyStates, pass: &Pass) {
        self.for_each(|pair, points, out| *out = solve::solve(pair, points, states, pass));
    }

    pub fn update_points(&mut self, states: &BodyStates) {
        self.for_each(|pair, points, _| solve::update_points(pair, points, states));
    }

    /// Makes only the pairs active that need restitution, and returns whether there are any.
    pub fn begin_restitution(&mut self, threshold: f32) -> bool {
        self.for_each(|pair, points, _| restitution::begin_restitution(pair, points, threshold));
        self.pairs.iter().any(|pair| pair.active)
    }

    pub fn apply_restitution(&mut self, states: &BodyStates) {
        self.for_each(|pair, points, out| *out = restitution::apply_restitution(pair, points, states));
    }

    /// Calls `f` with every pair, its points and its impulses, in parallel.
    fn for_each(&mut self, f: impl Fn(&mut Pair, &mut [Point], &mut [Impulse; 2]) + Sync) {
        halve(&mut self.pairs, &mut self.points, 0, &mut self.impulses, &f);
    }
}

/// Splits the pairs in half until they are few enough for one task. `first` is the number of the first of `points`.
fn halve<F: Fn(&mut Pair, &mut [Point], &mut [Impulse; 2]) + Sync>(
    pairs: &mut [Pair],
    points: &mut [Point],
    first: usize,
    impulses: &mut [[Impulse; 2]],
    f: &F,
) {
    if pairs.len() <= GRAIN {
        for (pair, out) in pairs.iter_mut().zip(impulses) {
            let start = pair.first as usize - first;
            let points = &mut points[start..start + pair.count as usize];
            f(pair, points, out);
        }
        return;
    }
    let middle = pairs.len() / 2;
    let split = pairs[middle].first as usize;
    let (pairs, more_pairs) = pairs.split_at_mut(middle);
    let (points, more_points) = points.split_at_mut(split - first);
    let (impulses, more_impulses) = impulses.split_at_mut(middle);
    rayon::join(
        || halve(pairs, points, first, impulses, f),
        || halve(more_pairs, more_points, split, more_impulses, f),
    );
}
