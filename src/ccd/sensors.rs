//! Which sensors touch bodies with continuous collision detection during a collision substep.

use super::{Impact, Scratch, Sweep, first_touch};
use crate::parallel::loops;
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact};
use rayon::prelude::*;

/// Memory that is reused between collision substeps.
#[derive(Default)]
pub struct SensorScratch {
    workers: PerThread<Scratch>,
}

/// Writes into `found`, for each of `pairs`, where its bodies first touch on their paths; `None` if they do not touch,
/// or touch at the start. Bodies with an impact in `impacts` leave their sweep at its time. Runs on rayon's current
/// thread pool, outside of a pool on the calling thread; the same input gives the same bits with any number of threads.
pub fn find_sensor_touches(
    bodies: &Bodies,
    meshes: &MeshArena,
    sweeps: &[Sweep],
    impacts: &[Impact],
    pairs: &[[u32; 2]],
    scratch: &mut SensorScratch,
    found: &mut Vec<Option<Contact>>,
) {
    let workers = scratch.workers.ready();
    let impact_of = |i: u32| {
        let at = impacts.binary_search_by_key(&i, |impact| impact.body);
        at.ok().map(|at| &impacts[at])
    };
    let touches = pairs.par_iter().map(|&pair| {
        let movers = pair.map(|i| bodies.body_of(i));
        let [a, b] = movers.map(impact_of);
        // The velocities of both bodies are constant between two of these times.
        let [one, other] = [a, b].map(|impact| impact.map_or(0.0, |impact| f64::from(impact.fraction)));
        let times = [0.0, one.min(other), one.max(other), 1.0];
        let mut worker = workers.lock();
        times.windows(2).filter(|span| span[0] < span[1]).find_map(|span| {
            let [a, b] = [(movers[0], a), (movers[1], b)]
                .map(|(i, impact)| motion(&sweeps[i as usize], impact, span[0], span[1]));
            first_touch(bodies, meshes, pair, [&a, &b], &mut worker)
        })
    });
    loops::collect(touches, 1, found);
}

/// The motion of a body between two times, without an impact between them.
fn motion(sweep: &Sweep, impact: Option<&Impact>, from: f64, to: f64) -> Sweep {
    match impact {
        Some(impact) if to > f64::from(impact.fraction) => {
            let start = f64::from(impact.fraction);
            let rest = Sweep::between(sweep.at(start), impact.end);
            let fraction = |time: f64| (time - start) / (1.0 - start);
            rest.part(fraction(from), fraction(to))
        }
        _ => sweep.part(from, to),
    }
}
