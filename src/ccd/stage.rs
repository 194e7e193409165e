//! Where bodies are stopped that are fast, so that they do not pass what is thin, and which sensors they pass.

use crate::ccd::{ClampScratch, PassScratch, Pose, Stop, Sweep, clamp, passes};
use crate::solver::SolverBodies;
use crate::state::manifolds::nearest;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact, Manifolds, Plane, StepConfig};
use std::f64::consts::TAU;

/// How near bodies come before they are stopped, as a part of the gap that bodies at rest keep: what slides along another must
/// not be stopped.
const SLACK: f32 = 0.25;

/// Memory kept between intervals.
#[derive(Default)]
pub(crate) struct Stops {
    sweeps: Vec<Sweep>,
    continuous: Vec<bool>,
    pairs: Vec<[u32; 2]>,
    scratch: ClampScratch,
    /// Those of the last interval.
    found: Vec<Stop>,
    /// Those who were stopped in any interval of the step.
    stopped: Vec<bool>,
    sensor_pairs: Vec<[u32; 2]>,
    pass_scratch: PassScratch,
    touched: Vec<Option<Contact>>,
}

impl Stops {
    /// Forgets who was stopped, at the beginning of a step.
    pub fn forget(&mut self) {
        self.stopped.clear();
    }

    /// Whether body `i` was stopped in the step.
    pub fn has_stopped(&self, i: usize) -> bool {
        self.stopped.get(i) == Some(&true)
    }

    /// Puts those of the `moved` bodies that are continuous to where they are stopped by others, if they are, after an
    /// interval of a step. `bodies` are where they all were before, and `manifolds` how they lay; `pairs` those whose ways
    /// may cross. Contacts alone look after those that overlap. Calls `pass` with the pairs of a sensor and another body, of which
    /// one is continuous, that touch on their ways, and with where they first do.
    pub fn stop(
        &mut self,
        moved: &mut SolverBodies,
        manifolds: &Manifolds,
        bodies: &Bodies,
        meshes: &MeshArena,
        planes: &[Plane],
        pairs: &[[u32; 2]],
        interval: &StepConfig,
        mut pass: impl FnMut([u32; 2], Contact),
    ) {
        let Self {
            sweeps,
            continuous,
            pairs: solid_pairs,
            scratch,
            found,
            stopped,
            sensor_pairs,
            pass_scratch,
            touched,
        } = self;
        found.clear();
        let flagged = |i: u32| bodies.params[i as usize].continuous;
        if !(0..bodies.len() as u32).any(flagged) {
            return;
        }
        continuous.clear();
        continuous.extend((0..bodies.len() as u32).map(|i| flagged(i) && moved.bodies[i as usize].has_mass()));
        let solid = |&i: &u32| moved.bodies[i as usize].solid;
        sensor_pairs.clear();
        let passes_sensor = |pair: &[u32; 2]| !pair.iter().all(solid) && pair.iter().any(|&i| flagged(i));
        sensor_pairs.extend(pairs.iter().copied().filter(passes_sensor));
        solid_pairs.clear();
        let matters = |pair: &[u32; 2]| pair.iter().all(solid) && pair.iter().any(|&i| continuous[i as usize]);
        let slack = |pair: [u32; 2]| {
            let [a, b] = pair.map(|i| bodies.radius[i as usize]);
            SLACK * interval.solver.rest_offset * 2.0 * a.min(b)
        };
        let overlap = |pair: [u32; 2]| {
            nearest(manifolds.find(pair, bodies.len() as u32)).is_some_and(|point| point.separation < -slack(pair))
        };
        solid_pairs.extend(pairs.iter().copied().filter(matters).filter(|&pair| !overlap(pair)));
        if solid_pairs.is_empty() && sensor_pairs.is_empty() {
            return;
        }
        let dt = f64::from(interval.dt);
        sweeps.clear();
        sweeps.extend((0..bodies.len()).map(|i| sweep(bodies, moved, i, dt)));
        clamp(
            bodies,
            meshes,
            planes,
            sweeps,
            continuous,
            solid_pairs,
            slack,
            scratch,
            found,
        );
        passes(bodies, meshes, sweeps, found, sensor_pairs, pass_scratch, touched);
        for (&pair, touched) in sensor_pairs.iter().zip(&*touched) {
            if let Some(contact) = *touched {
                pass(pair, contact);
            }
        }
        for stop in found.iter() {
            let i = stop.body as usize;
            stopped.resize(bodies.len(), false);
            stopped[i] = true;
            (moved.motions[i].center, moved.motions[i].rotation) = (stop.end.center, stop.end.rotation);
        }
        // Who cannot move at all has been stopped ever nearer, and gets the room back without which it could never be.
        let is_stuck = |i: u32| {
            let at = found.binary_search_by_key(&i, |stop| stop.body);
            at.is_ok_and(|at| found[at].fraction == 0.0)
        };
        for &pair in solid_pairs.iter() {
            let stuck = pair.map(is_stuck);
            if stuck == [false; 2] {
                continue;
            }
            let Some(point) = nearest(manifolds.find(pair, bodies.len() as u32)) else {
                continue;
            };
            let room = (slack(pair) - point.separation).max(0.0) * point.normal;
            for (end, away) in [-room, room].into_iter().enumerate() {
                if stuck[end] {
                    moved.motions[pair[end] as usize].center += away.as_dvec3();
                }
            }
        }
    }
}

/// How a body went from where it was to where it is now.
fn sweep(bodies: &Bodies, moved: &SolverBodies, i: usize, dt: f64) -> Sweep {
    let before = Pose {
        center: bodies.frame[i].center,
        rotation: bodies.rotation[i].as_dquat().normalize(),
    };
    let motion = &moved.motions[i];
    let after = Pose {
        center: motion.center,
        rotation: motion.rotation,
    };
    let sweep = Sweep::between(before, after);
    // Poses do not tell how often a body turned; its angular velocity does.
    let Some(axis) = sweep.turn.try_normalize() else {
        return sweep;
    };
    let turned = motion.angular_velocity.as_dvec3().dot(axis) * dt;
    let whole_turns = ((turned - sweep.turn.length()) / TAU).round();
    Sweep {
        turn: sweep.turn + axis * (whole_turns * TAU),
        ..sweep
    }
}
