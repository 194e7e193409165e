//! What a step with contacts is told beside where the bodies are.

use super::lineage::Descent;
use super::lists::StepLists;
use crate::gpu::device::Gpu;
use crate::gpu::upload::Carried;
use crate::stages::manifolds::margins::SAFETY;
use crate::stages::solver::gpu::{Passes, Room, layout, upload};
use crate::stages::solver::{Interval, SolverBodies, SolverSettings};
use crate::stages::state::StepState;
use bytemuck::{bytes_of, cast_slice};

/// What the solver is told.
pub struct SolverInput {
    settings: SolverSettings,
    interval: Interval,
    /// Into how many intervals the step is cut.
    pub intervals: u32,
    bodies: Vec<layout::SolverBody>,
    arrivals: Vec<layout::BodyState>,
    forces: Vec<layout::BodyForces>,
    descent: Descent,
    /// How fast any body moves that the host tells of in this step, or is pushed to, m/s.
    pub told: f32,
}

impl SolverInput {
    /// Packs the bodies and half-spaces of `state`. Those that `carried` says go on with their velocities move no faster
    /// than `fastest`, m/s, but for what they are pushed by.
    pub fn new(state: &StepState, carried: &[Option<Carried>], fastest: f32, descent: Descent) -> Self {
        let StepState {
            config,
            meshes,
            bodies: placed,
            planes,
            ..
        } = state;
        let mut bodies = SolverBodies::default();
        bodies.read(placed, meshes, planes, &state.dynamics.keys_of(placed.len()));
        let mut unseen = 0.0;
        for (i, carried) in carried.iter().enumerate() {
            if let Some([linear, angular]) = carried.and_then(|carried| carried.push) {
                (bodies.motions[i].linear_velocity, bodies.motions[i].angular_velocity) = (linear, angular);
                unseen = fastest;
            }
        }
        let (known, thinnest) = SolverSettings::fastest_and_thinnest(&bodies);
        let intervals = config.solver.intervals(known + unseen, thinnest, config.dt);
        let pushed = (bodies.bodies.iter().zip(&bodies.forces))
            .map(|(body, forces)| {
                let turn = body.inverse_inertia * forces.angular_impulse;
                forces.impulse.length() * body.inverse_mass + turn.length() * body.radius
            })
            .fold(0.0, f32::max);
        let interval = Interval {
            dt: config.dt / intervals as f32,
            substeps: config.solver.substeps_per_detection(intervals),
            gravity: config.gravity,
        };
        let states = bodies.motions.iter().zip(&bodies.sleep).zip(&bodies.keys);
        let mut arrivals: Vec<_> = states.map(|((m, s), k)| upload::state(m, s, *k)).collect();
        if descent.new_ground {
            for plane in &mut arrivals[placed.len()..] {
                plane.asleep = layout::CHANGED;
            }
        }
        Self {
            settings: config.solver,
            interval,
            intervals,
            bodies: bodies.bodies.iter().map(upload::body).collect(),
            arrivals,
            forces: bodies.forces.iter().map(upload::forces).collect(),
            descent,
            told: known + pushed,
        }
    }

    /// The length of a detection interval, seconds.
    pub fn dt(&self) -> f32 {
        self.interval.dt
    }

    /// How far bodies look, as a time in which they move.
    pub fn look_ahead(&self) -> f32 {
        SAFETY * self.interval.dt
    }

    /// Of a body its number in the step before, and what goes on beside what `carried` says.
    pub fn source(&self, i: usize) -> (u32, u32) {
        self.descent.bodies[i]
    }

    /// What the interval's calls depend on.
    pub fn passes(&self) -> Passes {
        Passes::new(&self.settings, &self.interval)
    }

    /// How many bodies and half-spaces there are.
    pub fn room(&self) -> u32 {
        self.bodies.len() as u32
    }

    /// Whether half-spaces are others.
    pub fn new_ground(&self) -> bool {
        self.descent.new_ground
    }

    /// How many there were.
    pub fn old_bodies(&self) -> u32 {
        self.descent.renumbered.len() as u32
    }

    /// Writes everything.
    pub fn write(&self, gpu: &Gpu, lists: &StepLists, room: Room) {
        let count = self.room();
        let told = |old| upload::interval(&self.settings, &self.interval, [count, old], room);
        let same: Vec<u32> = (0..count).collect();
        for (buffer, bytes) in [
            (&lists.first_interval, bytes_of(&told(self.old_bodies()))),
            (&lists.other_interval, bytes_of(&told(count))),
            (&lists.first_numbers, cast_slice(&self.descent.renumbered)),
            (&lists.other_numbers, cast_slice(&same)),
            (&lists.bodies, cast_slice(&self.bodies)),
            (&lists.arrivals, cast_slice(&self.arrivals)),
            (&lists.forces, cast_slice(&self.forces)),
        ] {
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
    }
}
