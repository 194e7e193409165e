//! The solver's input in a step with contacts.

use super::buffers::StepBuffers;
use super::reach::{self, RecentSubsteps};
use super::remap::{BodyRemap, CompoundRemap};
use crate::gpu::buffer_contents::BufferContents;
use crate::gpu::commands::Commands;
use crate::gpu::program::Population;
use crate::sleep::cpu::hash;
use crate::solver::gpu::{SolverBuffers, layout, upload};
use crate::solver::speeds::Speeds;
use crate::solver::{CollisionSubstep, SolverBodies};
use crate::state::{StepConfig, StepInput};
use crate::step::gpu::upload::Carried;
use crate::types::body::RigidBody;
use bytemuck::{bytes_of, cast_slice};
use glam::{DQuat, DVec3, Vec3};

/// The solver's input, packed for the device.
pub struct SolverInput {
    config: StepConfig,
    /// The number of collision substeps that the step needs if all bodies can meet, by the speeds that the host knows.
    most_substeps: u32,
    /// The number of collision substeps for which there are commands.
    pub recorded_substeps: u32,
    bodies: Vec<layout::SolverBody>,
    /// Number of planes, which are the last of them.
    planes: u32,
    large_meshes: bool,
    rounded_meshes: bool,
    host_states: Vec<layout::MotionState>,
    forces: Vec<layout::BodyForces>,
    remap: BodyRemap,
    /// Common velocity of the bodies, m/s.
    pub drift: Vec3,
    /// Speeds that the known results do not include.
    pub host_speeds: HostSpeeds,
}

/// Speeds that the host sets or changes in one step, and speeds of bodies that are no longer fast.
#[derive(Clone, Copy, Debug, Default)]
pub struct HostSpeeds {
    /// Speeds of these bodies.
    pub speeds: Speeds,
    /// Upper bound of the change of any body's speed by impulses, forces and added velocities, m/s.
    pub max_change: f32,
}

impl SolverInput {
    /// Packs the bodies and planes of `state`. `carried` has an entry for each collider and then for each compound.
    /// Bodies whose velocity carries over have at most `speeds`, plus what the host adds. The velocities of
    /// [`BodyRemap::slowed`] must be known. `recent` suggests for how many collision substeps commands are recorded.
    pub(super) fn new(
        state: &StepInput,
        carried: &[Option<Carried>],
        speeds: Speeds,
        remap: BodyRemap,
        large_meshes: bool,
        recent: &RecentSubsteps,
    ) -> Self {
        let StepInput {
            config,
            bodies: placed,
            planes,
            ..
        } = state;
        let mut bodies = SolverBodies::default();
        let mut keys = Vec::new();
        state.write_keys(&mut keys, 0);
        bodies.read(placed, planes, &keys);
        let count = placed.len();
        let flagged = if remap.has_fast_bodies { count } else { 0 };
        for (i, body) in (0..).zip(&mut bodies.bodies[..flagged]) {
            body.continuous &= remap.fast.binary_search(&placed.body_of(i)).is_ok();
        }
        // The first collider of the body in a row of `carried`, and the row of a collider.
        let collider_of = |row: usize| match row.checked_sub(count) {
            Some(compound) => placed.compounds[compound].number as usize,
            None => row,
        };
        let carried_velocities = |row: usize| {
            let is_static = placed.kind.get(collider_of(row)) == Some(&RigidBody::Static);
            carried_velocities(carried, row).filter(|_| !is_static)
        };
        // Centre and extent of a body bound the speeds of all its colliders.
        let mut seen = Speeds::of(&bodies, config.dt, |i| {
            i < count && (!placed.is_body(i) || carried_velocities(placed.motion_row(i)).is_some())
        });
        for slowed in &remap.slowed {
            if let Some([linear, angular]) = slowed.velocities {
                let i = placed.body_of(slowed.number) as usize;
                seen.add(linear);
                seen.spin_up(angular.length() * bodies.bodies[i].extent);
            }
        }
        let left = (0..count).filter(|&i| !bodies.bodies[i].continuous);
        let mut added = left.map(|i| speed_of_impulses(&bodies, i)).fold(0.0, f32::max);
        let mut carried_speeds = Speeds::NONE;
        // State that carries over is not the host's, and need not be sent when the host's changes.
        let rows = 0..count + placed.compounds.len();
        for (row, carried) in rows.clone().filter_map(|row| Some((row, (*carried.get(row)?)?))) {
            if carried.rotation || carried.position.axes.any() {
                let motion = &mut bodies.motions[collider_of(row)];
                (motion.center, motion.rotation) = (DVec3::ZERO, DQuat::IDENTITY);
            }
        }
        for (row, Carried { linear, angular, .. }) in rows.filter_map(|row| Some((row, carried_velocities(row)?))) {
            let i = collider_of(row);
            let motion = &mut bodies.motions[i];
            let own = motion.linear_velocity;
            motion.linear_velocity = linear.sent(own);
            motion.angular_velocity = angular.sent(motion.angular_velocity);
            if bodies.bodies[i].continuous {
                continue;
            }
            seen.add_along(!linear.axes, own);
            let extent = bodies.bodies[i].extent;
            let spin = motion.angular_velocity.length() * extent;
            let (push, turn) = bodies.accelerations(i);
            let change = Vec3::select(linear.axes, linear.added, Vec3::ZERO) + push * config.dt;
            let change = change.length() + turn * config.dt * extent + speed_of_impulses(&bodies, i);
            if angular.axes.any() {
                added = added.max(change + spin);
            } else {
                added = added.max(change);
                seen.spin_up(spin);
            }
            carried_speeds = speeds;
        }
        let all = seen.and(carried_speeds).after(added, Vec3::ZERO);
        let most_substeps = all.collision_substeps(&config.solver, &bodies, config.dt);
        let states = bodies.motions.iter().zip(&bodies.sleep).zip(&bodies.keys);
        let mut host_states: Vec<_> = states.map(|((m, s), k)| upload::state(m, s, hash(*k))).collect();
        if remap.planes_changed {
            for plane in &mut host_states[placed.len()..] {
                plane.asleep = layout::CHANGED;
            }
        }
        Self {
            config: *config,
            most_substeps,
            // Continuous collision waits for each collision substep, so that none is recorded before it is needed.
            recorded_substeps: if remap.has_fast_bodies {
                most_substeps
            } else {
                recent.recorded(most_substeps)
            },
            bodies: upload::bodies(&bodies),
            planes: planes.len() as u32,
            large_meshes,
            rounded_meshes: placed.rounding.iter().any(|&rounding| rounding > 0.0),
            host_states,
            forces: bodies.forces.iter().map(upload::forces).collect(),
            remap,
            drift: all.drift(),
            host_speeds: HostSpeeds {
                speeds: seen,
                max_change: added,
            },
        }
    }

    /// How long a body moves in a collision substep, seconds, by the number of its pace on the device.
    pub(super) fn travel_time(&self, pace: u32) -> f32 {
        let substeps = pace.checked_add(1);
        substeps.map_or(0.0, |count| CollisionSubstep::of(&self.config, count).dt)
    }

    /// Substeps of the whole step.
    pub(super) fn substeps(&self) -> u32 {
        self.config.solver.substeps
    }

    /// Whether the device counts the collision substeps, because there may be more than one.
    pub(super) fn counts_substeps(&self) -> bool {
        self.most_substeps > 1
    }

    /// The number of collider `i` in the last step, and what carries over besides `carried`.
    pub fn source(&self, i: usize) -> (u32, u32) {
        self.remap.bodies[i]
    }

    /// The row of each compound in the last step, and what carries over.
    pub fn compound_sources(&self) -> &[CompoundRemap] {
        &self.remap.compounds
    }

    /// The numbers on which calls depend; planes count as bodies too.
    pub fn population(&self) -> Population {
        Population {
            bodies: self.body_count(),
            compounds: self.remap.compounds.len() as u32,
            planes: self.planes,
            large_meshes: self.large_meshes,
            rounded_meshes: self.rounded_meshes,
        }
    }

    /// Whether bodies may fall asleep.
    pub fn may_sleep(&self) -> bool {
        self.config.solver.sleeping
    }

    /// The bodies with continuous collision whose speeds cause no collision substeps, ascending.
    pub fn fast(&self) -> &[u32] {
        &self.remap.fast
    }

    /// Number of bodies and planes.
    pub fn body_count(&self) -> u32 {
        self.bodies.len() as u32
    }

    /// Whether the planes differ from those of the last step.
    pub fn planes_changed(&self) -> bool {
        self.remap.planes_changed
    }

    /// Whether bodies and planes have the numbers that they had in the last step.
    pub fn same_numbers(&self) -> bool {
        self.remap.new_numbers.iter().copied().eq(0..self.body_count())
    }

    /// Number of bodies and planes in the last step.
    pub fn old_bodies(&self) -> u32 {
        self.remap.new_numbers.len() as u32
    }

    /// Writes all buffers.
    pub fn write(
        &self,
        commands: &mut Commands,
        contents: &mut BufferContents,
        step: &StepBuffers,
        solver: &SolverBuffers,
    ) {
        let count = self.body_count();
        let most = if self.counts_substeps() {
            reach::most(&self.config)
        } else {
            1
        };
        let StepConfig {
            gravity,
            solver: settings,
            ..
        } = &self.config;
        let packed = |old| upload::collision_substep(settings, *gravity, most, [count, old], solver.capacity);
        let same: Vec<u32> = (0..count).collect();
        for (buffer, bytes) in [
            (&step.first_collision_substep, bytes_of(&packed(self.old_bodies()))),
            (&step.later_collision_substep, bytes_of(&packed(count))),
            (&step.first_new_numbers, cast_slice(&self.remap.new_numbers)),
            (&step.later_new_numbers, cast_slice(&same)),
            (&solver.paces, cast_slice(&reach::paces(&self.config, most))),
            (&step.solver_bodies, cast_slice(&self.bodies)),
            (&step.host_states, cast_slice(&self.host_states)),
            (&step.sent_forces, cast_slice(&self.forces)),
        ] {
            commands.write_changes(contents, buffer, bytes);
        }
        if self.counts_substeps() {
            let division = reach::division(&self.config, self.recorded_substeps);
            commands.write_changes(contents, &step.division, bytes_of(&division));
        }
        let forces: &[u8] = cast_slice(&self.forces);
        commands.copy_start(&step.sent_forces, &step.forces, forces.len() as u64);
    }
}

/// Upper bound of the change of a body's speed by impulses that are left for the device, which knows its rotation, m/s.
fn speed_of_impulses(bodies: &SolverBodies, i: usize) -> f32 {
    let body = &bodies.bodies[i];
    let at_once = bodies.forces[i].in_a_second();
    let (push, turn) = at_once.accelerations(body.inverse_mass, &body.inverse_inertia);
    push.length() + turn * body.extent
}

/// What carries over of a body, if its velocity does at least in part.
fn carried_velocities(carried: &[Option<Carried>], i: usize) -> Option<Carried> {
    let carries = |carried: &Carried| carried.linear.axes.any() || carried.angular.axes.any();
    carried.get(i).copied().flatten().filter(carries)
}

#[cfg(test)]
mod tests {
    use super::super::remap::LastBodies;
    use super::*;
    use crate::asset::CollisionMesh;
    use crate::geometry::shapes;
    use crate::state::Body;
    use crate::types::body::ExternalForces;
    use glam::Quat;

    /// A cube of a kilogram whose state is on the device.
    fn of_cube(forces: ExternalForces) -> SolverInput {
        let mut state = StepInput::default();
        let cube = state.meshes.add(CollisionMesh::new(&shapes::cube(1.0)));
        let mut body = Body::at_rest(cube, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
        body.params.forces = forces;
        state.bodies.push(&body, &state.meshes).expect("a usable body");
        let remap = LastBodies::default().advance_to(&state);
        let carried = [Some(Carried::all(0))];
        SolverInput::new(&state, &carried, Speeds::NONE, remap, false, &RecentSubsteps::default())
    }

    #[test]
    fn a_force_counts_once() {
        let force = Vec3::X * 64.0;
        let input = of_cube(ExternalForces {
            force,
            ..Default::default()
        });
        assert!(
            (input.host_speeds.max_change - 1.0).abs() < 1e-3,
            "{:?}",
            input.host_speeds
        );
    }

    #[test]
    fn an_angular_impulse_that_is_left_counts() {
        assert_eq!(of_cube(ExternalForces::default()).most_substeps, 1);
        let angular_impulse = Vec3::Z * 20.0;
        let input = of_cube(ExternalForces {
            angular_impulse,
            ..Default::default()
        });
        // 120 rad/s at least.
        assert!(input.host_speeds.max_change > 100.0, "{:?}", input.host_speeds);
        assert!(input.most_substeps > 4, "{}", input.most_substeps);
    }
}
