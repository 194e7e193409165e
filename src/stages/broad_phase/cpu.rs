//! BroadPhase on the CPU.

mod counting_sort;
mod grid;

use crate::components::RigidBody;
use crate::stages::state::{Bodies, StepState};
use counting_sort::CountingSort;
use grid::{Grid, Level};
use rayon::prelude::*;
use std::ops::Range;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    grid: Grid,
    found: Vec<Finder>,
    unsorted: Vec<[u32; 2]>,
    firsts: Vec<u32>,
    sort: CountingSort,
}

/// Bodies per task.
const TASK: usize = 512;

/// Fills `state.sphere_pairs`.
pub fn run(state: &mut StepState) {
    let StepState {
        bodies,
        sphere_pairs,
        grid_scratch,
        ..
    } = state;
    let Scratch {
        grid,
        found,
        unsorted,
        firsts,
        sort,
    } = grid_scratch;
    grid.fill(&bodies.center, &bodies.radius, &bodies.kind);

    let grid = &*grid;
    let tasks = grid.ids.len().div_ceil(TASK);
    if found.len() < tasks {
        found.resize_with(tasks, Finder::default);
    }
    let found = &mut found[..tasks];
    found.par_iter_mut().enumerate().for_each(|(task, finder)| {
        let first = task * TASK;
        finder.run(grid, first..(first + TASK).min(grid.ids.len()), bodies);
    });

    // The one order that depends on nothing but the bodies.
    unsorted.clear();
    for finder in found {
        unsorted.extend_from_slice(&finder.found);
    }
    firsts.clear();
    firsts.extend(unsorted.iter().map(|pair| pair[0]));
    sort.sort(bodies.center.len(), firsts);
    sphere_pairs.clear();
    sphere_pairs.par_extend(sort.order().with_min_len(TASK).map(|at| unsorted[at as usize]));
    let runs = sphere_pairs.par_chunk_by_mut(|p, q| p[0] == q[0]);
    runs.for_each(|run| run.sort_unstable());
}

/// Finds the pairs of some bodies.
#[derive(Default)]
struct Finder {
    found: Vec<[u32; 2]>,
    runs: Vec<Range<usize>>,
}

impl Finder {
    /// Finds all pairs of the bodies in `range`, in the grid's order, with bodies of coarser levels; with those of their own
    /// level that come later; and, if they move, with static ones of their size. Two static bodies never collide.
    fn run(&mut self, grid: &Grid, range: Range<usize>, bodies: &Bodies) {
        self.found.clear();
        for (number, own) in grid.levels.iter().enumerate() {
            let some = range.start.max(own.first as usize)..range.end.min(own.end as usize);
            if some.is_empty() {
                continue;
            }
            if !own.still {
                self.own_level(grid, own, some.clone(), bodies);
            }
            // The static ones of the same size come next.
            for level in &grid.levels[number + 1..] {
                if !(own.still && level.still) {
                    self.other_level(grid, level, some.clone(), bodies);
                }
            }
        }
    }

    fn own_level(&mut self, grid: &Grid, level: &Level, range: Range<usize>, bodies: &Bodies) {
        let (mut cell, mut end) = (None, 0);
        for i in range {
            let own = grid.cell(level, i);
            if cell.replace(own) != Some(own) {
                end = grid.later(level, own, &mut self.runs);
            }
            let sphere = grid.sphere(i);
            let mut found = |j| add(grid, [i, j], bodies, &mut self.found);
            grid.overlaps(sphere, i + 1..end, &mut found);
            for run in &self.runs {
                grid.overlaps(sphere, run.clone(), &mut found);
            }
        }
    }

    fn other_level(&mut self, grid: &Grid, level: &Level, range: Range<usize>, bodies: &Bodies) {
        let mut reach = None;
        for i in range {
            let sphere = grid.sphere(i);
            let now = level.reach(sphere);
            if reach.replace(now) != Some(now) {
                self.runs.clear();
                grid.rows(level, now, &mut self.runs);
            }
            for run in &self.runs {
                grid.overlaps(sphere, run.clone(), |j| add(grid, [i, j], bodies, &mut self.found));
            }
        }
    }
}

fn add(grid: &Grid, pair: [usize; 2], bodies: &Bodies, found: &mut Vec<[u32; 2]>) {
    let [a, b] = pair.map(|i| grid.ids[i]);
    let pair = [a.min(b), a.max(b)];
    if may_collide(bodies, pair) {
        found.push(pair);
    }
}

fn may_collide(bodies: &Bodies, [a, b]: [u32; 2]) -> bool {
    let (a, b) = (a as usize, b as usize);
    let either = |kind| bodies.kind[a] == kind || bodies.kind[b] == kind;
    let sensor = bodies.sensor[a] || bodies.sensor[b];
    let moved = either(RigidBody::Dynamic) || (sensor && either(RigidBody::Kinematic));
    moved && bodies.layers[a].interacts_with(bodies.layers[b])
}
