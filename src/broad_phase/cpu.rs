//! BroadPhase on the CPU: a grid of moving bodies, one of static bodies and one of dormant ones, searched in parallel.

mod counting_sort;
pub(super) mod grid;
mod wide;

pub(crate) use grid::SPHERE_SLACK;
pub(crate) use wide::WideSearch;

use crate::parallel::loops;
use crate::state::Bodies;
use crate::state::crowd::Crowd;
use crate::state::revision::Revision;
use crate::types::body::RigidBody;
use counting_sort::CountingSort;
use grid::{Grid, Level};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    /// Dynamic and kinematic bodies.
    moving_grid: Grid,
    /// Static bodies. Rebuilt only when one of them changes.
    static_grid: Grid,
    /// The state of the static bodies in their grid, and the margin of their radii.
    in_grid: (Revision, Option<f32>),
    /// Static bodies that have changed since the grid of static bodies was filled, in the state with this name.
    loose_grid: Grid,
    in_loose_grid: (Revision, Option<f32>),
    /// Dormant bodies. Some may have been roused since it was filled.
    dormant_grid: Grid,
    /// The set with which the dormant grid was filled.
    in_dormant_grid: Revision,
    members: Vec<u32>,
    found: Vec<Finder>,
    unsorted: Vec<[u32; 2]>,
    firsts: Vec<u32>,
    sort: CountingSort,
}

/// Maximum number of times that static bodies are sorted until the cell sizes suit them. This happens only when they
/// change.
const MAX_STATIC_FILLS: usize = 12;

/// Bodies per task.
const TASK: usize = 512;

/// Bodies per pair above which sorting by comparison takes less time than counting.
const BODIES_PER_PAIR: usize = 16;

/// A body searches several levels of two grids. In a crowd about this many of these searches end early.
const SEARCHES: usize = 4;

/// Writes the pairs of bodies that may collide and whose speculative spheres overlap into `sphere_pairs`: `a < b`,
/// ascending. If there are more than `limit`, all searches of bodies are capped at the same number of pairs, which is
/// within a factor of two of what the limit allows. Returns the bodies that lose pairs.
pub(crate) fn run(bodies: &Bodies, limit: usize, scratch: &mut Scratch, sphere_pairs: &mut Vec<[u32; 2]>) -> Crowd {
    let Scratch {
        moving_grid,
        static_grid,
        in_grid,
        loose_grid,
        in_loose_grid,
        dormant_grid,
        in_dormant_grid,
        members,
        found,
        unsorted,
        firsts,
        sort,
    } = scratch;
    let Bodies {
        center,
        speculative_radius,
        kind,
        ..
    } = bodies;
    let is_static = |i: usize| kind[i] == RigidBody::Static;
    let all = 0..kind.len() as u32;
    members.clear();
    // Huge saved impulses or forces may give a body a position that is not finite within this step. It has no pairs,
    // and the next step rejects it.
    let is_sound = |i: usize| center[i].is_finite() && speculative_radius[i].is_finite();
    members.extend(bodies.movers().filter(|&i| is_sound(i)).map(|i| i as u32));
    moving_grid.fill(members, center, speculative_radius);
    if moving_grid.is_overfull() {
        moving_grid.fill(members, center, speculative_radius);
    }
    let changes = &bodies.static_changes;
    let is_known = in_grid.0.is(changes.base) && in_grid.1 == bodies.static_margin;
    *in_grid = (changes.base, bodies.static_margin);
    let count = kind.len() - bodies.dormant.count - bodies.movers().count() - changes.loose.len();
    let is_firm = |i: usize| is_static(i) && !changes.is_loose(i as u32);
    if !is_known && !static_grid.holds(count, is_firm, center, speculative_radius) {
        members.clear();
        members.extend(all.clone().filter(|&i| is_firm(i as usize)));
        fill_still(static_grid, members, bodies);
    }
    if !in_loose_grid.0.is(bodies.revision) || in_loose_grid.1 != bodies.static_margin {
        *in_loose_grid = (bodies.revision, bodies.static_margin);
        fill_still(loose_grid, &changes.loose, bodies);
    }
    if !bodies.dormant.filled.is(*in_dormant_grid) {
        *in_dormant_grid = bodies.dormant.filled;
        members.clear();
        members.extend(bodies.dormant.members());
        fill_still(dormant_grid, members, bodies);
    }

    let within_limit = |per_search| MostPairs {
        in_all: limit,
        per_search,
    };
    let grids = [&*moving_grid, &*static_grid, &*loose_grid, &*dormant_grid];
    if search(bodies, grids, found, within_limit(usize::MAX)) > limit {
        if bodies.dormant.count > 0 {
            // The caller searches again without dormant bodies.
            sphere_pairs.clear();
            return Crowd::of(vec![0]);
        }
        // The full set of pairs is the same in any order of the grids. Searches that end early depend on the order.
        for (grid, wants_static) in [(&mut *moving_grid, false), (&mut *static_grid, true)] {
            if wants_static && grid.is_canonical() {
                continue;
            }
            members.clear();
            let is_member = |&i: &u32| is_static(i as usize) == wants_static && (wants_static || is_sound(i as usize));
            members.extend(all.clone().filter(is_member));
            grid.fill_canonically(members, center, speculative_radius);
        }
        // All static bodies are in one grid now.
        *in_grid = Default::default();
        *in_loose_grid = Default::default();
        fill_still(loose_grid, &[], bodies);
        let grids = [&*moving_grid, &*static_grid, &*loose_grid, &*dormant_grid];
        let mut search = |most| search(bodies, grids, found, most);
        let mut per_search = (limit / (SEARCHES * bodies.center.len())).max(1);
        // Bodies outside the crowd have few partners, and lose none of them once this is more.
        while search(within_limit(2 * per_search)) <= limit {
            per_search *= 2;
        }
        search(MostPairs {
            in_all: usize::MAX,
            per_search,
        });
    }

    // Ascending order, so that the result does not depend on the grid or on the threads.
    unsorted.clear();
    let mut crowded = Vec::new();
    for finder in found {
        unsorted.extend_from_slice(&finder.found);
        crowded.extend_from_slice(&finder.crowded);
    }
    if unsorted.len() * BODIES_PER_PAIR <= bodies.center.len() {
        unsorted.sort_unstable();
        std::mem::swap(sphere_pairs, unsorted);
        return Crowd::of(crowded);
    }
    firsts.clear();
    firsts.extend(unsorted.iter().map(|pair| pair[0]));
    sort.sort(bodies.center.len(), firsts);
    loops::collect(sort.order().map(|at| unsorted[at as usize]), TASK, sphere_pairs);
    loops::sort_runs(sphere_pairs, |pair| pair[0]);
    Crowd::of(crowded)
}

/// Fills a grid with bodies that do not move, until its cell sizes suit them.
fn fill_still(grid: &mut Grid, members: &[u32], bodies: &Bodies) {
    if members.is_empty() && grid.ids.is_empty() {
        return;
    }
    for _ in 0..MAX_STATIC_FILLS {
        if !grid.fill(members, &bodies.center, &bodies.speculative_radius) {
            break;
        }
    }
}

/// Whether the moving bodies of a level search a level of others that do not move. If not, these search the moving
/// ones.
///
/// Bodies search their own and coarser levels, of which their spheres overlap few cells. A few moving bodies among many
/// finer ones search these too: one fast body must not make each static one search.
fn moving_ones_search(moving: &Level, still: &Level, most: MostPairs) -> bool {
    if still.number >= moving.number {
        return true;
    }
    let has_limit = most.per_search < usize::MAX;
    !has_limit && moving.cost_of_searching(still) <= still.cost_of_searching(moving)
}

/// Number of tasks in which bodies that do not move search for moving ones.
fn still_tasks(still: &Grid, moving: &Grid, most: MostPairs) -> usize {
    let searches = |level: &Level| {
        moving
            .levels
            .iter()
            .any(|other| !moving_ones_search(other, level, most))
    };
    match still.levels.iter().any(searches) {
        true => still.ids.len().div_ceil(TASK),
        false => 0,
    }
}

/// Searches the grids of moving, of static, of changed static and of dormant bodies, and returns the number of pairs,
/// or a number above the limit.
fn search(
    bodies: &Bodies,
    [moving, fixed, loose, dormant]: [&Grid; 4],
    found: &mut Vec<Finder>,
    most: MostPairs,
) -> usize {
    let tasks = moving.ids.len().div_ceil(TASK);
    let tasks_of = [fixed, loose, dormant].map(|still| still_tasks(still, moving, most));
    let all_tasks = tasks + tasks_of.iter().sum::<usize>();
    if found.len() < all_tasks {
        found.resize_with(all_tasks, Finder::default);
    }
    let (found, unused) = found.split_at_mut(all_tasks);
    unused.iter_mut().for_each(|finder| finder.begin(most));
    // If all static bodies are in their grid, the grid of loose ones is empty.
    let all_fixed = loose.ids.is_empty();
    let is_fixed = |i: u32| all_fixed || !bodies.static_changes.is_loose(i);
    let is_dormant = |i: u32| bodies.dormant.has(i as usize);
    let any = |_: u32| true;
    // Two bodies that do not move never collide.
    let still: [(&Grid, &(dyn Fn(u32) -> bool + Sync)); 3] =
        [(fixed, &is_fixed), (loose, &any), (dormant, &is_dormant)];
    let total = AtomicUsize::new(0);
    loops::for_each(found.par_iter_mut().enumerate(), 1, |(task, finder)| {
        let range = |task: usize, grid: &Grid| task * TASK..((task + 1) * TASK).min(grid.ids.len());
        finder.begin(most);
        if total.load(Ordering::Relaxed) > most.in_all {
            return;
        }
        if task < tasks {
            let own = range(task, moving);
            finder.moving_pairs(moving, own.clone(), bodies);
            for (still, counts) in still {
                finder.pairs_between(
                    [moving, still],
                    own.clone(),
                    bodies,
                    |own, other| moving_ones_search(own, other, most),
                    |[_, i]| counts(i),
                );
            }
            total.fetch_add(finder.found.len(), Ordering::Relaxed);
            return;
        }
        let mut task = task - tasks;
        for ((still, counts), own_tasks) in still.into_iter().zip(tasks_of) {
            if task < own_tasks {
                let own = range(task, still);
                finder.pairs_between(
                    [still, moving],
                    own,
                    bodies,
                    |own, other| !moving_ones_search(other, own, most),
                    |[i, _]| counts(i),
                );
                break;
            }
            task -= own_tasks;
        }
        total.fetch_add(finder.found.len(), Ordering::Relaxed);
    });
    total.into_inner()
}

/// Where a search for pairs ends early.
#[derive(Clone, Copy)]
struct MostPairs {
    /// Most pairs of all bodies. With one more the search is given up.
    in_all: usize,
    /// Most pairs that one search of one body finds.
    per_search: usize,
}

impl Default for MostPairs {
    /// No limits.
    fn default() -> Self {
        Self {
            in_all: usize::MAX,
            per_search: usize::MAX,
        }
    }
}

/// Finds the pairs of a range of bodies.
#[derive(Default)]
struct Finder {
    found: Vec<[u32; 2]>,
    runs: Vec<Range<usize>>,
    most: MostPairs,
    /// The bodies that lost a pair, because their search ended early.
    crowded: Vec<u32>,
}

impl Finder {
    fn begin(&mut self, most: MostPairs) {
        self.found.clear();
        self.crowded.clear();
        self.most = most;
    }

    /// The number of pairs at which the search of the next body ends.
    fn end_of_search(&self) -> usize {
        let MostPairs { in_all, per_search } = self.most;
        self.found
            .len()
            .saturating_add(per_search)
            .min(in_all.saturating_add(1))
    }

    /// Whether the task has found more than all may find.
    fn is_full(&self) -> bool {
        self.found.len() > self.most.in_all
    }

    /// Finds the pairs of the moving bodies in `range`, in grid order, with moving bodies of coarser levels, and with
    /// later ones of their own level.
    fn moving_pairs(&mut self, moving_grid: &Grid, range: Range<usize>, bodies: &Bodies) {
        for (at, own) in moving_grid.levels.iter().enumerate() {
            let some = own.part_of(&range);
            if some.is_empty() {
                continue;
            }
            if own.is_coarsened {
                // Each pair is found once, from its first body.
                self.search_level([moving_grid; 2], own, some.clone(), bodies, |i| i + 1, |_| true);
            } else {
                self.own_level(moving_grid, own, some.clone(), bodies);
            }
            for level in &moving_grid.levels[at + 1..] {
                self.search_level([moving_grid; 2], level, some.clone(), bodies, |_| 0, |_| true);
            }
        }
    }

    /// Finds the pairs that `counts` admits, between bodies of the first grid in `range` and bodies of the second grid
    /// in levels that `searches` allows. It gets both levels.
    fn pairs_between(
        &mut self,
        [own_grid, other]: [&Grid; 2],
        range: Range<usize>,
        bodies: &Bodies,
        searches: impl Fn(&Level, &Level) -> bool,
        counts: impl Fn([u32; 2]) -> bool,
    ) {
        for own in &own_grid.levels {
            let some = own.part_of(&range);
            if some.is_empty() {
                continue;
            }
            for level in other.levels.iter().filter(|level| searches(own, level)) {
                self.search_level([own_grid, other], level, some.clone(), bodies, |_| 0, &counts);
            }
        }
    }

    fn own_level(&mut self, grid: &Grid, level: &Level, range: Range<usize>, bodies: &Bodies) {
        let (mut cell, mut end) = (None, 0);
        for i in range {
            let own = grid.cell(level, i);
            if cell.replace(own) != Some(own) {
                end = grid.later_neighbors(level, own, &mut self.runs);
            }
            let sphere = grid.sphere(i);
            let end_of_search = self.end_of_search();
            let (found, crowded) = (&mut self.found, &mut self.crowded);
            let mut add = |j: usize| add([grid.ids[i], grid.ids[j]], bodies, end_of_search, found, crowded);
            grid.overlaps(sphere, i + 1..end, &mut add);
            for run in &self.runs {
                grid.overlaps(sphere, run.clone(), &mut add);
            }
            if self.is_full() {
                return;
            }
        }
    }

    /// Tests each body of the first grid against the bodies from `first` on in the cells of a level of the second that
    /// its sphere may overlap, where the pair `counts`.
    fn search_level(
        &mut self,
        [own, other]: [&Grid; 2],
        level: &Level,
        range: Range<usize>,
        bodies: &Bodies,
        first: impl Fn(usize) -> usize,
        counts: impl Fn([u32; 2]) -> bool,
    ) {
        let mut cells = None;
        for i in range {
            let sphere = own.sphere(i);
            let wanted = level.cells_overlapping(sphere);
            if cells.replace(wanted) != Some(wanted) {
                self.runs.clear();
                other.rows(level, wanted, &mut self.runs);
                let [low, high] = wanted;
                // Cells that are far from each other may share a bucket.
                if (0..3).any(|axis| high[axis] - low[axis] > 1) {
                    join_overlapping(&mut self.runs);
                }
            }
            let end = self.end_of_search();
            let (found, crowded) = (&mut self.found, &mut self.crowded);
            for run in &self.runs {
                other.overlaps(sphere, run.start.max(first(i))..run.end, |j| {
                    let pair = [own.ids[i], other.ids[j]];
                    !counts(pair) || add(pair, bodies, end, found, crowded)
                });
            }
            if self.is_full() {
                return;
            }
        }
    }
}

/// Sorts runs, and joins those that overlap.
fn join_overlapping(runs: &mut Vec<Range<usize>>) {
    runs.sort_unstable_by_key(|run| run.start);
    runs.dedup_by(|next, last| {
        let overlap = next.start <= last.end;
        if overlap {
            last.end = last.end.max(next.end);
        }
        overlap
    });
}

/// Adds a pair to `found` if it may collide. If there are already `end` pairs, its first body is added to `crowded`
/// instead. Returns whether the search goes on.
fn add([a, b]: [u32; 2], bodies: &Bodies, end: usize, found: &mut Vec<[u32; 2]>, crowded: &mut Vec<u32>) -> bool {
    let pair = [a.min(b), a.max(b)];
    if !may_collide(bodies, pair) {
        return true;
    }
    if found.len() < end {
        found.push(pair);
        true
    } else {
        crowded.push(a);
        false
    }
}

fn may_collide(bodies: &Bodies, [a, b]: [u32; 2]) -> bool {
    let is_one_body = bodies.body_of(a) == bodies.body_of(b);
    let (a, b) = (a as usize, b as usize);
    let either = |kind| bodies.kind[a] == kind || bodies.kind[b] == kind;
    let sensor = bodies.sensor[a] || bodies.sensor[b];
    let moved = either(RigidBody::Dynamic) || (sensor && either(RigidBody::Kinematic));
    moved && !is_one_body && bodies.layers[a].interacts_with(bodies.layers[b])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A grid of spheres of this radius, 3 m from each other.
    fn spheres(count: u32, radius: f32) -> Grid {
        let members: Vec<u32> = (0..count).collect();
        let at = |&i: &u32| 3.0 * Vec3::new((i % 100) as f32, 0.0, (i / 100) as f32);
        let centers: Vec<Vec3> = members.iter().map(at).collect();
        let mut grid = Grid::default();
        grid.fill(&members, &centers, &vec![radius; members.len()]);
        grid
    }

    #[test]
    fn few_large_moving_bodies_search_for_many_small_ones_at_rest() {
        let (one, many) = (spheres(1, 20.0), spheres(10_000, 1.0));
        assert_eq!(still_tasks(&many, &one, MostPairs::default()), 0);
        let limited = MostPairs {
            in_all: 100,
            per_search: 1,
        };
        assert!(still_tasks(&many, &one, limited) > 0);
        // Beside as many large ones each small one looks at fewer cells.
        let (large, few) = (spheres(10_000, 20.0), spheres(100, 1.0));
        assert!(still_tasks(&few, &large, MostPairs::default()) > 0);
        assert_eq!(still_tasks(&large, &few, MostPairs::default()), 0);
    }
}
