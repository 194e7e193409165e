//! Which bodies are frozen: islands of bodies at rest.

use crate::solver::Interval;
use crate::solver::bodies::{SolverBodies, SolverBody, SolverMotion};
use crate::state::inactive::InactiveBodies;
use crate::state::{Manifold, ManifoldPoint, Manifolds};
use crate::types::body::RigidBody;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3;

/// Bodies touch if their surfaces are nearer than this many rest offsets: at rest they are one apart.
pub(crate) const TOUCH: f32 = 2.0;

/// Bodies that overlap by more than this many rest offsets are being pushed apart, and are not at rest however slow they are.
pub(crate) const OVERLAP: f32 = 1.0;

/// Puts bodies at rest to sleep and wakes them. Holds nothing but memory; what it knows of bodies is in
/// [`SolverBodies::sleep`].
///
/// Around every collision substep: [`Sleeper::wake`] before [`Solver::solve`](super::Solver::solve),
/// [`Sleeper::settle`] after it. The manifolds must hold the pairs of sleeping bodies too; as these do not move, those of
/// the last interval do (see [`Sleeper::is_still`]).
#[derive(Clone, Debug, Default)]
pub struct Sleeper {
    /// Of each body, one nearer to the root of its island.
    parents: Vec<u32>,
    /// What each body touches, as a sum of hashes of keys.
    neighbours: Vec<u64>,
    /// Of each island's root: something in it is awake, or must wake.
    restless: Vec<bool>,
}

impl Sleeper {
    /// Whether nothing about the pair of bodies `a` and `b` can have changed since the last interval: both sleep, or one
    /// sleeps and the other is static.
    pub fn is_still(bodies: &SolverBodies, a: u32, b: u32) -> bool {
        let [asleep, fixed] = [
            [a, b].map(|i| bodies.sleep[i as usize].asleep),
            [a, b].map(|i| bodies.bodies[i as usize].kind == RigidBody::Static),
        ];
        (asleep[0] && (asleep[1] || fixed[1])) || (asleep[1] && fixed[0])
    }

    /// Wakes whole islands in which a sleeping body was given a velocity, force or impulse, is touched by a body that is
    /// awake or by a kinematic one that moves, or will be within the interval, or touches others than when it fell asleep.
    pub fn wake(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        interval: &Interval,
    ) {
        if !bodies.sleep.iter().any(|s| s.asleep) {
            return;
        }
        if !settings.sleeping {
            for sleep in &mut bodies.sleep {
                *sleep = Default::default();
            }
            return;
        }
        self.find_islands(bodies, manifolds, settings);
        for i in 0..bodies.len() {
            let (body, motion, sleep) = (&bodies.bodies[i], &bodies.motions[i], &bodies.sleep[i]);
            let disturbed = if sleep.asleep {
                speed(body, motion) != 0.0
                    || !bodies.forces[i].is_zero()
                    || body.kind != RigidBody::Dynamic
                    || sleep.neighbours != self.neighbours[i]
            } else {
                body.kind == RigidBody::Dynamic
            };
            if disturbed {
                let root = self.root(i as u32);
                self.restless[root as usize] = true;
            }
        }
        self.note_visitors(bodies, manifolds, settings, interval);
        for i in 0..bodies.len() {
            let root = self.root(i as u32);
            if bodies.sleep[i].asleep && self.restless[root as usize] {
                bodies.sleep[i] = Default::default();
            }
        }
    }

    /// Measures how long bodies have been at rest, over an interval of `dt` seconds, and freezes islands that all have been
    /// for [`SolverSettings::sleep_time`]. At rest is what is slow and overlaps nothing: what pushes bodies apart leaves them
    /// no velocity.
    pub fn settle(&mut self, bodies: &mut SolverBodies, manifolds: &Manifolds, settings: &SolverSettings, dt: f32) {
        if !settings.sleeping {
            return;
        }
        for ((sleep, body), motion) in bodies.sleep.iter_mut().zip(&bodies.bodies).zip(&bodies.motions) {
            let slow = speed(body, motion) < settings.sleep_speed;
            sleep.rest_time = if slow { sleep.rest_time + dt } else { 0.0 };
        }
        for pair in &manifolds.pairs {
            if overlaps(bodies, manifolds, pair, settings) {
                for i in pair.bodies.map(|i| i as usize) {
                    bodies.sleep[i].rest_time = 0.0;
                }
            }
        }
        let ready = |bodies: &SolverBodies, i: usize| {
            let (sleep, forces) = (&bodies.sleep[i], &bodies.forces[i]);
            sleep.asleep || (sleep.rest_time >= settings.sleep_time && forces.is_zero())
        };
        if !(0..bodies.len()).any(|i| bodies.bodies[i].has_mass() && !bodies.sleep[i].asleep && ready(bodies, i)) {
            return;
        }
        self.find_islands(bodies, manifolds, settings);
        for i in 0..bodies.len() {
            if bodies.bodies[i].kind == RigidBody::Dynamic && !ready(bodies, i) {
                let root = self.root(i as u32);
                self.restless[root as usize] = true;
            }
        }
        self.note_drivers(bodies, manifolds, settings);
        for i in 0..bodies.len() {
            let root = self.root(i as u32);
            let calm = !self.restless[root as usize];
            if calm && bodies.bodies[i].has_mass() && !bodies.sleep[i].asleep {
                let sleep = &mut bodies.sleep[i];
                sleep.asleep = true;
                sleep.neighbours = self.neighbours[i];
                bodies.motions[i].linear_velocity = Vec3::ZERO;
                bodies.motions[i].angular_velocity = Vec3::ZERO;
            }
        }
    }

    /// Joins dynamic bodies that touch, and sums up whom each body touches.
    fn find_islands(&mut self, bodies: &SolverBodies, manifolds: &Manifolds, settings: &SolverSettings) {
        let count = bodies.len();
        self.parents.clear();
        self.parents.extend(0..count as u32);
        self.neighbours.clear();
        self.neighbours.resize(count, 0);
        self.restless.clear();
        self.restless.resize(count, false);
        for pair in &manifolds.pairs {
            if !touches(bodies, manifolds, pair, settings) {
                continue;
            }
            let [a, b] = pair.bodies.map(|i| i as usize);
            // A sum does not depend on the order of pairs.
            self.neighbours[a] = self.neighbours[a].wrapping_add(hash(bodies.keys[b]));
            self.neighbours[b] = self.neighbours[b].wrapping_add(hash(bodies.keys[a]));
            if bodies.bodies[a].has_mass() && bodies.bodies[b].has_mass() {
                let [a, b] = pair.bodies.map(|i| self.root(i));
                // The smaller number is the root, whatever the order of pairs.
                self.parents[a.max(b) as usize] = a.min(b);
            }
        }
    }

    /// Kinematic bodies that move keep those awake that touch them.
    fn note_drivers(&mut self, bodies: &SolverBodies, manifolds: &Manifolds, settings: &SolverSettings) {
        for pair in &manifolds.pairs {
            if touches(bodies, manifolds, pair, settings) {
                self.note_visitor(bodies, pair, |bodies, i| {
                    bodies.bodies[i].kind == RigidBody::Kinematic && is_moving(bodies, i)
                });
            }
        }
    }

    /// Bodies that move wake those that they will have reached at the end of the interval: in their sleep these would not
    /// give way.
    fn note_visitors(
        &mut self,
        bodies: &SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        interval: &Interval,
    ) {
        let fall = interval.gravity.length() * interval.dt;
        for pair in &manifolds.pairs {
            let Some(near) = nearness(bodies, pair, settings) else {
                continue;
            };
            let meets = |p: &ManifoldPoint| {
                let [a, b] = [0, 1].map(|end| {
                    let motion = &bodies.motions[pair.bodies[end] as usize];
                    motion.linear_velocity + motion.angular_velocity.cross(p.anchors[end])
                });
                p.separation - ((a - b).dot(p.normal).max(0.0) + fall) * interval.dt <= near
            };
            if points_of(manifolds, pair).iter().any(meets) {
                self.note_visitor(bodies, pair, |bodies, i| {
                    bodies.bodies[i].moves() && !bodies.sleep[i].asleep && is_moving(bodies, i)
                });
            }
        }
    }

    /// Makes the island restless of an end of `pair` whose other end is as asked.
    fn note_visitor(&mut self, bodies: &SolverBodies, pair: &Manifold, visits: impl Fn(&SolverBodies, usize) -> bool) {
        let [a, b] = pair.bodies;
        for (visitor, visited) in [(a, b), (b, a)] {
            if visits(bodies, visitor as usize) {
                let root = self.root(visited);
                self.restless[root as usize] = true;
            }
        }
    }

    /// The root of a body's island; halves the path on the way.
    fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            let above = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = above;
            i = above;
        }
        i
    }
}

/// Wakes bodies that touch something fixed which is not as it was.
pub(crate) fn wake_on_new_ground(bodies: &mut SolverBodies, inactive: &InactiveBodies, manifolds: &Manifolds) {
    for [a, b] in manifolds.pairs.iter().map(|pair| pair.bodies.map(|i| i as usize)) {
        for (sleeper, ground) in [(a, b), (b, a)] {
            if bodies.sleep[sleeper].asleep
                && bodies.bodies[ground].kind == RigidBody::Static
                && !inactive.flags[ground]
            {
                bodies.sleep[sleeper] = Default::default();
            }
        }
    }
}

/// Whether both bodies are there and solid, and some point of theirs is as near as at rest.
fn touches(bodies: &SolverBodies, manifolds: &Manifolds, pair: &Manifold, settings: &SolverSettings) -> bool {
    nearness(bodies, pair, settings).is_some_and(|near| points_of(manifolds, pair).iter().any(|p| p.separation <= near))
}

/// Whether both bodies are there and solid, and overlap by more than at rest.
fn overlaps(bodies: &SolverBodies, manifolds: &Manifolds, pair: &Manifold, settings: &SolverSettings) -> bool {
    rest_gap(bodies, pair, settings).is_some_and(|gap| {
        let mut points = points_of(manifolds, pair).iter();
        points.any(|p| p.separation < -OVERLAP * gap)
    })
}

/// Up to which separation a pair touches; `None` if a body is not there or not solid.
fn nearness(bodies: &SolverBodies, pair: &Manifold, settings: &SolverSettings) -> Option<f32> {
    rest_gap(bodies, pair, settings).map(|gap| TOUCH * gap)
}

/// The gap that a pair keeps at rest, metres; `None` if a body is not there or not solid.
fn rest_gap(bodies: &SolverBodies, pair: &Manifold, settings: &SolverSettings) -> Option<f32> {
    let [a, b] = pair.bodies.map(|i| bodies.bodies.get(i as usize));
    let (a, b) = (a?, b?);
    let solid = pair.bodies[0] != pair.bodies[1] && a.solid && b.solid;
    solid.then(|| settings.rest_offset * 2.0 * a.radius.min(b.radius))
}

/// The points of a pair; none if they are not there.
fn points_of<'a>(manifolds: &'a Manifolds, pair: &Manifold) -> &'a [ManifoldPoint] {
    let first = pair.first_point as usize;
    let range = first..first.saturating_add(pair.point_count as usize);
    manifolds.points.get(range).unwrap_or_default()
}

fn is_moving(bodies: &SolverBodies, i: usize) -> bool {
    speed(&bodies.bodies[i], &bodies.motions[i]) != 0.0
}

/// How fast the fastest point of the body's bounding sphere moves.
fn speed(body: &SolverBody, motion: &SolverMotion) -> f32 {
    motion.linear_velocity.length() + motion.angular_velocity.length() * body.radius
}

/// Mixes the bits of a key (the finaliser of SplitMix64: Steele et al., "Fast Splittable Pseudorandom Number Generators",
/// 2014), so that sums of them tell sets apart.
pub(crate) fn hash(key: u64) -> u64 {
    let x = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
