//! BroadPhase on the CPU.

mod counting_sort;
mod grid;

use crate::components::RigidBody;
use crate::stages::state::{Bodies, StepState};
use counting_sort::CountingSort;
use grid::{Grid, Level};
use rayon::prelude::*;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    grid: Grid,
    /// For each level, who is there, and who on coarser ones.
    populations: Vec<Population>,
    found: Vec<Vec<[u32; 2]>>,
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
        populations,
        found,
        unsorted,
        firsts,
        sort,
    } = grid_scratch;
    grid.fill(&bodies.center, &bodies.radius);
    count(grid, bodies, populations);

    let grid = &*grid;
    let tasks = grid.ids.len().div_ceil(TASK);
    found.truncate(tasks);
    found.resize_with(tasks, Vec::new);
    found.par_iter_mut().enumerate().for_each(|(task, found)| {
        found.clear();
        let first = task * TASK;
        let end = (first + TASK).min(grid.ids.len());
        let mut number = grid.levels.partition_point(|level| level.end as usize <= first);
        for i in first..end {
            if i == grid.levels[number].end as usize {
                number += 1;
            }
            let looks = populations[number].looks(bodies.kind[grid.ids[i] as usize]);
            if looks.own {
                find(grid, &grid.levels[number], i, looks.back, bodies, found);
            }
            if looks.coarser {
                for level in &grid.levels[number + 1..] {
                    find(grid, level, i, true, bodies, found);
                }
            }
        }
    });

    // The one order that depends on nothing but the bodies.
    unsorted.clear();
    for found in &*found {
        unsorted.extend_from_slice(found);
    }
    firsts.clear();
    firsts.extend(unsorted.iter().map(|pair| pair[0]));
    sort.sort(bodies.center.len(), firsts);
    sphere_pairs.clear();
    sphere_pairs.par_extend(sort.order().with_min_len(TASK).map(|at| unsorted[at as usize]));
    let runs = sphere_pairs.par_chunk_by_mut(|p, q| p[0] == q[0]);
    runs.for_each(|run| run.sort_unstable());
}

/// Who is on a level, and on the coarser ones.
#[derive(Clone, Copy, Default)]
struct Population {
    still: bool,
    moving: bool,
    coarser_moving: bool,
}

/// Where a body looks for others.
struct Looks {
    /// On its own level.
    own: bool,
    /// There also in what comes before it in the grid's order.
    back: bool,
    /// On coarser levels.
    coarser: bool,
}

impl Population {
    /// Two static bodies never collide: only the moving one of two looks, if there is but one.
    fn looks(self, kind: RigidBody) -> Looks {
        if kind == RigidBody::Static {
            Looks {
                own: false,
                back: false,
                coarser: self.coarser_moving,
            }
        } else {
            Looks {
                own: true,
                back: self.still,
                coarser: true,
            }
        }
    }
}

fn count(grid: &Grid, bodies: &Bodies, populations: &mut Vec<Population>) {
    populations.clear();
    let mut coarser_moving = false;
    for level in grid.levels.iter().rev() {
        let ids = &grid.ids[level.first as usize..level.end as usize];
        let is_still = |id: &u32| bodies.kind[*id as usize] == RigidBody::Static;
        let population = Population {
            still: ids.iter().any(is_still),
            moving: !ids.iter().all(is_still),
            coarser_moving,
        };
        coarser_moving |= population.moving;
        populations.push(population);
    }
    populations.reverse();
}

/// Finds the bodies of a level that overlap body `i`, in the grid's order. Of two that may find each other the first does;
/// with `back` this one finds also those before it that cannot find it.
#[inline(always)]
fn find(grid: &Grid, level: &Level, i: usize, back: bool, bodies: &Bodies, found: &mut Vec<[u32; 2]>) {
    let sphere = grid.spheres[i];
    let [x, y, z, radius] = sphere;
    let same = (level.first as usize..level.end as usize).contains(&i);
    grid.visit(level, level.reach(sphere), |mut run| {
        if !back {
            run.start = run.start.max(i + 1);
        }
        for j in run {
            let [p, q, r, other] = grid.spheres[j];
            let [dx, dy, dz] = [x - p, y - q, z - r];
            let reach = radius + other;
            if dx * dx + dy * dy + dz * dz <= reach * reach * (1.0 + 1.0e-6) {
                let found_by_it = same && j <= i && bodies.kind[grid.ids[j] as usize] != RigidBody::Static;
                let [a, b] = [grid.ids[i], grid.ids[j]];
                let pair = [a.min(b), a.max(b)];
                if !found_by_it && may_collide(bodies, pair) {
                    found.push(pair);
                }
            }
        }
    });
}

fn may_collide(bodies: &Bodies, [a, b]: [u32; 2]) -> bool {
    let (a, b) = (a as usize, b as usize);
    let either = |kind| bodies.kind[a] == kind || bodies.kind[b] == kind;
    let sensor = bodies.sensor[a] || bodies.sensor[b];
    let moved = either(RigidBody::Dynamic) || (sensor && either(RigidBody::Kinematic));
    moved && bodies.layers[a].interacts_with(bodies.layers[b])
}
