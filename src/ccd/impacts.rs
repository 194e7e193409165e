//! The impacts of bodies with continuous collision detection in a collision substep, and how the bodies move after
//! them.

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
use std::cmp::Ordering;

/// Memory that is reused between collision substeps.
#[derive(Default)]
pub struct ImpactScratch {
    workers: PerThread<Scratch>,
    /// For each pair the time of its next impact, infinite if there is none.
    times: Vec<f64>,
    /// For each pair whether its bodies no longer stop each other.
    ignored: Vec<bool>,
    /// The bodies of the pairs, ascending, and for each pair the places of its two in this list.
    members: Vec<u32>,
    places: Vec<[u32; 2]>,
    /// The motion of each of them, once there is an impact.
    motions: Vec<Motion>,
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
    /// Its pose at the end of the collision substep.
    pub end: Pose,
}

/// The motion of a body from some time on.
#[derive(Clone, Copy)]
struct Motion {
    /// Number of the body.
    body: u32,
    /// Start of this motion, 0 to 1.
    from: f64,
    /// From then to the end of the collision substep.
    sweep: Sweep,
    /// Bodies of the same group move together. Its name is the place of the body that carries the others, if there is one,
    /// otherwise the smallest place in it.
    group: u32,
    /// Time of its first impact, infinite if there is none.
    first_impact: f64,
    has_changed: bool,
}

/// How often the target distance is halved for bodies that start within it. A body that was stopped before starts
/// there, and contacts do not remove all of a bullet's speed at once: a sheet may be thinner than the rest of its
/// motion. For bodies that start within the smallest target distance as well, each of these searches ends at its first
/// visit.
const MAX_HALVINGS: u32 = 12;

/// Writes into `impacts`, in the order of bodies, which of the `continuous` bodies collide with others in the collision
/// substep, when, and their poses at its end.
///
/// Two bodies collide at their [`time_of_impact`](super::time_of_impact()). After that they lose their relative motion:
/// * A continuous body that collides with one that is not is carried by it to the end of the collision substep. The
///   other body completes its own motion, so it does not tunnel through the first one, however thin that is.
/// * Two continuous bodies that collide continue without rotation, at the common velocity that conserves momentum. A
///   body that collides with a group of bodies that move together joins it.
/// * Bodies that are carried may collide with further bodies, and so on; impacts are handled in the order of time. A
///   body that is carried by one body and collides with another that carries is squeezed. It continues with the one
///   that yields less: static before kinematic before dynamic. It may then overlap the other one.
///
/// For pairs that start nearer than `target_distance` that distance is halved, up to 12 times. Pairs that start nearer
/// than the smallest, or overlap, collide at once. `sweeps` and `continuous` have an entry for each of `bodies`;
/// missing entries count as not continuous. Only sweeps of bodies in `pairs` matter. Pairs are pairs of colliders, and
/// bodies have the numbers of their first ones. `pairs` must include all pairs whose bounding spheres overlap anywhere on
/// their paths. `target_distance` is how near each pair may come, metres. Bodies that are carried keep to their
/// [`LockedAxes`](crate::types::body::LockedAxes), and are not carried into `planes`. Runs on rayon's current thread
/// pool, outside of a pool on the calling thread; the same input gives the same bits with any number of threads.
///
/// Guarantee: no pair with a continuous body comes nearer than `target_distance`, except pairs whose bodies are
/// squeezed or have `LockedAxes`. Limit: sweeps are straight, so a body that a contact deflects within the collision
/// substep leaves its sweep.
pub fn find_impacts(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    sweeps: &[Sweep],
    continuous: &[bool],
    pairs: &[[u32; 2]],
    target_distance: impl Fn([u32; 2]) -> f32 + Sync,
    scratch: &mut ImpactScratch,
    impacts: &mut Vec<Impact>,
) {
    let ImpactScratch {
        workers,
        times,
        ignored,
        members,
        places,
        motions,
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
    motions.clear();
    motions.extend((0..).zip(&*members).map(|(group, &body)| Motion {
        body,
        from: 0.0,
        sweep: sweeps[body as usize],
        group,
        first_impact: f64::INFINITY,
        has_changed: false,
    }));
    let is_continuous = |member: u32| is_continuous(members[member as usize]);
    // Of pairs with the same time the first comes first.
    while let Some((at, &time)) = (times.iter().enumerate())
        .filter(|(_, time)| **time < 1.0)
        .min_by(|one, other| one.1.total_cmp(other.1))
    {
        times[at] = f64::INFINITY;
        let pair = places[at];
        let groups = pair.map(|i| motions[i as usize].group);
        if groups[0] == groups[1] {
            continue;
        }
        match groups.map(|group| !is_continuous(group)) {
            [false, false] => merge_groups(bodies, planes, motions, groups, time),
            [true, false] => carry(bodies, planes, motions, groups[0], time, |_, motion| {
                motion.group == groups[1]
            }),
            [false, true] => carry(bodies, planes, motions, groups[1], time, |_, motion| {
                motion.group == groups[0]
            }),
            [true, true] => {
                let mobility = |group: u32| match bodies.kind[members[group as usize] as usize] {
                    RigidBody::Static => 0,
                    RigidBody::Kinematic => 1,
                    RigidBody::Dynamic => 2,
                };
                let [one, other] = groups.map(mobility);
                // Of two of the same kind the one yields that is continuous.
                let last = other > one || (other == one && !is_continuous(pair[0]));
                let (yielding, carrier) = (pair[usize::from(last)], groups[usize::from(!last)]);
                ignored[at] = true;
                if is_continuous(yielding) && (one != other || pair.into_iter().all(is_continuous)) {
                    let old_group = motions[yielding as usize].group;
                    for (ignored, pair) in ignored.iter_mut().zip(&*places).filter(|(ignored, _)| !**ignored) {
                        let others = pair.contains(&yielding)
                            && pair
                                .iter()
                                .any(|&i| i != yielding && motions[i as usize].group == old_group);
                        *ignored |= others;
                    }
                    carry(bodies, planes, motions, carrier, time, |i, _| i == yielding);
                }
            }
        }
        outdated.clear();
        outdated.extend((0..pairs.len() as u32).filter(|&at| {
            if ignored[at as usize] {
                return false;
            }
            let [a, b] = places[at as usize].map(|i| i as usize);
            (motions[a].has_changed || motions[b].has_changed) && motions[a].group != motions[b].group
        }));
        let next_times = outdated.par_iter().map(|&at| {
            let [a, b] = places[at as usize].map(|i| motions[i as usize].after(time));
            time + (1.0 - time) * time_of_impact(pairs[at as usize], [&a, &b])
        });
        loops::collect(next_times, 1, new_times);
        for (&at, &time) in outdated.iter().zip(&*new_times) {
            times[at as usize] = time;
        }
        for motion in motions.iter_mut() {
            motion.has_changed = false;
        }
    }
    let stopped = motions.iter().filter(|motion| motion.first_impact < 1.0);
    impacts.extend(stopped.map(|motion| Impact {
        body: motion.body,
        fraction: rounded_down(motion.first_impact),
        end: motion.sweep.at(1.0),
    }));
}

/// Merges two groups of continuous bodies, which move together from `time` on. Two groups of the same size get the mean
/// of their velocities, weighted by mass. Otherwise the smaller group adopts the velocity of the larger one, so that in
/// a heap the times of all members need not be recomputed for each body that joins.
fn merge_groups(bodies: &Bodies, planes: &[Plane], motions: &mut [Motion], groups: [u32; 2], time: f64) {
    let (mut momentum, mut mass) = ([DVec3::ZERO; 2], [0.0; 2]);
    let mut members = [0, 0];
    for motion in motions.iter() {
        let inverse_mass = bodies.inverse_mass[motion.body as usize];
        for side in 0..2 {
            if motion.group == groups[side] {
                // Bodies without a valid mass have equal weights.
                let own = if inverse_mass > 0.0 {
                    1.0 / f64::from(inverse_mass)
                } else {
                    1.0
                };
                momentum[side] += own * motion.after(time).travel;
                mass[side] += own;
                members[side] += 1;
            }
        }
    }
    let travel = match members[0].cmp(&members[1]) {
        Ordering::Equal => (momentum[0] + momentum[1]) / (mass[0] + mass[1]),
        Ordering::Greater => momentum[0] / mass[0],
        Ordering::Less => momentum[1] / mass[1],
    };
    let mut common = travel;
    for motion in motions.iter().filter(|motion| groups.contains(&motion.group)) {
        common = limit_penetration(bodies, planes, motion.body as usize, &motion.after(time), common);
    }
    let group = groups[0].min(groups[1]);
    for motion in motions.iter_mut() {
        let Some(side) = groups.iter().position(|&group| group == motion.group) else {
            continue;
        };
        if members[side] > members[1 - side] && common == travel {
            motion.group = group;
        } else {
            let free = bodies.params[motion.body as usize].locked_axes.free_translation();
            let free = free.as_dvec3();
            motion.change(time, group, common * free, DVec3::ZERO);
        }
    }
}

/// Changes `travel` so that it moves body `i` no deeper into planes than its `own` motion does, which contacts
/// have already limited.
fn limit_penetration(bodies: &Bodies, planes: &[Plane], i: usize, own: &Sweep, mut travel: DVec3) -> DVec3 {
    for plane in planes {
        if plane.sensor || !bodies.layers[i].interacts_with(plane.layers) {
            continue;
        }
        let normal = plane.normal.as_dvec3();
        let height = normal.dot(own.before.center + travel) - f64::from(plane.distance);
        let lowest = normal.dot(own.travel).min(0.0);
        let radius = bodies
            .compound_of(i as u32)
            .map_or(bodies.radius[i], |body| body.radius);
        if height < f64::from(radius) {
            travel += normal * (lowest - normal.dot(travel)).max(0.0);
        }
    }
    travel
}

/// From `time` on the selected bodies are carried by that at the place `carrier`, as if rigidly attached to it.
fn carry(
    bodies: &Bodies,
    planes: &[Plane],
    motions: &mut [Motion],
    carrier: u32,
    time: f64,
    is_selected: impl Fn(u32, &Motion) -> bool,
) {
    let carrying = motions[carrier as usize].after(time);
    let rotation = carrying.at(1.0).rotation * carrying.before.rotation.inverse();
    for (i, motion) in (0..).zip(motions) {
        if !is_selected(i, motion) {
            continue;
        }
        let own = motion.after(time);
        let offset = own.before.center - carrying.before.center;
        // Exactly zero without rotation.
        let rotation_travel = if carrying.turn == DVec3::ZERO {
            DVec3::ZERO
        } else {
            rotation * offset - offset
        };
        let body = motion.body as usize;
        let locked = bodies.params[body].locked_axes;
        let travel = limit_penetration(bodies, planes, body, &own, carrying.travel + rotation_travel);
        let travel = travel * locked.free_translation().as_dvec3();
        motion.change(time, carrier, travel, carrying.turn * locked.free_rotation().as_dvec3());
    }
}

impl Motion {
    /// The rest of the motion, from `time` on.
    fn after(&self, time: f64) -> Sweep {
        let left = 1.0 - self.from;
        let done = if left > 0.0 { (time - self.from) / left } else { 0.0 };
        self.sweep.part(done.clamp(0.0, 1.0), 1.0)
    }

    /// Replaces the motion from `time` on.
    fn change(&mut self, time: f64, group: u32, travel: DVec3, turn: DVec3) {
        *self = Self {
            body: self.body,
            from: time,
            sweep: Sweep {
                before: self.after(time).before,
                travel,
                turn,
            },
            group,
            first_impact: self.first_impact.min(time),
            has_changed: true,
        };
    }
}
