//! The solver as stages of a step: what it keeps from one step to the next, and into how many intervals it cuts one.

use super::touches::Touches;
use crate::ccd::stops::Stops;
use crate::manifolds::Manifolds;
use crate::sleep::cpu::Sleeper;
use crate::solver::speeds::Speeds;
use crate::solver::{Interval, SleepState, Solver, SolverBodies, WarmStart};
use crate::state::margins::Margins;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Plane, StepConfig, StepState};
use crate::types::body::RigidBody;
use crate::types::settings::Response;
use glam::{Quat, Vec3};

/// What the solver works on.
#[derive(Default)]
pub struct Dynamics {
    /// What tells a body from others from step to step, ascending. If there are not as many as bodies, their numbers do.
    pub keys: Vec<u64>,
    /// What is kept from step to step.
    pub memory: Memory,
    /// The bodies, and after them the planes.
    pub bodies: SolverBodies,
    /// How far bodies look for each other in this step.
    pub(crate) margins: Margins,
    intervals: u32,
    /// For each of `bodies`: nothing about it can have changed since the last interval.
    still: Vec<bool>,
    has_still: bool,
    /// For each of the last step's bodies its number now, or `GONE`; empty from the second interval on, when all have the
    /// number they had.
    numbers: Vec<u32>,
    solver: Solver,
    sleeper: Sleeper,
    touches: Touches,
    stops: Stops,
}

const GONE: u32 = u32::MAX;

/// What is kept from step to step. With it and the bodies' motions a step can be repeated, to the bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory {
    /// The last step's bodies, ascending.
    keys: Vec<u64>,
    /// What is kept of each.
    bodies: Vec<Kept>,
    planes: Vec<Plane>,
    gravity: Vec3,
    warm: WarmStart,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Kept {
    sleep: SleepState,
    seen: Seen,
    /// It was stopped by others that it met.
    stopped: bool,
}

/// What of a body others, or the body itself, sleep by.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    mesh: u64,
    kind: RigidBody,
    position: Vec3,
    rotation: Quat,
    scale: Vec3,
    layers: [u32; 2],
    sensor: bool,
}

impl Dynamics {
    /// Into how many detection intervals the step is cut.
    pub fn intervals(&self) -> u32 {
        self.intervals.max(1)
    }

    /// What tells so many bodies from others: [`Dynamics::keys`], or their numbers.
    #[cfg(feature = "gpu")]
    pub(crate) fn keys_of(&self, bodies: usize) -> std::borrow::Cow<'_, [u64]> {
        if self.keys.len() == bodies {
            (&self.keys[..]).into()
        } else {
            (0..bodies as u64).collect()
        }
    }

    /// What holds for all bodies in a detection interval.
    pub(crate) fn interval(&self, config: &StepConfig) -> StepConfig {
        StepConfig {
            dt: config.dt / self.intervals() as f32,
            ..*config
        }
    }

    /// Whether nothing about a pair can have changed since the last interval: both sleep, or one does and the other is
    /// fixed.
    pub(crate) fn is_still(&self, [a, b]: [u32; 2]) -> bool {
        self.has_still && self.still[a as usize] && self.still[b as usize]
    }

    /// Whether there may be such pairs.
    pub(crate) fn has_still(&self) -> bool {
        self.has_still
    }

    /// The numbers that a pair of the last interval has now, if it is still there.
    pub(crate) fn renumbered(&self, pair: [u32; 2]) -> Option<[u32; 2]> {
        if self.numbers.is_empty() {
            return Some(pair);
        }
        let pair = pair.map(|i| self.numbers.get(i as usize).copied().unwrap_or(GONE));
        (!pair.contains(&GONE)).then_some(pair)
    }
}

/// Prepares the first interval of a step: who sleeps, how many intervals there are, how far bodies look.
pub(crate) fn begin(state: &mut StepState) {
    let StepState {
        config,
        meshes,
        bodies,
        planes,
        dynamics,
        ..
    } = state;
    dynamics.intervals = 1;
    dynamics.has_still = false;
    dynamics.touches.clear();
    dynamics.stops.forget();
    dynamics.margins = match config.response {
        Response::Impulse => Margins::None,
        Response::None => Margins::AtRest,
        Response::Contacts => {
            dynamics.read(bodies, meshes, planes, config.gravity);
            let speeds = Speeds::of(&dynamics.bodies, |_| false);
            dynamics.intervals = speeds.detections(&config.solver, &dynamics.bodies, config.dt);
            Margins::Moving {
                interval: dynamics.interval(config).dt,
                drift: speeds.drift(),
            }
        }
    };
    dynamics.margins.set_reach(bodies, config);
}

/// Finds who wakes, moves the bodies of `state.dynamics` by the points in `state.manifolds` over one interval, and finds
/// who falls asleep.
pub(crate) fn solve(state: &mut StepState) {
    let StepState {
        config,
        bodies: placed,
        manifolds,
        dynamics,
        ..
    } = state;
    let interval = Interval {
        dt: dynamics.interval(config).dt,
        substeps: config.solver.substeps_per_detection(dynamics.intervals()),
        gravity: config.gravity,
    };
    let settings = &config.solver;
    let Dynamics {
        memory,
        bodies,
        still,
        has_still,
        numbers,
        solver,
        sleeper,
        touches,
        ..
    } = dynamics;
    wake_on_new_ground(bodies, still, manifolds);
    sleeper.wake(bodies, manifolds, settings, &interval);
    solver.solve(bodies, manifolds, &mut memory.warm, settings, &interval);
    touches.note(placed, bodies, manifolds, settings, solver);
    sleeper.settle(bodies, manifolds, settings, interval.dt);
    // Who woke is looked at again in the next interval, and numbers stay.
    numbers.clear();
    if *has_still {
        for (i, still) in still.iter_mut().enumerate() {
            *still &= bodies.sleep[i].asleep || bodies.bodies[i].kind == RigidBody::Static;
        }
    }
}

/// Wakes bodies that touch something fixed which is not as it was.
fn wake_on_new_ground(bodies: &mut SolverBodies, still: &[bool], manifolds: &Manifolds) {
    for [a, b] in manifolds.pairs.iter().map(|pair| pair.bodies.map(|i| i as usize)) {
        for (sleeper, ground) in [(a, b), (b, a)] {
            if bodies.sleep[sleeper].asleep && bodies.bodies[ground].kind == RigidBody::Static && !still[ground] {
                bodies.sleep[sleeper] = SleepState::default();
            }
        }
    }
}

/// Puts the bodies where the solver moved them.
pub(crate) fn move_bodies(state: &mut StepState) {
    let StepState {
        config,
        meshes,
        bodies,
        planes,
        sphere_pairs,
        manifolds,
        dynamics,
        ..
    } = state;
    let interval = dynamics.interval(config);
    let Dynamics {
        bodies: moved,
        stops,
        touches,
        ..
    } = dynamics;
    let pass = |pair, contact| touches.pass(pair, contact);
    stops.stop(moved, manifolds, bodies, meshes, planes, sphere_pairs, &interval, pass);
    dynamics.bodies.write(bodies, meshes);
    dynamics.margins.set_reach(bodies, config);
}

/// Completes what the step reports, and keeps what the next one needs.
pub(crate) fn end(state: &mut StepState) {
    let StepState {
        config,
        meshes,
        bodies,
        planes,
        contacts,
        dynamics,
        asleep,
        intervals,
        ..
    } = state;
    *intervals = dynamics.intervals();
    asleep.clear();
    if config.response == Response::Contacts {
        let placed = &dynamics.bodies.sleep[..bodies.len()];
        asleep.extend(placed.iter().map(|sleep| sleep.asleep));
        dynamics.touches.tell(bodies.len() as u32, contacts);
        dynamics.keep(bodies, meshes, planes, config.gravity);
    } else {
        dynamics.memory = Memory::default();
        dynamics.bodies.clear();
    }
}

impl Dynamics {
    /// Takes the bodies of a step, and finds out who goes on sleeping.
    fn read(&mut self, bodies: &Bodies, meshes: &MeshArena, planes: &[Plane], gravity: Vec3) {
        if self.keys.len() != bodies.len() {
            self.keys.clear();
            self.keys.extend(0..bodies.len() as u64);
        }
        self.bodies.read(bodies, planes, &self.keys);
        let Memory {
            keys: old_keys,
            bodies: old,
            planes: old_planes,
            gravity: old_gravity,
            ..
        } = &self.memory;
        let all_wake = *old_gravity != gravity;
        self.still.clear();
        self.still.resize(self.bodies.len(), false);
        self.numbers.clear();
        self.numbers.resize(old.len(), GONE);
        let mut before = 0;
        for i in 0..bodies.len() {
            let key = self.keys[i];
            while old_keys.get(before).is_some_and(|&old| old < key) {
                before += 1;
            }
            if old_keys.get(before) != Some(&key) {
                continue;
            }
            self.numbers[before] = i as u32;
            let Kept {
                mut sleep,
                seen,
                stopped,
            } = old[before];
            let same = seen == Seen::new(bodies, meshes, i);
            let handling = &bodies.handling[i];
            if !handling.can_sleep || handling.woken && sleep.asleep || sleep.asleep && !same || all_wake {
                sleep = SleepState::default();
            }
            self.bodies.sleep[i] = sleep;
            // What has just met something is looked at as often as others: it will meet it again.
            self.bodies.bodies[i].continuous &= !stopped;
            let (motion, forces) = (&self.bodies.motions[i], &self.bodies.forces[i]);
            let rests = motion.linear_velocity == Vec3::ZERO && motion.angular_velocity == Vec3::ZERO;
            self.still[i] =
                same && (bodies.kind[i] == RigidBody::Static || (sleep.asleep && rests && forces.is_zero()));
            self.has_still |= sleep.asleep;
        }
        let first = bodies.len();
        let same_planes = old_planes == planes;
        for i in 0..planes.len() {
            self.still[first + i] = same_planes;
            self.numbers.push((first + i) as u32);
        }
    }

    fn keep(&mut self, bodies: &Bodies, meshes: &MeshArena, planes: &[Plane], gravity: Vec3) {
        let memory = &mut self.memory;
        memory.keys.clone_from(&self.keys);
        memory.bodies.clear();
        memory.bodies.extend((0..bodies.len()).map(|i| Kept {
            sleep: self.bodies.sleep[i],
            seen: Seen::new(bodies, meshes, i),
            stopped: self.stops.has_stopped(i),
        }));
        planes.clone_into(&mut memory.planes);
        memory.gravity = gravity;
    }
}

impl Seen {
    fn new(bodies: &Bodies, meshes: &MeshArena, i: usize) -> Self {
        let layers = bodies.layers[i];
        Self {
            mesh: meshes[bodies.mesh[i]].version,
            kind: bodies.kind[i],
            position: bodies.position[i],
            rotation: bodies.rotation[i],
            scale: bodies.scale[i],
            layers: [layers.memberships, layers.filters],
            sensor: bodies.sensor[i],
        }
    }
}
