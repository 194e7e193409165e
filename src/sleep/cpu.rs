//! Sleep on the CPU: islands of bodies at rest, found by union-find over touching pairs.

use super::rest::{self, speed};
use crate::geometry::union_find::UnionFind;
use crate::solver::CollisionSubstep;
use crate::solver::bodies::SolverBodies;
use crate::state::inactive::InactiveBodies;
use crate::state::{Manifold, ManifoldPoint, Manifolds};
use crate::types::body::RigidBody;
use crate::types::solver_settings::SolverSettings;
use glam::Vec3;

/// Bodies touch if the gap between their surfaces is at most this many rest offsets. At rest it is at most
/// one.
pub(crate) const TOUCH: f32 = 4.0;

/// Bodies that overlap by more than this many rest offsets are not at rest, however slow they are: the solver is still
/// pushing them apart.
pub(crate) const OVERLAP: f32 = 4.0;

/// Puts islands of bodies to sleep and wakes them. It holds only scratch memory: the sleep state of the bodies is in
/// [`SolverBodies::sleep`].
///
/// In every collision substep, call [`Sleeper::wake`] before [`Solver::solve`](crate::solver::Solver::solve) and
/// [`Sleeper::settle`] after it. The manifolds must include the pairs of sleeping bodies. As these do not move, their
/// manifolds of the last collision substep are valid (see [`Sleeper::is_inactive`]).
#[derive(Clone, Debug, Default)]
pub struct Sleeper {
    islands: UnionFind,
    /// The colliders that each body touches, as the sum of hashes of their keys.
    neighbours: Vec<u32>,
    /// For the root of each island: the island stays awake, or must wake.
    awake: Vec<bool>,
}

impl Sleeper {
    /// Whether the pair of bodies `a` and `b` is unchanged since the last collision substep: both are asleep, or one is
    /// asleep and the other is static.
    pub fn is_inactive(bodies: &SolverBodies, a: u32, b: u32) -> bool {
        let [asleep, is_static] = [
            [a, b].map(|i| bodies.sleep[i as usize].asleep),
            [a, b].map(|i| bodies.bodies[i as usize].kind == RigidBody::Static),
        ];
        (asleep[0] && (asleep[1] || is_static[1])) || (asleep[1] && is_static[0])
    }

    /// Wakes whole islands. An island wakes if one of its bodies
    /// * has received a velocity, force or impulse,
    /// * touches an awake body or a moving kinematic one, or will within the collision substep,
    /// * touches different bodies than when it fell asleep.
    pub fn wake(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        collision_substep: &CollisionSubstep,
    ) {
        let &CollisionSubstep { dt, gravity, .. } = collision_substep;
        self.wake_each(bodies, manifolds, settings, gravity, |_| dt);
    }

    /// Wakes islands as [`Self::wake`] does, where body `i` moves for `dt(i)` seconds in the collision substep.
    pub(crate) fn wake_each(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        gravity: Vec3,
        dt: impl Fn(u32) -> f32,
    ) {
        if !bodies.movers().any(|i| bodies.sleep[i].asleep) {
            return;
        }
        if !settings.sleeping {
            bodies.for_each_mover(|bodies, i| bodies.sleep[i] = Default::default());
            return;
        }
        self.find_islands(bodies, manifolds, settings);
        for i in bodies.movers() {
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
                let root = self.islands.root(i as u32);
                self.awake[root as usize] = true;
            }
        }
        self.mark_approached(bodies, manifolds, settings, gravity, dt);
        let Self { islands, awake, .. } = self;
        bodies.for_each_mover(|bodies, i| {
            let root = islands.root(i as u32);
            if bodies.sleep[i].asleep && awake[root as usize] {
                bodies.sleep[i] = Default::default();
            }
        });
        bodies.share_sleep();
    }

    /// Advances the rest times by a collision substep of `dt` seconds, and puts islands to sleep whose bodies all have
    /// been at rest for [`SolverSettings::sleep_time`].
    ///
    /// A body is at rest if it goes nowhere, as `rest` tells, and overlaps nothing. Its velocity alone is not enough,
    /// because the relax passes remove the velocity with which the bias passes push bodies apart. What touches nothing
    /// is at rest only if it does not move at all. A body that was not at rest before this collision substep, such as
    /// one that woke in it, stays awake until the next: it may have moved, so its contact points must be found anew.
    pub fn settle(&mut self, bodies: &mut SolverBodies, manifolds: &Manifolds, settings: &SolverSettings, dt: f32) {
        self.settle_each(bodies, manifolds, settings, |_| dt);
    }

    /// Settles bodies as [`Self::settle`] does, where body `i` has moved for `dt(i)` seconds in the collision substep.
    pub(crate) fn settle_each(
        &mut self,
        bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        dt: impl Fn(usize) -> f32,
    ) {
        if !settings.sleeping {
            return;
        }
        bodies.for_each_mover(|bodies, i| {
            rest::advance(
                &mut bodies.sleep[i],
                &bodies.bodies[i],
                &bodies.motions[i],
                dt(i),
                settings,
            );
        });
        for pair in &manifolds.pairs {
            if overlaps(bodies, manifolds, pair, settings) {
                for i in pair.bodies.map(|i| bodies.body_of(i) as usize) {
                    bodies.sleep[i].rest_time = 0.0;
                }
            }
        }
        let ready = |bodies: &SolverBodies, i: usize| {
            let (sleep, forces) = (&bodies.sleep[i], &bodies.forces[i]);
            let was_at_rest = sleep.rest_time > dt(i);
            sleep.asleep || (was_at_rest && sleep.rest_time >= settings.sleep_time && forces.is_zero())
        };
        if !bodies
            .movers()
            .any(|i| bodies.bodies[i].has_mass() && !bodies.sleep[i].asleep && ready(bodies, i))
        {
            return;
        }
        self.find_islands(bodies, manifolds, settings);
        for i in bodies.movers() {
            let body = &bodies.bodies[i];
            let floats = || self.neighbours[i] == 0 && rest::floats(&bodies.sleep[i], body);
            if body.kind == RigidBody::Dynamic && (!ready(bodies, i) || floats()) {
                let root = self.islands.root(i as u32);
                self.awake[root as usize] = true;
            }
        }
        self.mark_driven(bodies, manifolds, settings);
        let Self {
            islands,
            awake,
            neighbours,
        } = self;
        bodies.for_each_mover(|bodies, i| {
            let root = islands.root(i as u32);
            let at_rest = !awake[root as usize];
            if at_rest && bodies.bodies[i].has_mass() && !bodies.sleep[i].asleep {
                let sleep = &mut bodies.sleep[i];
                sleep.asleep = true;
                sleep.neighbours = neighbours[i];
                bodies.motions[i].linear_velocity = Vec3::ZERO;
                bodies.motions[i].angular_velocity = Vec3::ZERO;
            }
        });
        bodies.share_sleep();
    }

    /// Joins dynamic bodies that touch into islands, and sums the hashes of the bodies that each body touches.
    fn find_islands(&mut self, bodies: &SolverBodies, manifolds: &Manifolds, settings: &SolverSettings) {
        let count = bodies.len();
        self.islands.reset_members(count, bodies.movers());
        self.neighbours.resize(count, 0);
        self.awake.resize(count, false);
        bodies
            .movers()
            .for_each(|i| (self.neighbours[i], self.awake[i]) = (0, false));
        for pair in &manifolds.pairs {
            if !touches(bodies, manifolds, pair, settings) {
                continue;
            }
            let keys = pair.bodies.map(|i| bodies.keys[i as usize]);
            let [a, b] = pair.bodies.map(|i| bodies.body_of(i));
            // Wrapping sums do not depend on the order of pairs.
            for (body, other) in [(a, keys[1]), (b, keys[0])] {
                let sum = &mut self.neighbours[body as usize];
                *sum = sum.wrapping_add(hash(other));
            }
            if [a, b].iter().all(|&i| bodies.bodies[i as usize].has_mass()) {
                self.islands.join(a, b);
            }
        }
    }

    /// Marks the islands that touch a moving kinematic body, or a surface that moves along itself: a conveyor belt.
    fn mark_driven(&mut self, bodies: &SolverBodies, manifolds: &Manifolds, settings: &SolverSettings) {
        for pair in &manifolds.pairs {
            if touches(bodies, manifolds, pair, settings) {
                let surface = manifolds.surface_of(pair.bodies);
                let is_belt = surface.is_some_and(|surface| surface.tangent_velocity != Vec3::ZERO);
                self.mark_other(bodies, pair, |bodies, i| {
                    is_belt || (bodies.bodies[i].kind == RigidBody::Kinematic && is_moving(bodies, i))
                });
            }
        }
    }

    /// Marks the islands that a body will reach by the end of the collision substep, if it is kinematic and moves, or
    /// dynamic and not slow: asleep, they would react to the impact as if they were static.
    fn mark_approached(
        &mut self,
        bodies: &SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        gravity: Vec3,
        dt: impl Fn(u32) -> f32,
    ) {
        for pair in &manifolds.pairs {
            let Some(distance) = touch_distance(bodies, pair, settings) else {
                continue;
            };
            let dt = pair.bodies.map(&dt).into_iter().fold(0.0, f32::max);
            let fall = gravity.length() * dt;
            let will_touch = |p: &ManifoldPoint| {
                let [a, b] = [0, 1].map(|side| {
                    let motion = &bodies.motions[bodies.body_of(pair.bodies[side]) as usize];
                    motion.linear_velocity + motion.angular_velocity.cross(p.anchors[side])
                });
                p.gap() - ((a - b).dot(p.normal).max(0.0) + fall) * dt <= distance
            };
            if points_of(manifolds, pair).iter().any(will_touch) {
                self.mark_other(bodies, pair, |bodies, i| match bodies.bodies[i].kind {
                    RigidBody::Static => false,
                    RigidBody::Kinematic => is_moving(bodies, i),
                    // Two islands that come to rest beside each other must not wake each other in turn.
                    RigidBody::Dynamic => {
                        !bodies.sleep[i].asleep && speed(&bodies.bodies[i], &bodies.motions[i]) >= settings.sleep_speed
                    }
                });
            }
        }
    }

    /// Marks the island of each body of `pair` whose other body `disturbs` it.
    fn mark_other(&mut self, bodies: &SolverBodies, pair: &Manifold, disturbs: impl Fn(&SolverBodies, usize) -> bool) {
        let [a, b] = pair.bodies.map(|i| bodies.body_of(i));
        for (one, other) in [(a, b), (b, a)] {
            if bodies.bodies[other as usize].moves() && disturbs(bodies, one as usize) {
                let root = self.islands.root(other);
                self.awake[root as usize] = true;
            }
        }
    }
}

/// Wakes bodies that touch a static or kinematic body that has changed.
pub(crate) fn wake_on_changed_support(bodies: &mut SolverBodies, inactive: &InactiveBodies, manifolds: &Manifolds) {
    for [a, b] in manifolds.pairs.iter().map(|pair| pair.bodies) {
        for (sleeper, support) in [(a, b), (b, a)] {
            let sleeper = bodies.body_of(sleeper) as usize;
            let has_changed = match bodies.bodies[support as usize].kind {
                RigidBody::Static => !inactive.flags[support as usize],
                RigidBody::Kinematic => inactive.replaced.binary_search(&support).is_ok(),
                RigidBody::Dynamic => false,
            };
            if bodies.sleep[sleeper].asleep && has_changed {
                bodies.sleep[sleeper] = Default::default();
            }
        }
    }
}

/// Whether both bodies exist and are solid, and some point is within the touch distance.
fn touches(bodies: &SolverBodies, manifolds: &Manifolds, pair: &Manifold, settings: &SolverSettings) -> bool {
    touch_distance(bodies, pair, settings)
        .is_some_and(|distance| points_of(manifolds, pair).iter().any(|p| p.gap() <= distance))
}

/// Whether both bodies exist and are solid, and overlap too deeply to be at rest.
fn overlaps(bodies: &SolverBodies, manifolds: &Manifolds, pair: &Manifold, settings: &SolverSettings) -> bool {
    rest_gap(bodies, pair, settings).is_some_and(|gap| {
        let mut points = points_of(manifolds, pair).iter();
        points.any(|p| p.gap() < -OVERLAP * gap)
    })
}

/// The largest separation at which a pair touches, metres; `None` if a body does not exist or is not solid.
fn touch_distance(bodies: &SolverBodies, pair: &Manifold, settings: &SolverSettings) -> Option<f32> {
    rest_gap(bodies, pair, settings).map(|gap| TOUCH * gap)
}

/// The gap of a pair at rest, metres; `None` if a body does not exist or is not solid.
fn rest_gap(bodies: &SolverBodies, pair: &Manifold, settings: &SolverSettings) -> Option<f32> {
    let [a, b] = pair.bodies.map(|i| bodies.bodies.get(i as usize));
    let (a, b) = (a?, b?);
    let [one, other] = pair.bodies.map(|i| bodies.body_of(i));
    let solid = one != other && a.solid && b.solid;
    solid.then(|| settings.rest_offset * 2.0 * a.radius.min(b.radius))
}

/// The points of a pair; none if its range exceeds the list.
fn points_of<'a>(manifolds: &'a Manifolds, pair: &Manifold) -> &'a [ManifoldPoint] {
    let first = pair.first_point as usize;
    let range = first..first.saturating_add(pair.point_count as usize);
    manifolds.points.get(range).unwrap_or_default()
}

fn is_moving(bodies: &SolverBodies, i: usize) -> bool {
    speed(&bodies.bodies[i], &bodies.motions[i]) != 0.0
}

/// Hash of a key (the finaliser of SplitMix64: Steele et al., "Fast Splittable Pseudorandom Number Generators", 2014).
/// Sums of such hashes differ for different sets of keys, but for one in four billion.
pub(crate) fn hash(key: u64) -> u32 {
    let x = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) as u32
}
