//! What a step with contacts is told beside where the bodies are.

use super::buffers::StepBuffers;
use super::lineage::Descent;
use crate::gpu::device::Gpu;
use crate::sleep::cpu::hash;
use crate::solver::gpu::{Passes, Room, layout, upload};
use crate::solver::speeds::Speeds;
use crate::solver::{CollisionSubstep, SolverBodies};
use crate::state::StepInput;
use crate::state::margins::SAFETY;
use crate::step::gpu::upload::Carried;
use crate::types::body::RigidBody;
use crate::types::solver_settings::SolverSettings;
use bytemuck::{bytes_of, cast_slice};
use glam::Vec3;

/// What the solver is told.
pub struct SolverInput {
    settings: SolverSettings,
    interval: CollisionSubstep,
    /// Into how many intervals the step is cut.
    pub collision_substeps: u32,
    bodies: Vec<layout::SolverBody>,
    arrivals: Vec<layout::BodyState>,
    forces: Vec<layout::BodyForces>,
    descent: Descent,
    /// The velocity that bodies have in common, m/s.
    pub drift: Vec3,
    /// What it says of motions.
    pub told: Told,
}

/// What the host tells a device of motions in one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told {
    /// Of bodies whose velocities it sets.
    pub speeds: Speeds,
    /// How much faster any point of a body may get by what acts on it in the step, or is added to its velocity, m/s.
    pub push: f32,
}

impl SolverInput {
    /// Packs the bodies and half-spaces of `state`. Those that `carried` says go on with their velocities have `speeds`, but
    /// for what they are pushed by.
    pub fn new(state: &StepInput, carried: &[Option<Carried>], speeds: Speeds, descent: Descent) -> Self {
        let StepInput {
            config,
            bodies: placed,
            planes,
            ..
        } = state;
        let mut bodies = SolverBodies::default();
        let mut keys = Vec::new();
        state.write_keys(&mut keys);
        bodies.read(placed, planes, &keys);
        let unseen = |i: usize| unseen(carried, i).filter(|_| placed.kind.get(i) != Some(&RigidBody::Static));
        let mut seen = Speeds::of(&bodies, |i| unseen(i).is_some());
        let mut added = 0.0f32;
        let mut goes_on = Speeds::NONE;
        for (i, Carried { linear, angular, .. }) in (0..placed.len()).filter_map(|i| Some((i, unseen(i)?))) {
            let motion = &mut bodies.motions[i];
            seen.add_along(!linear.axes, motion.linear_velocity);
            motion.linear_velocity = linear.told(motion.linear_velocity);
            motion.angular_velocity = angular.told(motion.angular_velocity);
            let spin = motion.angular_velocity.length() * placed.unpadded_radius[i];
            let push = Vec3::select(linear.axes, linear.push, Vec3::ZERO).length();
            if angular.axes.any() {
                added = added.max(push + spin);
            } else {
                added = added.max(push);
                seen.spin_up(spin);
            }
            goes_on = speeds;
        }
        let all = seen.and(goes_on).after(added, Vec3::ZERO);
        let collision_substeps = all.collision_substeps(&config.solver, &bodies, config.dt);
        let pushed = (bodies.bodies.iter().zip(&bodies.forces))
            .map(|(body, forces)| {
                let turn = body.inverse_inertia * forces.angular_impulse;
                forces.impulse.length() * body.inverse_mass + turn.length() * body.radius
            })
            .fold(0.0, f32::max);
        let interval = CollisionSubstep::of(config, collision_substeps);
        let states = bodies.motions.iter().zip(&bodies.sleep).zip(&bodies.keys);
        let mut arrivals: Vec<_> = states.map(|((m, s), k)| upload::state(m, s, hash(*k) as u32)).collect();
        if descent.new_ground {
            for plane in &mut arrivals[placed.len()..] {
                plane.asleep = layout::CHANGED;
            }
        }
        Self {
            settings: config.solver,
            interval,
            collision_substeps,
            bodies: bodies.bodies.iter().map(upload::body).collect(),
            arrivals,
            forces: bodies.forces.iter().map(upload::forces).collect(),
            descent,
            drift: all.drift(),
            told: Told {
                speeds: seen,
                push: added + pushed,
            },
        }
    }

    /// The length of a collision substep, seconds.
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
    pub fn write(&self, gpu: &Gpu, step: &StepBuffers, room: Room) {
        let count = self.room();
        let told = |old| upload::interval(&self.settings, &self.interval, [count, old], room);
        let same: Vec<u32> = (0..count).collect();
        for (buffer, bytes) in [
            (&step.first_interval, bytes_of(&told(self.old_bodies()))),
            (&step.other_interval, bytes_of(&told(count))),
            (&step.first_numbers, cast_slice(&self.descent.renumbered)),
            (&step.other_numbers, cast_slice(&same)),
            (&step.solver_bodies, cast_slice(&self.bodies)),
            (&step.arrivals, cast_slice(&self.arrivals)),
            (&step.forces, cast_slice(&self.forces)),
        ] {
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
    }
}

/// What goes on of a body with velocities, or a part of them, that the host need not know.
fn unseen(carried: &[Option<Carried>], i: usize) -> Option<Carried> {
    let goes_on = |carried: &Carried| carried.linear.axes.any() || carried.angular.axes.any();
    carried.get(i).copied().flatten().filter(goes_on)
}
