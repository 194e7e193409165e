//! Contact generation on the CPU: pairs in parallel, each task writing lists of its own that are joined in order.

mod contour;
mod feature;
mod inside;
mod near;
mod pair;
pub mod planes;
mod ray;
mod reduce;
mod side;
mod smooth;

use super::MarginPair;
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Manifolds};
use pair::Worker;
use rayon::prelude::*;

/// Memory kept between steps.
#[derive(Default)]
pub struct Scratch {
    /// One per task.
    tasks: Vec<Manifolds>,
    workers: PerThread<Worker>,
}

/// Pairs per task: small enough to balance, large enough to keep a thread's memory warm.
const TASK: usize = 16;

/// Finds the contact points of `pairs` on rayon's current thread pool, and writes those of pairs that have any into
/// `manifolds`, in the order of `pairs`. The same input gives the same bits, however many threads there are.
///
/// `pairs` must hold every pair whose surfaces may be nearer than its margin or overlap, each once, ascending. Stages that
/// find them must look as far as the margin: the broad phase with radii grown by half of the largest margin of each body's
/// pairs, and Angles with heights that overlap by no less than minus the margin. A pair of numbers that name no two bodies
/// has no points; a margin that is negative or not a number is none.
pub fn run(
    bodies: &Bodies,
    meshes: &MeshArena,
    pairs: &[MarginPair],
    scratch: &mut Scratch,
    manifolds: &mut Manifolds,
) {
    let wanted = pairs.len().div_ceil(TASK);
    if scratch.tasks.len() < wanted {
        scratch.tasks.resize_with(wanted, Manifolds::default);
    }
    let Scratch { tasks, workers } = scratch;
    let (tasks, workers) = (&mut tasks[..wanted], workers.ready());
    tasks
        .par_iter_mut()
        .zip(pairs.par_chunks(TASK))
        .for_each(|(task, pairs)| {
            task.clear();
            let mut worker = workers.lock();
            for pair in pairs {
                let first = task.points.len();
                worker.run(bodies, meshes, pair, &mut task.points);
                task.close(pair.bodies, first);
            }
        });
    manifolds.clear();
    for task in tasks.iter() {
        for pair in &task.pairs {
            let first = manifolds.points.len();
            manifolds.points.extend_from_slice(task.points_of(pair));
            manifolds.close(pair.bodies, first);
        }
    }
}

/// The contact points of one pair, without memory between calls.
pub fn of_pair(bodies: &Bodies, meshes: &MeshArena, pair: MarginPair) -> Manifolds {
    let mut manifolds = Manifolds::default();
    Worker::default().run(bodies, meshes, &pair, &mut manifolds.points);
    manifolds.close(pair.bodies, 0);
    manifolds
}
