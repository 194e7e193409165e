//! Contact generation on the CPU: pairs run in parallel; each task writes its own lists, which are joined in order.

pub(super) mod arrival;
mod candidates;
pub(super) mod contour;
mod crossing;
mod deepest;
mod eight;
pub(super) mod feature;
mod feature_bits;
mod feature_finder;
mod feature_ids;
mod inside;
mod kept;
mod kept_pairs;
mod moved;
mod near;
mod near_box_pairs;
mod near_clusters;
pub(super) mod near_features;
mod near_lanes;
pub(super) mod nearest;
pub(super) mod pair;
mod placed_cluster;
pub mod planes;
pub(super) mod precision;
mod ray;
pub(super) mod reduce;
mod resting;
pub(super) mod rim;
mod search;
pub(super) mod side;
mod small_triangle;
pub(super) mod smooth;
mod thin;

pub(super) use arrival::PairMotion;
pub(crate) use feature::Feature;
pub(crate) use feature_ids::feature_ids;
pub(crate) use kept::Kept;
pub(super) use moved::Reuse;
pub(crate) use pair::{Pair, PairPoint, Worker};
pub(super) use resting::Rest;

use super::MarginPair;
use crate::parallel::loops;
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, ManifoldPoint, Manifolds, PlacedMesh};
use kept_pairs::KeptPairs;
use rayon::prelude::*;
use resting::RestingPair;

/// Memory kept between steps.
#[derive(Default)]
pub struct Scratch {
    tasks: Vec<Task>,
    workers: PerThread<Worker>,
    kept: KeptPairs,
    searches: usize,
}

impl Scratch {
    /// Forgets what pairs keep from the last call. The next call finds the same points, but searches all of them
    /// afresh.
    pub fn forget(&mut self) {
        self.kept = KeptPairs::default();
    }

    /// Returns memory, except what pairs keep.
    pub(super) fn renew(&mut self) {
        (self.tasks, self.workers) = Default::default();
        self.kept.shrink();
    }

    /// Number of searches for features in the last call. A pair at rest has none.
    pub(super) fn searches(&self) -> usize {
        self.searches
    }

    /// Whether any pair of the last call is so large that it is worth more than one thread.
    pub(crate) fn has_large_pair(&self) -> bool {
        self.kept.has_large_pair()
    }

    /// Whether what a pair keeps proves that no faces intersect now and that neither body contains the other. Always
    /// `false` for bodies that touch.
    pub(super) fn is_apart(&self, bodies: &Bodies, meshes: &MeshArena, pair: [u32; 2]) -> bool {
        let kept = self.kept.get(pair).filter(|kept| kept.was_apart);
        kept.is_some_and(|kept| pair_of_bodies(bodies, meshes, pair).is_some_and(|pair| kept.is_apart(&pair)))
    }

    /// Sets the new indices of bodies since the last call. Pairs without new indices are gone. This saves work and
    /// changes no result. The order of the pairs must stay the same.
    pub(crate) fn renumber(&mut self, renumbered: impl Fn([u32; 2]) -> Option<[u32; 2]>) {
        self.kept.renumber(renumbered);
    }
}

/// The results of a task.
#[derive(Default)]
struct Task {
    manifolds: Manifolds,
    dropped: Vec<[u32; 2]>,
    searches: usize,
}

/// Pairs per task: small enough to balance the load, large enough to keep the scratch memory in cache.
const TASK: usize = 16;

/// Writes the manifolds of `pairs`, in their order, into `manifolds`; pairs without points have none. Runs on rayon's
/// current thread pool, outside of a pool on the calling thread. The same input gives the same bits, whatever the
/// number of threads.
///
/// `pairs` must hold every pair whose surfaces may overlap or be closer than its margin, each once, ascending. The
/// earlier stages must use the same margin: the broad phase with radii enlarged by half of the largest margin of each
/// body's pairs, and Angles with a limit of minus the margin on the overlap. A pair of invalid indices has no points. A
/// margin that is negative or NaN counts as 0.
pub fn run(
    bodies: &Bodies,
    meshes: &MeshArena,
    pairs: &[MarginPair],
    scratch: &mut Scratch,
    manifolds: &mut Manifolds,
) {
    let request = |&pair| PairRequest {
        pair,
        reuse: None,
        motion: None,
        rest: None,
    };
    let pairs: Vec<PairRequest> = pairs.iter().map(request).collect();
    run_some(bodies, meshes, &pairs, |_| false, scratch, manifolds, &mut Vec::new());
}

/// A pair whose contact points are wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairRequest {
    /// The margin is that within which points are found.
    pub pair: MarginPair,
    /// When points of the same step will do; `None` if they are always found anew.
    pub reuse: Option<Reuse>,
    /// How the bodies move; `None` if all points count.
    pub motion: Option<PairMotion>,
    /// How little they move; `None` if they are always searched where they are.
    pub rest: Option<Rest>,
}

/// Like [`run`], but pairs may reuse points or move. Pairs that are left out keep their candidates for later calls if
/// `waits` says so. Lists in `dropped` the pairs some of whose points were dropped because the bodies fly past each
/// other there.
pub(super) fn run_some(
    bodies: &Bodies,
    meshes: &MeshArena,
    pairs: &[PairRequest],
    waits: impl Fn([u32; 2]) -> bool,
    scratch: &mut Scratch,
    manifolds: &mut Manifolds,
    dropped: &mut Vec<[u32; 2]>,
) {
    let task_count = pairs.len().div_ceil(TASK);
    if scratch.tasks.len() < task_count {
        scratch.tasks.resize_with(task_count, Task::default);
    }
    let Scratch {
        tasks,
        workers,
        kept,
        searches,
    } = scratch;
    let (tasks, workers) = (&mut tasks[..task_count], workers.ready());
    // A single task shares out its large pairs.
    let threads = if task_count == 1 { loops::threads() } else { 1 };
    let numbers = pairs.iter().map(|request| request.pair.bodies);
    let kept = kept.of(numbers, waits).par_chunks_mut(TASK);
    let parts = tasks.par_iter_mut().zip(pairs.par_chunks(TASK)).zip(kept);
    loops::for_each(parts, 1, |((task, pairs), kept)| {
        let Task {
            manifolds,
            dropped,
            searches,
        } = task;
        manifolds.clear();
        dropped.clear();
        let mut worker = workers.lock();
        worker.searches = 0;
        for (request, kept) in pairs.iter().zip(kept) {
            let first = manifolds.points.len();
            let (kept, points) = (&mut kept.kept, &mut manifolds.points);
            if !add_points(bodies, meshes, request, &mut worker, kept, threads, points) {
                dropped.push(request.pair.bodies);
            }
            manifolds.end_pair(request.pair.bodies, first);
        }
        *searches = worker.searches;
    });
    manifolds.clear();
    dropped.clear();
    *searches = tasks.iter().map(|task| task.searches).sum();
    for task in tasks.iter() {
        for pair in &task.manifolds.pairs {
            let first = manifolds.points.len();
            manifolds.points.extend_from_slice(task.manifolds.points_of(pair));
            manifolds.end_pair(pair.bodies, first);
        }
        dropped.extend_from_slice(&task.dropped);
    }
}

/// The manifold of one pair, without memory between calls.
pub fn of_pair(bodies: &Bodies, meshes: &MeshArena, pair: MarginPair) -> Manifolds {
    let mut manifolds = Manifolds::default();
    let (mut worker, mut kept) = (Worker::default(), Kept::default());
    let request = PairRequest {
        pair,
        reuse: None,
        motion: None,
        rest: None,
    };
    add_points(
        bodies,
        meshes,
        &request,
        &mut worker,
        &mut kept,
        1,
        &mut manifolds.points,
    );
    manifolds.end_pair(pair.bodies, 0);
    manifolds
}

/// Appends the contact points of a pair, if both bodies exist. Tells whether these are all: none was dropped.
fn add_points(
    bodies: &Bodies,
    meshes: &MeshArena,
    request: &PairRequest,
    worker: &mut Worker,
    kept: &mut Kept,
    threads: usize,
    points: &mut Vec<ManifoldPoint>,
) -> bool {
    let MarginPair {
        bodies: numbers,
        margin,
    } = request.pair;
    let Some(placed) = placed_bodies(bodies, meshes, numbers) else {
        return true;
    };
    let pair = Pair::new(placed.each_ref());
    let is_done = |reuse: &Reuse| kept.points.move_to(&pair, bodies, numbers, reuse, points);
    if request.reuse.as_ref().is_some_and(is_done) {
        return true;
    }
    let first = points.len();
    let is_at_rest = request.rest.as_ref().is_some_and(|rest| {
        let resting = RestingPair {
            pair: &pair,
            placed: placed.each_ref(),
            margin,
            rest,
            motion: request.motion.as_ref(),
        };
        resting.find(worker, kept, threads)
    });
    let (chosen, dropped) = if is_at_rest {
        (&worker.resting[..], false)
    } else {
        match &request.motion {
            Some(motion) => worker.reduced_in_motion(&pair, margin, motion, kept, threads),
            None => (worker.reduced(&pair, margin, kept, threads), false),
        }
    };
    let offsets = numbers.map(|i| bodies.frame[i as usize].offset().as_vec3());
    let [a, b] = numbers.map(|i| bodies.angular_velocity[i as usize].as_dvec3());
    pair.add_points(chosen, b - a, |point| points.push(point.shifted(offsets)));
    if let Some(reuse) = &request.reuse {
        kept.points
            .set(&pair, bodies, numbers, margin, reuse.step, &points[first..]);
    }
    !dropped
}

/// The pair of two bodies; `None` if the indices name none.
fn pair_of_bodies<'a>(bodies: &'a Bodies, meshes: &'a MeshArena, pair: [u32; 2]) -> Option<Pair<'a>> {
    Some(Pair::new(placed_bodies(bodies, meshes, pair)?.each_ref()))
}

/// The two placed bodies; `None` if the indices name no pair of bodies.
fn placed_bodies<'a>(bodies: &'a Bodies, meshes: &'a MeshArena, pair: [u32; 2]) -> Option<[PlacedMesh<'a>; 2]> {
    let has_mesh = |i: u32| {
        bodies
            .mesh
            .get(i as usize)
            .is_some_and(|&mesh| meshes.get(mesh).is_some())
    };
    (pair[0] != pair[1] && pair.into_iter().all(has_mesh)).then(|| pair.map(|i| PlacedMesh::of(bodies, meshes, i)))
}
