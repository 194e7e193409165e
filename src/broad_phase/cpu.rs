//! BroadPhase on the CPU.

mod counting_sort;
pub(super) mod grid;

use crate::state::Bodies;
use crate::types::body::RigidBody;
use counting_sort::CountingSort;
use grid::{Grid, Level};
use rayon::prelude::*;
use std::ops::Range;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    /// Bodies that are not static.
    moving: Grid,
    /// The others. It stays as it is while they do.
    still: Grid,
    members: Vec<u32>,
    found: Vec<Finder>,
    unsorted: Vec<[u32; 2]>,
    firsts: Vec<u32>,
    sort: CountingSort,
}

/// How often static bodies are sorted at most until the size of their cells suits them: it is done once.
const SETTLE: usize = 12;

/// Bodies per task.
const TASK: usize = 512;

/// Writes the pairs of bodies that may collide and whose spheres overlap, as far as bodies reach, into `sphere_pairs`: `a < b`,
/// ascending.
pub(crate) fn run(bodies: &Bodies, scratch: &mut Scratch, sphere_pairs: &mut Vec<[u32; 2]>) {
    let Scratch {
        moving,
        still,
        members,
        found,
        unsorted,
        firsts,
        sort,
    } = scratch;
    let Bodies {
        center, reach, kind, ..
    } = bodies;
    let is_still = |i: usize| kind[i] == RigidBody::Static;
    let all = 0..kind.len() as u32;
    members.clear();
    members.extend(all.clone().filter(|&i| !is_still(i as usize)));
    moving.fill(members, center, reach);
    if moving.is_overfull() {
        moving.fill(members, center, reach);
    }
    if !still.holds(kind.len() - members.len(), is_still, center, reach) {
        members.clear();
        members.extend(all.filter(|&i| is_still(i as usize)));
        for _ in 0..SETTLE {
            if !still.fill(members, center, reach) {
                break;
            }
        }
    }

    let (moving, still) = (&*moving, &*still);
    let tasks = moving.ids.len().div_ceil(TASK);
    let still_tasks = still.ids.len().div_ceil(TASK);
    if found.len() < tasks + still_tasks {
        found.resize_with(tasks + still_tasks, Finder::default);
    }
    let found = &mut found[..tasks + still_tasks];
    found.par_iter_mut().enumerate().for_each(|(task, finder)| {
        let range = |task: usize, grid: &Grid| task * TASK..((task + 1) * TASK).min(grid.ids.len());
        finder.found.clear();
        if task < tasks {
            finder.of_moving(moving, still, range(task, moving), bodies);
        } else {
            finder.of_still(still, moving, range(task - tasks, still), bodies);
        }
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
    /// Finds all pairs of the moving bodies in `range`, in the grid's order, with moving bodies of coarser levels; with those
    /// of their own level that come later; and with static ones that are no finer.
    fn of_moving(&mut self, moving: &Grid, still: &Grid, range: Range<usize>, bodies: &Bodies) {
        for (at, own) in moving.levels.iter().enumerate() {
            let some = own.part_of(&range);
            if some.is_empty() {
                continue;
            }
            if own.is_sparse {
                // Each pair once: by the one that comes first.
                self.reach([moving, moving], own, some.clone(), bodies, |i| i + 1);
            } else {
                self.own_level(moving, own, some.clone(), bodies);
            }
            for level in &moving.levels[at + 1..] {
                self.reach([moving, moving], level, some.clone(), bodies, |_| 0);
            }
            for level in still.levels.iter().filter(|level| level.number >= own.number) {
                self.reach([moving, still], level, some.clone(), bodies, |_| 0);
            }
        }
    }

    /// Finds all pairs of the static bodies in `range` with moving ones of coarser levels. Two static bodies never collide.
    fn of_still(&mut self, still: &Grid, moving: &Grid, range: Range<usize>, bodies: &Bodies) {
        for own in &still.levels {
            let some = own.part_of(&range);
            if some.is_empty() {
                continue;
            }
            for level in moving.levels.iter().filter(|level| level.number > own.number) {
                self.reach([still, moving], level, some.clone(), bodies, |_| 0);
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
            let mut found = |j: usize| add([grid.ids[i], grid.ids[j]], bodies, &mut self.found);
            grid.overlaps(sphere, i + 1..end, &mut found);
            for run in &self.runs {
                grid.overlaps(sphere, run.clone(), &mut found);
            }
        }
    }

    /// Each body of the first grid looks into the cells that it reaches on a level of the second, for those from `first` on.
    fn reach(
        &mut self,
        [own, other]: [&Grid; 2],
        level: &Level,
        range: Range<usize>,
        bodies: &Bodies,
        first: impl Fn(usize) -> usize,
    ) {
        let mut reach = None;
        for i in range {
            let sphere = own.sphere(i);
            let now = level.reach(sphere);
            if reach.replace(now) != Some(now) {
                self.runs.clear();
                other.rows(level, now, &mut self.runs);
            }
            for run in &self.runs {
                other.overlaps(sphere, run.start.max(first(i))..run.end, |j| {
                    add([own.ids[i], other.ids[j]], bodies, &mut self.found);
                });
            }
        }
    }
}

fn add([a, b]: [u32; 2], bodies: &Bodies, found: &mut Vec<[u32; 2]>) {
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
