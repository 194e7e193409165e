//! How far bodies may go.

use super::search::Meeting;
use super::{Pose, Scratch, Sweep, meeting, rounded_down};
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Plane};
use crate::types::body::RigidBody;
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Memory kept between intervals.
#[derive(Default)]
pub struct ClampScratch {
    workers: PerThread<Scratch>,
    /// For each pair when its bodies meet next, infinite for never.
    times: Vec<f64>,
    /// For each pair whether its bodies are not stopped by each other any more.
    is_over: Vec<bool>,
    /// What each body does, once any two have met.
    ways: Vec<Way>,
    /// Numbers of the pairs whose time has to be found again, and what it is.
    again: Vec<u32>,
    found: Vec<f64>,
}

/// A body that met others within the interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Its number.
    pub body: u32,
    /// Which part of its own motion it made, 0 to 1.
    pub fraction: f32,
    /// Where it is at the end of the interval.
    pub end: Pose,
}

/// What a body does from some time on.
#[derive(Clone, Copy)]
struct Way {
    /// From when on, 0 to 1.
    from: f64,
    /// From then to the end of the interval.
    sweep: Sweep,
    /// Bodies of one group move as one. Its name is the number of the body that carries the others, if there is such a one, else
    /// the smallest number in it.
    group: u32,
    /// When it met others first, infinite for never.
    met: f64,
    has_changed: bool,
}

/// How often bodies that start as near as the slack are looked at with half of it. One that was stopped starts there, and
/// contacts do not take all of a bullet's speed at once: a sheet may be thinner than what is left. If they are as near as
/// that, too, the search ends at its first look.
const CLOSER: u32 = 12;

/// Writes into `stops`, in the order of bodies, which of those that are `continuous` meet others within the interval, when, and
/// where they are at its end.
///
/// Two bodies meet at their [`time_of_impact`](super::time_of_impact). From then on they lose their motion relative to each other:
/// * A continuous body that meets one that is not is carried by it to the end of the interval. That other body makes all of its
///   motion, and so does not pass the one it met, however thin it is.
/// * Two continuous bodies that meet go on with their common velocity, as momentum has it, and do not turn. Who meets
///   more than one that move so goes along with them.
/// * What is carried may meet further bodies, and so on: of all pairs the earliest is next. What is carried by one body and
///   meets another that carries, is squeezed. It goes on with the one that gives way less: static before kinematic before dynamic. The
///   other one may then overlap it.
///
/// Pairs that start nearer than `slack` are looked at with half of it, up to 12 times; if they are as near as that, or overlap,
/// they meet at once. `sweeps` and `continuous` have an entry for each of `bodies`; what is missing counts as not continuous. `pairs`
/// must hold those whose bounding spheres overlap anywhere on their ways; `slack` tells how near each may come, metres. What
/// is carried keeps to its [`LockedAxes`](crate::types::body::LockedAxes), and is not carried into `planes`. Runs on rayon's current thread pool; the same input
/// gives the same bits, however many threads there are.
///
/// What that guarantees: but for those that are squeezed or have `LockedAxes`, no pair with a continuous body comes nearer than `slack`. What not:
/// sweeps are straight, and what turns aside within the interval, by a contact say, is not where its sweep says.
pub fn clamp(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    sweeps: &[Sweep],
    continuous: &[bool],
    pairs: &[[u32; 2]],
    slack: impl Fn([u32; 2]) -> f32 + Sync,
    scratch: &mut ClampScratch,
    stops: &mut Vec<Stop>,
) {
    let ClampScratch {
        workers,
        times,
        is_over,
        ways,
        again,
        found,
    } = scratch;
    let workers = workers.ready();
    let count = bodies.len().min(sweeps.len());
    let is_continuous = |i: u32| continuous.get(i as usize) == Some(&true);
    // Within a part of the interval.
    let meet = |pair: [u32; 2], ways: [&Sweep; 2]| {
        let moves = |sweep: &&Sweep| sweep.travel != DVec3::ZERO || sweep.turn != DVec3::ZERO;
        if !ways.iter().any(moves) {
            return f64::INFINITY;
        }
        let mut scratch = workers.lock();
        let mut slack = slack(pair);
        for _ in 0..=CLOSER {
            match meeting(bodies, meshes, pair, ways, slack, &mut scratch) {
                Meeting::At(encounter) => return encounter.time,
                Meeting::Never => return f64::INFINITY,
                Meeting::Already => slack *= 0.5,
            }
        }
        0.0
    };
    stops.clear();
    is_over.clear();
    is_over.extend(pairs.iter().map(|pair| {
        let exist = pair.iter().all(|&i| (i as usize) < count);
        !(exist && pair.iter().any(|&i| is_continuous(i)))
    }));
    pairs
        .par_iter()
        .zip(&*is_over)
        .map(|(&pair, &is_over)| {
            if is_over {
                f64::INFINITY
            } else {
                meet(pair, pair.map(|i| &sweeps[i as usize]))
            }
        })
        .collect_into_vec(times);
    if !times.iter().any(|&time| time < 1.0) {
        return;
    }

    ways.clear();
    ways.extend((0..).zip(&sweeps[..count]).map(|(group, &sweep)| Way {
        from: 0.0,
        sweep,
        group,
        met: f64::INFINITY,
        has_changed: false,
    }));
    // Of pairs that meet at the same time the first is next.
    while let Some((at, &time)) = (times.iter().enumerate())
        .filter(|(_, time)| **time < 1.0)
        .min_by(|one, other| one.1.total_cmp(other.1))
    {
        times[at] = f64::INFINITY;
        let groups = pairs[at].map(|i| ways[i as usize].group);
        if groups[0] == groups[1] {
            continue;
        }
        match groups.map(|group| !is_continuous(group)) {
            [false, false] => go_together(bodies, planes, ways, groups, time),
            [true, false] => carry(bodies, planes, ways, groups[0], time, |_, way| way.group == groups[1]),
            [false, true] => carry(bodies, planes, ways, groups[1], time, |_, way| way.group == groups[0]),
            [true, true] => {
                let yields = |group: u32| match bodies.kind[group as usize] {
                    RigidBody::Static => 0,
                    RigidBody::Kinematic => 1,
                    RigidBody::Dynamic => 2,
                };
                let [one, other] = groups.map(yields);
                // Of two that are alike the one that can still be moved yields.
                let last = other > one || (other == one && !is_continuous(pairs[at][0]));
                let (yielding, held) = (pairs[at][usize::from(last)], groups[usize::from(!last)]);
                is_over[at] = true;
                if is_continuous(yielding) && (one != other || pairs[at].iter().all(|&i| is_continuous(i))) {
                    let left = ways[yielding as usize].group;
                    for (is_over, pair) in is_over.iter_mut().zip(pairs) {
                        let others = pair.contains(&yielding)
                            && pair.iter().any(|&i| i != yielding && ways[i as usize].group == left);
                        *is_over |= others;
                    }
                    carry(bodies, planes, ways, held, time, |i, _| i == yielding);
                }
            }
        }
        again.clear();
        again.extend((0..pairs.len() as u32).filter(|&at| {
            let [a, b] = pairs[at as usize].map(|i| i as usize);
            !is_over[at as usize] && (ways[a].has_changed || ways[b].has_changed) && ways[a].group != ways[b].group
        }));
        again
            .par_iter()
            .map(|&at| {
                let pair = pairs[at as usize];
                let [a, b] = pair.map(|i| ways[i as usize].after(time));
                time + (1.0 - time) * meet(pair, [&a, &b])
            })
            .collect_into_vec(found);
        for (&at, &time) in again.iter().zip(&*found) {
            times[at as usize] = time;
        }
        for way in ways.iter_mut() {
            way.has_changed = false;
        }
    }
    stops.extend(
        (0..)
            .zip(&*ways)
            .filter(|(_, way)| way.met < 1.0)
            .map(|(body, way)| Stop {
                body,
                fraction: rounded_down(way.met),
                end: way.sweep.at(1.0),
            }),
    );
}

/// From `time` on the continuous bodies of two groups move as one. Two bodies take the mean of their velocities, weighted by mass; who
/// joins a larger group goes along with it, so that in a heap no body is looked at again for each one that joins.
fn go_together(bodies: &Bodies, planes: &[Plane], ways: &mut [Way], groups: [u32; 2], time: f64) {
    let (mut momentum, mut mass) = ([DVec3::ZERO; 2], [0.0; 2]);
    let mut members = [0, 0];
    for (way, &inverse_mass) in ways.iter().zip(&bodies.inverse_mass) {
        for side in 0..2 {
            if way.group == groups[side] {
                // Of what has no mass to speak of all count alike.
                let own = if inverse_mass > 0.0 {
                    1.0 / f64::from(inverse_mass)
                } else {
                    1.0
                };
                momentum[side] += own * way.after(time).travel;
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
    for (i, way) in ways.iter().enumerate().filter(|(_, way)| groups.contains(&way.group)) {
        common = kept_out(bodies, planes, i, &way.after(time), common);
    }
    let group = groups[0].min(groups[1]);
    for (i, way) in ways.iter_mut().enumerate() {
        let Some(side) = groups.iter().position(|&group| group == way.group) else {
            continue;
        };
        if members[side] > members[1 - side] && common == travel {
            way.group = group;
        } else {
            let free = bodies.params[i].locked_axes.free_translation().as_dvec3();
            way.change(time, group, common * free, DVec3::ZERO);
        }
    }
}

/// The part of `travel` that takes body `i` no deeper into half-spaces than its `own` motion does, which contacts have already
/// limited.
fn kept_out(bodies: &Bodies, planes: &[Plane], i: usize, own: &Sweep, mut travel: DVec3) -> DVec3 {
    for plane in planes {
        let normal = plane.normal.as_dvec3();
        let height = normal.dot(own.before.center + travel) - f64::from(plane.distance);
        let lowest = normal.dot(own.travel).min(0.0);
        if height < f64::from(bodies.radius[i]) {
            travel += normal * (lowest - normal.dot(travel)).max(0.0);
        }
    }
    travel
}

/// From `time` on the bodies `which` are carried by body `carrier`, as if they were one with it.
fn carry(
    bodies: &Bodies,
    planes: &[Plane],
    ways: &mut [Way],
    carrier: u32,
    time: f64,
    which: impl Fn(u32, &Way) -> bool,
) {
    let by = ways[carrier as usize].after(time);
    let turned = by.at(1.0).rotation * by.before.rotation.inverse();
    for (i, way) in (0..).zip(ways) {
        if !which(i, way) {
            continue;
        }
        let own = way.after(time);
        let arm = own.before.center - by.before.center;
        // Exactly nothing if nothing turns.
        let swing = if by.turn == DVec3::ZERO {
            DVec3::ZERO
        } else {
            turned * arm - arm
        };
        let locked = bodies.params[i as usize].locked_axes;
        let travel = kept_out(bodies, planes, i as usize, &own, by.travel + swing);
        let travel = travel * locked.free_translation().as_dvec3();
        way.change(time, carrier, travel, by.turn * locked.free_rotation().as_dvec3());
    }
}

impl Way {
    /// The rest of it, from `time` on.
    fn after(&self, time: f64) -> Sweep {
        let left = 1.0 - self.from;
        let done = if left > 0.0 { (time - self.from) / left } else { 0.0 };
        self.sweep.part(done.clamp(0.0, 1.0), 1.0)
    }

    /// Goes on otherwise from `time` on.
    fn change(&mut self, time: f64, group: u32, travel: DVec3, turn: DVec3) {
        *self = Self {
            from: time,
            sweep: Sweep {
                before: self.after(time).before,
                travel,
                turn,
            },
            group,
            met: self.met.min(time),
            has_changed: true,
        };
    }
}
