//! Submission of a step.

use super::buffers::StepCapacity;
use super::contact_programs::ContactPrograms;
use super::fast_bodies::{FastBodies, Impacts};
use super::flight::Flight;
use super::readback_lengths::ReadbackLengths;
use super::remap::BodyRemap;
use super::rest::Rest;
use super::results::{Detail, StagingRanges};
use super::solver_input::{HostSpeeds, SolverInput};
use super::upload::{Carried, Input};
use super::{GpuStep, StepError};
use crate::gpu::buffers::Capacity;
use crate::gpu::commands::Commands;
use crate::gpu::readback::{read_rows, scoped, staging};
use crate::solver::gpu::layout::MotionState;
use crate::state::StepInput;
use crate::step::order::SubstepPosition;
use crate::types::gpu_work::GpuWork;
use crate::types::settings::Response;
use crate::types::stage::Stage;
use glam::Vec3;

impl GpuStep {
    /// Submits a step. `carried` has an entry for each collider of `state` and then for each compound; if it is empty,
    /// all bodies start as in `state`.
    ///
    /// # Errors
    /// If the device cannot hold the bodies or meshes, or fails. All steps in flight are then given up.
    pub fn submit(&mut self, state: &StepInput, carried: &[Option<Carried>], detail: Detail) -> Result<(), StepError> {
        let result = self.submit_within(state, carried, detail);
        if result.is_err() {
            self.fail();
        }
        result
    }

    fn submit_within(
        &mut self,
        state: &StepInput,
        carried: &[Option<Carried>],
        detail: Detail,
    ) -> Result<(), StepError> {
        let wants_points = state.config.response != Response::Impulse;
        if wants_points {
            self.ensure_contacts(state.config.response == Response::Contacts)?;
        }
        let mut input = Input::new(state, carried);
        if state.config.response == Response::Contacts {
            let mut remap = self.last_bodies.advance_to(state);
            self.read_velocities(&mut remap)?;
            let has_fast_bodies = remap.has_fast_bodies;
            // Changes of speed that the known results do not include: by the host, and by gravity.
            let max_change = self.host_speeds.iter().map(|host| host.max_change).sum();
            let fall = self.in_flight() as f32 * state.config.dt * state.config.gravity;
            let known = self
                .host_speeds
                .iter()
                .fold(self.speeds, |speeds, host| speeds.and(host.speeds));
            let large_meshes = input.population().large_meshes;
            let speeds = known.after(max_change, fall);
            let recent = &self.recent_substeps;
            let solver = SolverInput::new(state, carried, speeds, remap, large_meshes, recent);
            self.host_speeds.push_back(solver.host_speeds);
            input = input.with_solver(solver, has_fast_bodies);
        } else {
            self.last_bodies.forget();
            self.host_speeds.push_back(HostSpeeds::default());
        }
        self.shrink()?;
        let mut changes = Vec::new();
        if !self.arena.holds(&state.meshes) {
            // Steps that are repeated need their meshes in place.
            self.finish_all()?;
            changes = self.arena.update(&state.meshes)?;
        }
        let needed = Capacity {
            bodies: input.len(),
            compounds: state.bodies.compounds.len() as u32,
            parts: state.bodies.parts.len() as u32,
            planes: state.planes.len() as u32,
            meshes: self.arena.slots(),
            words: self.arena.words(),
            ..Capacity::default()
        };
        if !wants_points && self.buffers.capacity.grown(needed) != self.buffers.capacity {
            // The buffers for contact points are dropped with [`Response::Impulse`], and created again when needed.
            self.finish_all()?;
            self.contacts = None;
            self.buffer_contents.clear();
        }
        let for_contacts = self.contacts.as_ref().map(|contacts| StepCapacity {
            bodies: input.old_bodies(),
            solves: input.response == Response::Contacts,
            has_fast_bodies: input.has_fast_bodies(),
            ..contacts.capacity()
        });
        if self.needs_growth(needed, for_contacts) {
            self.finish_all()?;
        }
        if !self.reserve(needed, for_contacts)? {
            self.write(changes)?;
        }
        if self.rest.is_some() {
            // This step may be at rest too, if the steps in flight are.
            self.finish_all()?;
        }
        self.population = input.population();
        let between = std::mem::take(&mut self.between);
        let fast_bodies = input.has_fast_bodies().then_some(FastBodies(state));
        self.launch(input, detail, between, fast_bodies)?;
        if fast_bodies.is_some() {
            // Finishes now, because a repetition needs the input, and the next step must know the impacts.
            self.finish_all_with(fast_bodies)?;
        }
        Ok(())
    }

    /// Reads the velocities of bodies that have lost their continuous collision, which nothing else tells.
    fn read_velocities(&mut self, remap: &mut BodyRemap) -> Result<(), StepError> {
        let mut unknown = remap
            .slowed
            .iter_mut()
            .filter(|slowed| slowed.velocities.is_none())
            .peekable();
        if unknown.peek().is_none() {
            return Ok(());
        }
        self.finish_all()?;
        let Some(contacts) = &self.contacts else {
            return Ok(());
        };
        for slowed in unknown {
            let states = &contacts.step.last_step_states;
            let row = u64::from(slowed.before);
            let read = read_rows::<MotionState>(&self.gpu, states, row..row + 1).map_err(StepError::Device)?;
            slowed.velocities = Some([read[0].linear_velocity, read[0].angular_velocity].map(Vec3::from));
        }
        Ok(())
    }

    /// `earlier` is the work of attempts whose lists were too short. `fast_bodies` are given if the input has some.
    pub(super) fn launch(
        &mut self,
        input: Input,
        detail: Detail,
        earlier: GpuWork,
        fast_bodies: Option<FastBodies>,
    ) -> Result<(), StepError> {
        let fast_bodies = fast_bodies.filter(|_| input.has_fast_bodies());
        debug_assert_eq!(fast_bodies.is_some(), input.has_fast_bodies());
        let Self {
            gpu,
            contacts,
            buffers,
            program,
            timer,
            buffer_contents,
            last_bodies,
            ccd,
            flights,
            spare,
            waits,
            rest,
            recent_lengths,
            ..
        } = self;
        let wanted = input.response != Response::Impulse;
        let contacts = contacts.as_ref().filter(|_| wanted);
        let all = ReadbackLengths::in_buffers(&buffers.capacity, contacts.map(ContactPrograms::capacity));
        let lengths = match detail {
            Detail::All => recent_lengths.for_next().min(all),
            // Nothing is read.
            Detail::Counts => all,
        };
        let flight = scoped(gpu, || {
            let mut impacts = Impacts::default();
            let mut substeps = input.recorded_substeps();
            let mut commands = Commands::new(gpu, "faceoff step");
            input.write(&mut commands, buffer_contents, buffers, contacts, &lengths);
            let goes_on = |rest: &Rest| rest.goes_on(&input, detail, &commands, &earlier);
            if flights.is_empty() && rest.as_ref().is_some_and(goes_on) {
                return Ok(None);
            }
            input.write_counters(&mut commands, buffers);
            if flights.is_empty() {
                // No list is known to be too short.
                commands.write(&buffers.status, &[0; 16]);
            }
            commands.clear(&buffers.buckets);
            if contacts.is_none() || input.population().compounds > 0 {
                // Other steps read nothing of it.
                commands.clear(&buffers.body_contacts);
            }
            match (contacts, &input.solver) {
                (Some(contacts), Some(solver)) => {
                    let (fast, timer) = (fast_bodies, timer.as_ref());
                    contacts.record_start(&mut commands, solver);
                    let mut number = 0;
                    while number < substeps {
                        let reads_pairs = detail == Detail::All;
                        contacts.record_solution(
                            &mut commands,
                            buffers,
                            solver,
                            number,
                            fast.is_some(),
                            reads_pairs,
                            timer,
                        );
                        if let Some(fast) = fast {
                            *waits += 1;
                            substeps = fast.stop(solver, ccd, &mut commands, buffers, contacts, &mut impacts)?;
                        }
                        let position = SubstepPosition::of(number, substeps);
                        contacts.record_motion(&mut commands, solver, position, number, timer);
                        number += 1;
                    }
                }
                (Some(contacts), None) => contacts.record_report(&mut commands, input.population(), timer.as_ref()),
                (None, _) => {
                    for stage in Stage::ALL {
                        let timestamps = timer.as_ref().map(|timer| timer.around(stage, 0));
                        program.record(stage, &mut commands, input.population(), timestamps);
                    }
                }
            }
            if let Some(timer) = timer {
                timer.resolve(&mut commands.encoder, substeps);
            }
            let ranges = StagingRanges::new(&lengths, contacts.is_some(), &input, substeps, detail);
            let fitting = spare.iter().position(|buffer| buffer.size() >= ranges.total);
            let staging = match fitting {
                Some(at) => spare.swap_remove(at),
                None => {
                    // All spare buffers are too short now, so none is kept.
                    spare.clear();
                    staging(gpu, ranges.total)
                }
            };
            ranges.copy(buffers, contacts, timer.as_ref(), &mut commands, &staging);
            let (submission, work) = commands.submit();
            let work = work.after(&earlier);
            Ok(Some(Flight::new(
                input, detail, lengths, ranges, staging, submission, work, impacts,
            )))
        });
        let Some(flight) = flight.and_then(|flight| flight).map_err(StepError::Device)? else {
            self.finished.extend(self.at_rest(earlier));
            return Ok(());
        };
        last_bodies.impacts.clone_from(&flight.impacts.velocities);
        flights.push_back(flight);
        Ok(())
    }
}
