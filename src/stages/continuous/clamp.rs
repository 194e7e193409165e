//! How far bodies may go.

use super::search::Meeting;
use super::{Scratch, Sweep, meeting, rounded_down};
use crate::stages::mesh_arena::MeshArena;
use crate::stages::per_thread::PerThread;
use crate::stages::state::Bodies;
use glam::DVec3;
use rayon::prelude::*;

/// Memory kept between intervals.
#[derive(Default)]
pub struct ClampScratch {
    workers: PerThread<Scratch>,
    /// For each pair when its bodies meet, infinite for never.
    times: Vec<f32>,
}

/// How often bodies that start as near as the slack are looked at with half of it. One that was stopped starts there, and
/// contacts do not take all of a bullet's speed at once: a sheet may be thinner than what is left. If they are as near as
/// that, too, the search ends at its first look.
const CLOSER: u32 = 12;

/// Writes into `fractions` which part of its motion, 0 to 1, each body may make: for those that are `continuous` and move the
/// smallest [`time_of_impact`](super::time_of_impact) of all their `pairs`, for all others 1. Pairs that start nearer than
/// `slack` are looked at with half of it, up to 12 times; if they are as near as that, or overlap, they stay. Place a stopped
/// body at [`Sweep::at`] that time; the rest of its motion is lost.
///
/// `sweeps` and `continuous` have an entry for each of `bodies`; what is missing counts as not continuous. `pairs` must hold those
/// whose bounding spheres overlap anywhere on their ways; `slack` tells how near each may come, metres. Both ends are clamped if
/// both are continuous. Runs on rayon's current thread pool; the same input gives the same bits, however many threads there are.
///
/// What that guarantees: a body that is stopped has not come nearer than `slack` to any surface that stands still, nor to
/// one whose body makes all its motion until the same time. What not:
/// * The other body of a pair goes on to the end of the interval if it is not continuous, and may then run into the one that was
///   stopped, or past it if it is thin and fast. Flag what is fast, not what is in its way.
/// * Two continuous bodies stop at times of their own. Both are apart until the earlier of the two; but the later one goes on,
///   and the one that was stopped early, by a third body, is then not where its sweep said. If it would have
///   cleared the way, the later one meets it after all. Bodies that meet each other first stop at the same time, and apart.
/// * Sweeps are straight: what turns aside within the interval, by a contact say, is not where its sweep says.
pub fn clamp(
    bodies: &Bodies,
    meshes: &MeshArena,
    sweeps: &[Sweep],
    continuous: &[bool],
    pairs: &[[u32; 2]],
    slack: impl Fn([u32; 2]) -> f32 + Sync,
    scratch: &mut ClampScratch,
    fractions: &mut Vec<f32>,
) {
    let ClampScratch { workers, times } = scratch;
    let workers = workers.ready();
    let asks = |i: u32| {
        let i = i as usize;
        let moves = |sweep: &Sweep| sweep.travel != DVec3::ZERO || sweep.turn != DVec3::ZERO;
        continuous.get(i) == Some(&true) && i < bodies.len() && sweeps.get(i).is_some_and(moves)
    };
    pairs
        .par_iter()
        .map(|&pair| {
            let [a, b] = pair.map(|i| sweeps.get(i as usize));
            let (Some(a), Some(b), true) = (a, b, pair.into_iter().any(asks)) else {
                return f32::INFINITY;
            };
            let mut scratch = workers.lock();
            let mut slack = slack(pair);
            for _ in 0..=CLOSER {
                match meeting(bodies, meshes, pair, [a, b], slack, &mut scratch) {
                    Meeting::At(time) => return rounded_down(time),
                    Meeting::Never => return f32::INFINITY,
                    Meeting::Already => slack *= 0.5,
                }
            }
            0.0
        })
        .collect_into_vec(times);

    fractions.clear();
    fractions.resize(bodies.len(), 1.0);
    for (pair, &time) in pairs.iter().zip(&*times) {
        for i in pair.iter().filter(|i| time < 1.0 && asks(**i)) {
            let fraction = &mut fractions[*i as usize];
            *fraction = fraction.min(time);
        }
    }
}
