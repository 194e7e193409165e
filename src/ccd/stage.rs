//! Continuous collision detection as part of a step: stops fast bodies at their first impact, and finds the sensors on
//! their paths.

use super::{Impact, ImpactScratch, Pose, SensorScratch, Sweep, find_impacts, find_sensor_touches};
use crate::solver::{SolverBodies, SolverMotion};
use crate::state::bodies::invert_inertia;
use crate::state::manifolds::nearest;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact, Manifolds, Plane, StepConfig};
use std::f64::consts::TAU;

/// The distance at which bodies are stopped, as a fraction of the gap between bodies at rest. It is smaller than that
/// gap, so that bodies that slide along each other are not stopped.
const TARGET_DISTANCE: f32 = 0.25;

/// Bodies with a smaller gap than this touch, in units of the target distance: one and a half times the gap of bodies
/// at rest.
const TOUCHING: f32 = 1.5 / TARGET_DISTANCE;

/// Impacts of the step so far, and memory that is reused.
#[derive(Default)]
pub(crate) struct Ccd {
    /// The bodies of the pairs, ascending.
    members: Vec<u32>,
    /// By number of body.
    sweeps: Vec<Sweep>,
    continuous: Vec<bool>,
    pairs: Vec<[u32; 2]>,
    impact_scratch: ImpactScratch,
    /// The impacts of the last collision substep.
    impacts: Vec<Impact>,
    /// For each body, whether it had an impact in any collision substep of the step.
    had_impact: Vec<bool>,
    sensor_pairs: Vec<[u32; 2]>,
    sensor_scratch: SensorScratch,
    sensor_touches: Vec<Option<Contact>>,
}

impl Ccd {
    /// Clears the impacts, at the beginning of a step.
    pub fn clear(&mut self) {
        self.had_impact.clear();
    }

    /// The impacts of the last collision substep, in the order of bodies.
    #[cfg(feature = "gpu")]
    pub fn impacts(&self) -> &[Impact] {
        &self.impacts
    }

    /// Whether body `i` had an impact in the step.
    pub fn had_impact(&self, i: usize) -> bool {
        self.had_impact.get(i) == Some(&true)
    }

    /// Moves continuous `solver_bodies` with an impact in the collision substep back to the pose after the impact.
    ///
    /// `bodies` have the poses from the start of the collision substep, and `manifolds` the contact points. `pairs` are
    /// the pairs whose paths may cross. Pairs that overlap are left to contacts, and `dropped` pairs pass through each
    /// other, also pairs with planes. Calls `on_sensor_touch` with each pair of a sensor and another body, one of them
    /// continuous, that touch on their paths, and with the first contact.
    pub fn run(
        &mut self,
        solver_bodies: &mut SolverBodies,
        manifolds: &Manifolds,
        bodies: &Bodies,
        meshes: &MeshArena,
        planes: &[Plane],
        pairs: &[[u32; 2]],
        dropped: impl Fn([u32; 2]) -> bool,
        config: &StepConfig,
        mut on_sensor_touch: impl FnMut([u32; 2], Contact),
    ) {
        let Self {
            members,
            sweeps,
            continuous,
            pairs: solid_pairs,
            impact_scratch,
            impacts,
            had_impact,
            sensor_pairs,
            sensor_scratch,
            sensor_touches,
        } = self;
        impacts.clear();
        let is_flagged = |i: u32| bodies.params[i as usize].continuous;
        if !pairs.iter().flatten().any(|&i| is_flagged(i)) {
            return;
        }
        continuous.clear();
        continuous.resize(bodies.len(), false);
        let flagged = bodies.movers().filter(|&i| bodies.params[i].continuous);
        flagged.for_each(|i| continuous[i] = solver_bodies.bodies[i].has_mass());
        let body_of = |i: u32| bodies.body_of(i);
        let solid = |&i: &u32| solver_bodies.bodies[i as usize].solid;
        sensor_pairs.clear();
        let has_sensor = |pair: &[u32; 2]| !pair.iter().all(solid) && pair.iter().any(|&i| is_flagged(i));
        sensor_pairs.extend(pairs.iter().copied().filter(has_sensor));
        solid_pairs.clear();
        let can_collide = |pair: &[u32; 2]| {
            pair.iter().all(solid) && pair.iter().any(|&i| continuous[body_of(i) as usize]) && !dropped(*pair)
        };
        let target_distance = |pair: [u32; 2]| {
            let [a, b] = pair.map(|i| bodies.radius[i as usize]);
            TARGET_DISTANCE * config.solver.rest_offset * 2.0 * a.min(b)
        };
        let overlap = |pair: [u32; 2]| {
            nearest(manifolds.find(pair, bodies.len() as u32))
                .is_some_and(|point| point.separation < -target_distance(pair))
        };
        let touches = |pair: [u32; 2]| {
            let point = nearest(manifolds.find(pair, bodies.len() as u32))?;
            (point.separation < TOUCHING * target_distance(pair)).then(|| point.normal.as_dvec3())
        };
        solid_pairs.extend(pairs.iter().copied().filter(can_collide).filter(|&pair| !overlap(pair)));
        if solid_pairs.is_empty() && sensor_pairs.is_empty() {
            return;
        }
        // Sweeps of bodies in no pair are not needed and keep their old values.
        sweeps.resize(bodies.len(), Sweep::default());
        members.clear();
        members.extend(solid_pairs.iter().chain(&*sensor_pairs).flatten().map(|&i| body_of(i)));
        members.sort_unstable();
        members.dedup();
        for &body in members.iter() {
            sweeps[body as usize] = sweep(bodies, solver_bodies, body as usize);
        }
        find_impacts(
            bodies,
            meshes,
            planes,
            &dropped,
            sweeps,
            continuous,
            solid_pairs,
            target_distance,
            touches,
            impact_scratch,
            impacts,
        );
        find_sensor_touches(
            bodies,
            meshes,
            sweeps,
            impacts,
            sensor_pairs,
            sensor_scratch,
            sensor_touches,
        );
        for (&pair, touch) in sensor_pairs.iter().zip(&*sensor_touches) {
            if let Some(contact) = *touch {
                on_sensor_touch(pair, contact);
            }
        }
        for impact in impacts.iter() {
            let i = impact.body as usize;
            had_impact.resize(bodies.len(), false);
            had_impact[i] = true;
            let motion = &mut solver_bodies.motions[i];
            (motion.center, motion.rotation) = (impact.end.center, impact.end.rotation);
            take_unearned(motion, bodies, config, impact, &sweeps[i]);
        }
        // A body without any motion before its impact has come nearer in each collision substep, because the target
        // distance is halved. It is moved back to the full distance, so that it can move again.
        let is_stuck = |i: u32| {
            let at = impacts.binary_search_by_key(&i, |impact| impact.body);
            at.is_ok_and(|at| impacts[at].fraction == 0.0)
        };
        for &pair in solid_pairs.iter() {
            let stuck = pair.map(|i| is_stuck(body_of(i)));
            if stuck == [false; 2] {
                continue;
            }
            let Some(point) = nearest(manifolds.find(pair, bodies.len() as u32)) else {
                continue;
            };
            let correction = (target_distance(pair) - point.separation).max(0.0) * point.normal;
            for (side, offset) in [-correction, correction].into_iter().enumerate() {
                if stuck[side] {
                    solver_bodies.motions[body_of(pair[side]) as usize].center += offset.as_dvec3();
                }
            }
        }
    }
}

/// Takes from a body the energy that gravity and the external force gave it for a path that it has not travelled,
/// because another body held it after its impact.
fn take_unearned(motion: &mut SolverMotion, bodies: &Bodies, config: &StepConfig, impact: &Impact, sweep: &Sweep) {
    let i = impact.body as usize;
    let (fraction, left) = (f64::from(impact.fraction), 1.0 - f64::from(impact.fraction));
    let held = left * f64::from(bodies.travel_time[i]);
    if held <= 0.0 {
        return;
    }
    // Relative to what holds it, or along which it slides.
    let way = impact.end.center - sweep.at(fraction).center;
    let acceleration = bodies.acceleration(i, config.gravity).as_dvec3();
    // Energies are per kilogram.
    let unearned = acceleration.dot(left * sweep.travel - way);
    let carried = way / held;
    let velocity = motion.linear_velocity.as_dvec3() - carried;
    let spin = motion.angular_velocity.as_dvec3();
    let inertia = invert_inertia(bodies.inverse_inertia[i].as_dmat3()) * f64::from(bodies.inverse_mass[i]);
    let kinetic = 0.5 * (velocity.length_squared() + spin.dot(inertia * spin));
    if unearned > 0.0 && kinetic > 0.0 {
        let kept = (1.0 - unearned / kinetic).max(0.0).sqrt();
        motion.linear_velocity = (carried + kept * velocity).as_vec3();
        motion.angular_velocity = (kept * spin).as_vec3();
    }
}

/// The motion of body `i` from its pose in `bodies` to that in `solver_bodies`.
fn sweep(bodies: &Bodies, solver_bodies: &SolverBodies, i: usize) -> Sweep {
    let before = Pose::of(bodies, i);
    let motion = &solver_bodies.motions[i];
    let after = Pose {
        center: motion.center,
        rotation: motion.rotation,
    };
    let sweep = Sweep::between(before, after);
    // Poses do not determine the number of revolutions. The angular velocity does.
    let Some(axis) = sweep.turn.try_normalize() else {
        return sweep;
    };
    let angle = motion.angular_velocity.as_dvec3().dot(axis) * f64::from(bodies.travel_time[i]);
    let revolutions = ((angle - sweep.turn.length()) / TAU).round();
    Sweep {
        turn: sweep.turn + axis * (revolutions * TAU),
        ..sweep
    }
}
