//! What a step with contacts is told beside where the bodies are.

use super::buffers::StepBuffers;
use super::remap::BodyRemap;
use crate::gpu::device::Gpu;
use crate::sleep::cpu::hash;
use crate::solver::gpu::{Passes, SolverCapacity, layout, upload};
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
    collision_substep: CollisionSubstep,
    /// Into how many intervals the step is cut.
    pub collision_substeps: u32,
    bodies: Vec<layout::SolverBody>,
    host_states: Vec<layout::MotionState>,
    forces: Vec<layout::BodyForces>,
    remap: BodyRemap,
    /// The velocity that bodies have in common, m/s.
    pub drift: Vec3,
    /// What it says of motions.
    pub host_speeds: HostSpeeds,
}

/// What the host tells a device of motions in one step.
#[derive(Clone, Copy, Debug, Default)]
pub struct HostSpeeds {
    /// Of bodies whose velocities it sets.
    pub speeds: Speeds,
    /// How much faster any point of a body may get by what acts on it in the step, or is added to its velocity, m/s.
    pub max_change: f32,
}

impl SolverInput {
    /// Packs the bodies and half-spaces of `state`. Those that `carried` says go on with their velocities have `speeds`, but
    /// for what they are pushed by.
    pub fn new(state: &StepInput, carried: &[Option<Carried>], speeds: Speeds, remap: BodyRemap) -> Self {
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
        let carried_velocities = |i: usize| carried_velocities(carried, i).filter(|_| placed.kind.get(i) != Some(&RigidBody::Static));
        let mut seen = Speeds::of(&bodies, |i| carried_velocities(i).is_some());
        let mut added = 0.0f32;
        let mut carried_speeds = Speeds::NONE;
        for (i, Carried { linear, angular, .. }) in (0..placed.len()).filter_map(|i| Some((i, carried_velocities(i)?))) {
            let motion = &mut bodies.motions[i];
            seen.add_along(!linear.axes, motion.linear_velocity);
            motion.linear_velocity = linear.sent(motion.linear_velocity);
            motion.angular_velocity = angular.sent(motion.angular_velocity);
            let spin = motion.angular_velocity.length() * placed.unpadded_radius[i];
            let change = Vec3::select(linear.axes, linear.added, Vec3::ZERO).length();
            if angular.axes.any() {
                added = added.max(change + spin);
            } else {
                added = added.max(change);
                seen.spin_up(spin);
            }
            carried_speeds = speeds;
        }
        let all = seen.and(carried_speeds).after(added, Vec3::ZERO);
        let collision_substeps = all.collision_substeps(&config.solver, &bodies, config.dt);
        let by_impulses = (bodies.bodies.iter().zip(&bodies.forces))
            .map(|(body, forces)| {
                let turn = body.inverse_inertia * forces.angular_impulse;
                forces.impulse.length() * body.inverse_mass + turn.length() * body.radius
            })
            .fold(0.0, f32::max);
        let collision_substep = CollisionSubstep::of(config, collision_substeps);
        let states = bodies.motions.iter().zip(&bodies.sleep).zip(&bodies.keys);
        let mut host_states: Vec<_> = states.map(|((m, s), k)| upload::state(m, s, hash(*k) as u32)).collect();
        if remap.planes_changed {
            for plane in &mut host_states[placed.len()..] {
                plane.asleep = layout::CHANGED;
            }
        }
        Self {
            settings: config.solver,
            collision_substep,
            collision_substeps,
            bodies: bodies.bodies.iter().map(upload::body).collect(),
            host_states,
            forces: bodies.forces.iter().map(upload::forces).collect(),
            remap,
            drift: all.drift(),
            host_speeds: HostSpeeds {
                speeds: seen,
                max_change: added + by_impulses,
            },
        }
    }

    /// The length of a collision substep, seconds.
    pub fn dt(&self) -> f32 {
        self.collision_substep.dt
    }

    /// How far bodies look, as a time in which they move.
    pub fn speculative_time(&self) -> f32 {
        SAFETY * self.collision_substep.dt
    }

    /// Of a body its number in the step before, and what goes on beside what `carried` says.
    pub fn source(&self, i: usize) -> (u32, u32) {
        self.remap.bodies[i]
    }

    /// What the interval's calls depend on.
    pub fn passes(&self) -> Passes {
        Passes::new(&self.settings, &self.collision_substep)
    }

    /// How many bodies and half-spaces there are.
    pub fn body_count(&self) -> u32 {
        self.bodies.len() as u32
    }

    /// Whether half-spaces are others.
    pub fn planes_changed(&self) -> bool {
        self.remap.planes_changed
    }

    /// How many there were.
    pub fn old_bodies(&self) -> u32 {
        self.remap.new_numbers.len() as u32
    }

    /// Writes everything.
    pub fn write(&self, gpu: &Gpu, step: &StepBuffers, capacity: SolverCapacity) {
        let count = self.body_count();
        let packed = |old| upload::collision_substep(&self.settings, &self.collision_substep, [count, old], capacity);
        let same: Vec<u32> = (0..count).collect();
        for (buffer, bytes) in [
            (&step.first_collision_substep, bytes_of(&packed(self.old_bodies()))),
            (&step.later_collision_substep, bytes_of(&packed(count))),
            (&step.first_new_numbers, cast_slice(&self.remap.new_numbers)),
            (&step.later_new_numbers, cast_slice(&same)),
            (&step.solver_bodies, cast_slice(&self.bodies)),
            (&step.host_states, cast_slice(&self.host_states)),
            (&step.forces, cast_slice(&self.forces)),
        ] {
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
    }
}

/// What goes on of a body with velocities, or a part of them, that the host need not know.
fn carried_velocities(carried: &[Option<Carried>], i: usize) -> Option<Carried> {
    let carries = |carried: &Carried| carried.linear.axes.any() || carried.angular.axes.any();
    carried.get(i).copied().flatten().filter(carries)
}
