//! The impacts of bodies with continuous collision detection in a collision substep, and how the bodies move after
//! them.

use super::body_sweeps::{BodySweep, BodySweeps, Ground};
use super::search::Outcome;
use super::time_of_impact::{advance, rounded_down};
use super::{Pose, Scratch, Sweep};
use crate::parallel::loops;
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Plane};
use crate::types::body::RigidBody;
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Memory that is reused between collision substeps.
#[derive(Default)]
pub struct ImpactScratch {
    workers: PerThread<Scratch>,
    /// For each pair, the time of its next impact; infinite if there is none.
    times: Vec<f64>,
    /// For each pair whether its bodies no longer stop each other.
    ignored: Vec<bool>,
    /// The bodies of the pairs, ascending, and for each pair the places of its two in this list.
    members: Vec<u32>,
    places: Vec<[u32; 2]>,
    pairs_of: PairsOf,
    /// The sweep of each member, once there is an impact.
    body_sweeps: BodySweeps,
    upcoming: BinaryHeap<Reverse<UpcomingImpact>>,
    /// Numbers of the pairs whose time must be recomputed, and the new times.
    outdated: Vec<u32>,
    new_times: Vec<f64>,
}

/// The first impact of a body in a collision substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Number of the body.
    pub body: u32,
    /// Fraction of its motion before the impact, 0 to 1.
    pub fraction: f32,
    /// Pose at the end of the collision substep.
    pub end: Pose,
}

/// For each place in the list of bodies the numbers of its pairs.
#[derive(Default)]
struct PairsOf {
    /// Where the pairs of each place end, once all are added.
    ends: Vec<u32>,
    pairs: Vec<u32>,
}

/// The next impact of a pair. It is out of date if the time of the pair is another one by now.
#[derive(Clone, Copy)]
struct UpcomingImpact {
    time: f64,
    pair: u32,
}

impl Ord for UpcomingImpact {
    /// Pairs are ordered by their time, and at equal times by their number.
    fn cmp(&self, other: &Self) -> Ordering {
        self.time.total_cmp(&other.time).then(self.pair.cmp(&other.pair))
    }
}

impl PartialOrd for UpcomingImpact {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for UpcomingImpact {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for UpcomingImpact {}

/// How often the target distance is halved for bodies that start within it. A body that was stopped before starts
/// within it, and contacts do not remove all of a bullet's speed at once: a sheet may be thinner than the rest of the
/// bullet's motion. For bodies that start within the smallest target distance as well, each of these searches ends at
/// its first visit.
const MAX_HALVINGS: u32 = 12;

/// Writes into `impacts`, in the order of bodies, which of the `continuous` bodies collide with others in the collision
/// substep, when, and their poses at its end.
///
/// Two bodies collide at their [`time_of_impact`](super::time_of_impact()). After that they lose their relative motion:
/// * A continuous body that collides with a body that is not continuous is carried by it to the end of the collision
///   substep. The other body completes its own motion, so it does not tunnel through the first one, however thin that
///   is.
/// * Two continuous bodies that collide continue without rotation, at the common velocity that conserves momentum. A
///   body that collides with a group of bodies that move together joins it.
/// * Bodies that are carried may collide with further bodies, and so on; impacts are handled in the order of time. A
///   body that is carried by one body and collides with another that carries is squeezed. It continues with the one
///   that yields less: static before kinematic before dynamic. It may then overlap the other one.
///
/// A body that `touches` another at the start, with the normal that leads from the first to the second, slides along it
/// at the first impacts, and is carried after these: it is pressed against that body, and carried round by one that
/// rotates it would keep a velocity that it does not follow.
///
/// For pairs that start nearer than `target_distance` that distance is halved, up to 12 times. Pairs that start nearer
/// than the smallest, or overlap, collide at once. `sweeps` and `continuous` have an entry for each of `bodies`;
/// missing entries count as not continuous. Only sweeps of bodies in `pairs` matter. Pairs are pairs of colliders, and
/// bodies have the numbers of their first ones. `pairs` must include all pairs whose bounding spheres overlap anywhere
/// on their paths. `target_distance` is how near each pair may come, metres. Bodies that are carried keep to their
/// [`LockedAxes`](crate::types::body::LockedAxes), and are not carried into `planes`, except into those that they
/// `pass`: these are numbered after the bodies. Runs on rayon's current thread pool, outside of a pool on the calling
/// thread; the same input gives the same bits with any number of threads.
///
/// Guarantee: no pair with a continuous body comes nearer than `target_distance`, except pairs whose bodies are
/// squeezed or have `LockedAxes`. Limit: sweeps are straight, so a body that a contact deflects within the collision
/// substep leaves its sweep.
pub fn find_impacts(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    pass: impl Fn([u32; 2]) -> bool,
    sweeps: &[Sweep],
    continuous: &[bool],
    pairs: &[[u32; 2]],
    target_distance: impl Fn([u32; 2]) -> f32 + Sync,
    touches: impl Fn([u32; 2]) -> Option<DVec3>,
    scratch: &mut ImpactScratch,
    impacts: &mut Vec<Impact>,
) {
    let ImpactScratch {
        workers,
        times,
        ignored,
        members,
        places,
        pairs_of,
        body_sweeps,
        upcoming,
        outdated,
        new_times,
    } = scratch;
    let workers = workers.ready();
    let count = bodies.len().min(sweeps.len());
    let is_continuous = |i: u32| continuous.get(i as usize) == Some(&true);
    let bodies_of = |pair: [u32; 2]| pair.map(|i| bodies.body_of(i));
    // As a fraction of the sweeps.
    let time_of_impact = |pair: [u32; 2], sweeps: [&Sweep; 2]| {
        let moves = |sweep: &&Sweep| sweep.travel != DVec3::ZERO || sweep.turn != DVec3::ZERO;
        if !sweeps.iter().any(moves) {
            return f64::INFINITY;
        }
        let mut scratch = workers.lock();
        let mut target_distance = target_distance(pair);
        for _ in 0..=MAX_HALVINGS {
            match advance(bodies, meshes, pair, sweeps, target_distance, &mut scratch) {
                Outcome::Hit(hit) => return hit.time,
                Outcome::Apart => return f64::INFINITY,
                Outcome::InitiallyClose => target_distance *= 0.5,
            }
        }
        0.0
    };
    impacts.clear();
    ignored.clear();
    ignored.extend(pairs.iter().map(|pair| {
        let exist = pair.iter().all(|&i| (i as usize) < count);
        !(exist && bodies_of(*pair).into_iter().any(is_continuous))
    }));
    let first_times = pairs.par_iter().zip(&*ignored).map(|(&pair, &ignored)| {
        if ignored {
            f64::INFINITY
        } else {
            time_of_impact(pair, bodies_of(pair).map(|i| &sweeps[i as usize]))
        }
    });
    loops::collect(first_times, 1, times);
    if !times.iter().any(|&time| time < 1.0) {
        return;
    }

    members.clear();
    let exist = pairs.iter().zip(&*ignored).filter(|(_, ignored)| !**ignored);
    members.extend(exist.flat_map(|(&pair, _)| bodies_of(pair)));
    members.sort_unstable();
    members.dedup();
    places.clear();
    places.extend(pairs.iter().zip(&*ignored).map(|(&pair, &ignored)| {
        if ignored {
            return [0; 2];
        }
        bodies_of(pair).map(|body| members.partition_point(|&member| member < body) as u32)
    }));
    pairs_of.fill(members.len(), places, |at| !ignored[at]);
    body_sweeps.begin((0..).zip(&*members).map(|(group, &body)| BodySweep {
        body,
        from: 0.0,
        sweep: sweeps[body as usize],
        group,
        first_impact: f64::INFINITY,
        slides: 0,
    }));
    let ground = Ground { bodies, planes, pass };
    let is_continuous = |member: u32| is_continuous(members[member as usize]);
    upcoming.clear();
    let within = (0..).zip(&*times).filter(|(_, time)| **time < 1.0);
    upcoming.extend(within.map(|(pair, &time)| Reverse(UpcomingImpact { time, pair })));
    while let Some(Reverse(UpcomingImpact { time, pair })) = upcoming.pop() {
        let at = pair as usize;
        if times[at].total_cmp(&time).is_ne() {
            continue;
        }
        times[at] = f64::INFINITY;
        let pair = places[at];
        let groups = pair.map(|i| body_sweeps.all[i as usize].group);
        if groups[0] == groups[1] {
            continue;
        }
        let carries = groups.map(|group| !is_continuous(group));
        match carries {
            [false, false] => body_sweeps.merge_groups(&ground, groups, time),
            [true, false] | [false, true] => {
                let side = usize::from(carries[0]);
                let (carrier, group) = (groups[1 - side], groups[side]);
                let normal = touches(pairs[at]).filter(|_| body_sweeps.may_slide(group));
                match normal {
                    Some(normal) => {
                        let normal = if side == 1 { normal } else { -normal };
                        body_sweeps.slide(&ground, carrier, time, group, normal);
                    }
                    None => body_sweeps.carry_group(&ground, carrier, time, group),
                }
            }
            [true, true] => {
                let mobility = |group: u32| match bodies.kind[members[group as usize] as usize] {
                    RigidBody::Static => 0,
                    RigidBody::Kinematic => 1,
                    RigidBody::Dynamic => 2,
                };
                let [one, other] = groups.map(mobility);
                // The more mobile kind yields. Of two bodies of the same kind the continuous one yields.
                let last = other > one || (other == one && !is_continuous(pair[0]));
                let (yielding, carrier) = (pair[usize::from(last)], groups[usize::from(!last)]);
                ignored[at] = true;
                if is_continuous(yielding) && (one != other || pair.into_iter().all(is_continuous)) {
                    let old_group = body_sweeps.all[yielding as usize].group;
                    for &at in pairs_of.of(yielding) {
                        let mut others = places[at as usize].iter().filter(|&&i| i != yielding);
                        ignored[at as usize] |= others.any(|&i| body_sweeps.all[i as usize].group == old_group);
                    }
                    body_sweeps.carry(&ground, carrier, time, yielding);
                }
            }
        }
        outdated.clear();
        for place in body_sweeps.changed.drain(..) {
            outdated.extend(pairs_of.of(place).iter().filter(|&&at| {
                let [a, b] = places[at as usize].map(|i| body_sweeps.all[i as usize].group);
                a != b && !ignored[at as usize]
            }));
        }
        outdated.sort_unstable();
        outdated.dedup();
        let next_times = outdated.par_iter().map(|&at| {
            let [a, b] = places[at as usize].map(|i| body_sweeps.all[i as usize].after(time));
            time + (1.0 - time) * time_of_impact(pairs[at as usize], [&a, &b])
        });
        loops::collect(next_times, 1, new_times);
        for (&pair, &time) in outdated.iter().zip(&*new_times) {
            times[pair as usize] = time;
            if time < 1.0 {
                upcoming.push(Reverse(UpcomingImpact { time, pair }));
            }
        }
    }
    let stopped = body_sweeps
        .all
        .iter()
        .filter(|body_sweep| body_sweep.first_impact < 1.0);
    impacts.extend(stopped.map(|body_sweep| Impact {
        body: body_sweep.body,
        fraction: rounded_down(body_sweep.first_impact),
        end: body_sweep.sweep.at(1.0),
    }));
}

impl PairsOf {
    /// Lists the pairs of `count` places that are `wanted`. `places` has the places of the bodies of each pair.
    fn fill(&mut self, count: usize, places: &[[u32; 2]], wanted: impl Fn(usize) -> bool) {
        let Self { ends, pairs } = self;
        let all = || (0u32..).zip(places).filter(|(at, _)| wanted(*at as usize));
        ends.clear();
        ends.resize(count, 0);
        for &place in all().flat_map(|(_, pair)| pair) {
            ends[place as usize] += 1;
        }
        let mut sum = 0;
        for end in ends.iter_mut() {
            sum += std::mem::replace(end, sum);
        }
        pairs.clear();
        pairs.resize(sum as usize, 0);
        for (at, pair) in all() {
            for &place in pair {
                let end = &mut ends[place as usize];
                pairs[*end as usize] = at;
                *end += 1;
            }
        }
    }

    /// The pairs of a place, ascending.
    fn of(&self, place: u32) -> &[u32] {
        let place = place as usize;
        let first = place.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.pairs[first as usize..self.ends[place] as usize]
    }
}
