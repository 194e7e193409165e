//! Contact generation on the CPU: pairs in parallel, each task writing lists of its own that are joined in order.

pub(super) mod contour;
pub(super) mod feature;
mod ids;
mod inside;
pub(super) mod near;
pub(super) mod pair;
pub mod planes;
mod ray;
pub(super) mod reduce;
pub(super) mod side;
pub(super) mod smooth;

pub(crate) use feature::Feature;
pub(crate) use ids::ids;
pub(crate) use pair::{Pair, Worker};
pub(crate) use side::PlacedMesh;

use super::MarginPair;
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, ManifoldPoint, Manifolds};
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
                add_points(bodies, meshes, pair, &mut worker, &mut task.points);
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
    add_points(bodies, meshes, &pair, &mut Worker::default(), &mut manifolds.points);
    manifolds.close(pair.bodies, 0);
    manifolds
}

/// Appends the points of a pair, if there are such bodies.
fn add_points(
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: &MarginPair,
    worker: &mut Worker,
    points: &mut Vec<ManifoldPoint>,
) {
    if let Some(found) = pair_of_bodies(bodies, meshes, pair.bodies) {
        let chosen = worker.reduced(&found, pair.margin);
        points.extend(chosen.iter().map(|feature| found.point(feature).0));
    }
}

/// Nothing if there are no such bodies.
fn pair_of_bodies<'a>(bodies: &'a Bodies, meshes: &'a MeshArena, pair: [u32; 2]) -> Option<Pair<'a>> {
    let [a, b] = pair.map(|i| i as usize);
    if a == b || a.max(b) >= bodies.len() {
        return None;
    }
    let placed = |i: usize| {
        Some(PlacedMesh {
            mesh: &meshes.get(bodies.mesh[i])?.mesh,
            frame: &bodies.frame[i],
            scale: bodies.scale[i],
            radius: bodies.radius[i],
        })
    };
    Some(Pair::new([&placed(a)?, &placed(b)?], bodies.mesh[a] == bodies.mesh[b]))
}
