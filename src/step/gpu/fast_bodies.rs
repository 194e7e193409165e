//! Bodies with continuous collision in a step on the GPU.
//!
//! The device solves a collision substep. The CPU then stops these bodies at their impacts, with the code and the exact
//! arithmetic of [`ccd`](crate::ccd), and the device goes on from there. The CPU reads no more than it needs: the pairs
//! of bodies that may meet, and the states of bodies that may meet a fast one. If a list was too short the CPU does
//! nothing, and the step is repeated.

use super::contact_programs::ContactPrograms;
use super::solver_input::SolverInput;
use crate::ccd::stage::Ccd;
use crate::gpu::buffers::Buffers;
use crate::gpu::commands::Commands;
use crate::gpu::layout::{
    CONTACT_PAIRS, CONTACT_RESULTS, COUNTERS, ContactPair, ContactPoint, NEEDED_SUBSTEPS, SKIPPED, SPHERE_PAIRS,
};
use crate::gpu::readback::DeviceError;
use crate::solver::gpu::layout::MotionState;
use crate::solver::gpu::upload;
use crate::solver::{SleepState, SolverBodies, SolverMotion};
use crate::state::bodies::bounding_radius;
use crate::state::{Bodies, Contact, ManifoldPoint, Manifolds, StepInput};
use bytemuck::{bytes_of, pod_collect_to_vec};
use glam::{Quat, Vec3};
use std::collections::BTreeMap;
use std::ops::Range;
use wgpu::Buffer;

/// What continuous collision needs to know of the input of a step. Poses and velocities are on the device.
#[derive(Clone, Copy)]
pub struct FastBodies<'s>(pub &'s StepInput);

/// The impacts of a step.
#[derive(Clone, Debug, Default)]
pub struct Impacts {
    /// Numbers of the bodies that had one, with their velocities after the last one: linear and angular.
    pub velocities: BTreeMap<u32, [Vec3; 2]>,
    /// Sensors and bodies that touched on their paths.
    pub sensor_touches: Vec<([u32; 2], Contact)>,
    /// A list was too short: the step has to be repeated.
    pub skipped: bool,
}

/// The colliders that may meet fast bodies in a collision substep, numbered anew.
struct Excerpt {
    /// The numbers that they have in the step, ascending.
    colliders: Vec<u32>,
    bodies: Bodies,
    solver_bodies: SolverBodies,
    states: Vec<MotionState>,
    pairs: Vec<[u32; 2]>,
    manifolds: Manifolds,
}

impl FastBodies<'_> {
    /// Stops fast bodies in a collision substep whose contacts are solved by the commands that are recorded so far.
    /// Returns the number of collision substeps of the step, which the device has counted.
    ///
    /// # Errors
    /// If the device fails.
    pub fn stop(
        &self,
        solver: &SolverInput,
        ccd: &mut Ccd,
        commands: &mut Commands,
        buffers: &Buffers,
        contacts: &ContactPrograms,
        impacts: &mut Impacts,
    ) -> Result<u32, DeviceError> {
        let points = &contacts.contacts;
        let counts = commands.fetch(&[
            rows::<u32>(&buffers.counters, 0..COUNTERS),
            rows::<u32>(&points.contact_counters, 0..CONTACT_RESULTS),
        ])?;
        let counts: Vec<u32> = pod_collect_to_vec(&counts);
        let (counters, found) = counts.split_at(COUNTERS as usize);
        let substeps = counters[NEEDED_SUBSTEPS as usize];
        impacts.skipped |= counters[SKIPPED as usize] != 0;
        if impacts.skipped {
            return Ok(substeps);
        }
        let list_lengths = [counters[SPHERE_PAIRS as usize], found[CONTACT_PAIRS as usize]];
        let Some(mut excerpt) = self.read(list_lengths, solver, commands, buffers, contacts)? else {
            return Ok(substeps);
        };
        let Excerpt {
            colliders,
            bodies,
            solver_bodies,
            states,
            pairs,
            manifolds,
        } = &mut excerpt;
        let StepInput {
            config, meshes, planes, ..
        } = self.0;
        ccd.clear();
        ccd.run(
            solver_bodies,
            manifolds,
            bodies,
            meshes,
            planes,
            pairs,
            // Hooks run on the CPU only.
            |_| false,
            config,
            |pair, contact| {
                let pair = pair.map(|i| colliders[i as usize]);
                impacts.sensor_touches.push((pair, contact));
            },
        );
        for impact in ccd.impacts() {
            let i = impact.body as usize;
            let (number, motion, state) = (colliders[i], &solver_bodies.motions[i], &states[i]);
            let stopped = upload::state(motion, &SleepState::from(state), state.key);
            let at = u64::from(number) * size_of::<MotionState>() as u64;
            commands.write_at(&contacts.step.motion_states, at, bytes_of(&stopped));
            let velocities = [motion.linear_velocity, motion.angular_velocity];
            impacts.velocities.insert(number, velocities);
        }
        Ok(substeps)
    }

    /// Reads what may meet fast bodies, from lists of this many sphere pairs and manifolds; `None` if nothing does.
    fn read(
        &self,
        [pair_count, touching_count]: [u32; 2],
        solver: &SolverInput,
        commands: &mut Commands,
        buffers: &Buffers,
        contacts: &ContactPrograms,
    ) -> Result<Option<Excerpt>, DeviceError> {
        let (step, points) = (&contacts.step, &contacts.contacts);
        if pair_count == 0 {
            return Ok(None);
        }
        let lists = commands.fetch(&[
            rows::<[u32; 2]>(&buffers.sphere_pairs, 0..pair_count),
            rows::<ContactPair>(&points.contact_pairs, 0..touching_count),
        ])?;
        let (pairs, touching) = lists.split_at(pair_count as usize * size_of::<[u32; 2]>());
        let mut pairs: Vec<[u32; 2]> = pod_collect_to_vec(pairs);
        let is_fast = |&i: &u32| self.0.bodies.params[i as usize].continuous;
        pairs.retain(|pair| pair.iter().any(is_fast));
        if pairs.is_empty() {
            return Ok(None);
        }
        pairs.sort_unstable();
        let mut colliders: Vec<u32> = pairs.iter().flatten().copied().collect();
        colliders.extend(pairs.iter().flatten().map(|&i| self.0.bodies.body_of(i)));
        colliders.sort_unstable();
        colliders.dedup();
        let mut touching: Vec<ContactPair> = pod_collect_to_vec(touching);
        touching.retain(|pair| pairs.binary_search(&[pair.a, pair.b]).is_ok());

        let points_read = Rows::of(
            touching
                .iter()
                .flat_map(|pair| pair.first_point..pair.first_point + pair.point_count)
                .collect(),
        );
        let bodies_read = Rows::of(colliders.clone());
        let mut ranges = points_read.ranges::<ContactPoint>(&points.contact_points);
        ranges.extend(bodies_read.ranges::<MotionState>(&step.earlier_states));
        ranges.extend(bodies_read.ranges::<MotionState>(&step.motion_states));
        ranges.extend(bodies_read.ranges::<u32>(&step.body_paces));
        let read = commands.fetch(&ranges)?;
        let (contact_points, rest) = read.split_at(points_read.count() * size_of::<ContactPoint>());
        let (states, paces) = rest.split_at(2 * bodies_read.count() * size_of::<MotionState>());
        let paces: Vec<u32> = pod_collect_to_vec(paces);
        let travel_time = |number: u32| solver.travel_time(paces[bodies_read.place_of(number)]);
        pairs.retain(|pair| pair.iter().any(|&i| travel_time(i) > 0.0));
        if pairs.is_empty() {
            return Ok(None);
        }
        let contact_points: Vec<ContactPoint> = pod_collect_to_vec(contact_points);
        let states: Vec<MotionState> = pod_collect_to_vec(states);
        let [before, after] = [0, bodies_read.count()].map(|first| {
            let state = |&number: &u32| states[first + bodies_read.place_of(number)];
            colliders.iter().map(state).collect::<Vec<_>>()
        });

        let number_of = |collider: u32| colliders.partition_point(|&other| other < collider) as u32;
        let mut manifolds = Manifolds::default();
        for pair in &touching {
            let first = manifolds.points.len();
            let own = (pair.first_point..pair.first_point + pair.point_count)
                .map(|point| ManifoldPoint::from(&contact_points[points_read.place_of(point)]));
            manifolds.points.extend(own);
            manifolds.end_pair([pair.a, pair.b].map(number_of), first);
        }
        manifolds.pairs.sort_unstable_by_key(|pair| pair.bodies);
        let travel_times = colliders.iter().map(|&i| travel_time(i)).collect();
        let (bodies, solver_bodies) = self.placed(&colliders, travel_times, &before, &after);
        Ok(Some(Excerpt {
            pairs: pairs.iter().map(|pair| pair.map(number_of)).collect(),
            colliders,
            bodies,
            solver_bodies,
            states: after,
            manifolds,
        }))
    }

    /// These colliders at their poses before a collision substep, and for the solver after it.
    fn placed(
        &self,
        colliders: &[u32],
        travel_times: Vec<f32>,
        before: &[MotionState],
        after: &[MotionState],
    ) -> (Bodies, SolverBodies) {
        let mut bodies = self.0.bodies.excerpt(colliders);
        bodies.travel_time = travel_times;
        let mut solver_bodies = SolverBodies::default();
        let keys: Vec<u64> = (0..colliders.len() as u64).collect();
        solver_bodies.read(&bodies, &[], &keys);
        // A static body is where the host has put it.
        let moves: Vec<usize> = (0..bodies.len())
            .filter(|&i| bodies.is_body(i) && solver_bodies.bodies[i].moves())
            .collect();
        let set = |solver_bodies: &mut SolverBodies, states: &[MotionState]| {
            for &i in &moves {
                let motion = SolverMotion::from(&states[i]);
                solver_bodies.motions[i] = SolverMotion {
                    rotation: motion.rotation.normalize(),
                    ..motion
                };
            }
        };
        set(&mut solver_bodies, before);
        // The host's pose of a body may be some steps old. An equal rotation would not be written again, and may differ
        // in the last bit from the device's rounded one, although both are the same once normalized.
        for &i in &moves {
            bodies.rotation[i] = Quat::NAN;
        }
        solver_bodies.write(&mut bodies, &self.0.meshes);
        for &i in &moves {
            bodies.radius[i] = bounding_radius(bodies.unpadded_radius[i], bodies.center[i]);
        }
        set(&mut solver_bodies, after);
        (bodies, solver_bodies)
    }
}

/// Rows of a list that are read: some numbers, and the rows between near ones, because each copy has a cost of its own.
struct Rows {
    /// Runs of rows, each with the number of rows before it.
    runs: Vec<(Range<u32>, usize)>,
}

/// Numbers with at most this many between them are read together.
const GAP: u32 = 16;

impl Rows {
    fn of(mut numbers: Vec<u32>) -> Self {
        numbers.sort_unstable();
        let mut runs: Vec<(Range<u32>, usize)> = Vec::new();
        for number in numbers {
            match runs.last_mut() {
                Some((last, _)) if number <= last.end.saturating_add(GAP) => last.end = last.end.max(number + 1),
                last => {
                    let before = last.map_or(0, |(last, before)| *before + last.len());
                    runs.push((number..number + 1, before));
                }
            }
        }
        Self { runs }
    }

    /// Number of rows.
    fn count(&self) -> usize {
        self.runs.last().map_or(0, |(last, before)| before + last.len())
    }

    /// The bytes of these rows in a list of `T`.
    fn ranges<'b, T>(&self, list: &'b Buffer) -> Vec<(&'b Buffer, Range<u64>)> {
        self.runs.iter().map(|(run, _)| rows::<T>(list, run.clone())).collect()
    }

    /// Where a number is among the rows.
    fn place_of(&self, number: u32) -> usize {
        let run = self.runs.partition_point(|(run, _)| run.end <= number);
        let (run, before) = &self.runs[run];
        before + (number - run.start) as usize
    }
}

/// The bytes of rows of a list.
fn rows<T>(list: &Buffer, numbers: Range<u32>) -> (&Buffer, Range<u64>) {
    let at = |number: u32| u64::from(number) * size_of::<T>() as u64;
    (list, at(numbers.start)..at(numbers.end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_near_each_other_are_read_together() {
        let rows = Rows::of(vec![300, 5, 7, 8, 8, 9 + GAP, 301, 7]);
        let runs: Vec<_> = rows.runs.iter().map(|(run, _)| run.clone()).collect();
        assert_eq!(runs, [5..10 + GAP, 300..302]);
        let first = (5 + GAP) as usize;
        assert_eq!(rows.count(), first + 2);
        for (number, place) in [(5, 0), (8, 3), (300, first), (301, first + 1)] {
            assert_eq!(rows.place_of(number), place);
        }
        assert_eq!(Rows::of(Vec::new()).count(), 0);
    }
}
