//! What passes through what within an interval.

use super::{Scratch, Stop, Sweep, first_touch};
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact};
use rayon::prelude::*;

/// Memory kept between intervals.
#[derive(Default)]
pub struct PassScratch {
    workers: PerThread<Scratch>,
}

/// Writes into `found`, for each of `pairs`, where its bodies first touch on their ways; `None` if they do not, or touch from the start.
/// Those of `stops` leave their sweeps when they are stopped. Runs on rayon's current thread pool; the same input gives the same
/// bits, however many threads there are.
pub fn passes(
    bodies: &Bodies,
    meshes: &MeshArena,
    sweeps: &[Sweep],
    stops: &[Stop],
    pairs: &[[u32; 2]],
    scratch: &mut PassScratch,
    found: &mut Vec<Option<Contact>>,
) {
    let workers = scratch.workers.ready();
    let stop_of = |i: u32| {
        let at = stops.binary_search_by_key(&i, |stop| stop.body);
        at.ok().map(|at| &stops[at])
    };
    pairs
        .par_iter()
        .map(|&pair| {
            let [a, b] = pair.map(stop_of);
            // Both ways have no bend between two of these times.
            let [one, other] = [a, b].map(|stop| stop.map_or(0.0, |stop| f64::from(stop.fraction)));
            let bends = [0.0, one.min(other), one.max(other), 1.0];
            let mut worker = workers.lock();
            bends.windows(2).filter(|part| part[0] < part[1]).find_map(|part| {
                let [a, b] =
                    [(pair[0], a), (pair[1], b)].map(|(i, stop)| way(&sweeps[i as usize], stop, part[0], part[1]));
                first_touch(bodies, meshes, pair, [&a, &b], &mut worker)
            })
        })
        .collect_into_vec(found);
}

/// How a body moves between two times, between which it is not stopped.
fn way(sweep: &Sweep, stop: Option<&Stop>, from: f64, to: f64) -> Sweep {
    match stop {
        Some(stop) if to > f64::from(stop.fraction) => {
            let stopped = f64::from(stop.fraction);
            let rest = Sweep::between(sweep.at(stopped), stop.end);
            let part = |time: f64| (time - stopped) / (1.0 - stopped);
            rest.part(part(from), part(to))
        }
        _ => sweep.part(from, to),
    }
}
