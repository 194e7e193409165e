//! The solver by itself on a device: bodies and contacts from the host, results back to it.

use crate::gpu::buffers::{TooLarge, buffers};
use crate::gpu::device::Gpu;
use crate::gpu::kernel::Kernels;
use crate::gpu::layout::{CONTACT_COUNTERS, CONTACT_PAIRS, CONTACT_POINTS, ContactPair, ContactPoint};
use crate::gpu::program::{Calls, Program};
use crate::gpu::readback::{read_words, scoped};
use crate::manifolds::Manifolds;
use crate::sleep;
use crate::solver::gpu as solver;
use crate::solver::gpu::layout::{self, COUNTERS, PAIRS_FOUND, POINTS, POINTS_FOUND, SKIPPED, SLOTS};
use crate::solver::gpu::record::{record, record_arguments};
use crate::solver::gpu::{Passes, Room, SolverBuffers, upload};
use crate::solver::{CollisionSubstep, SleepState, SolverBodies, SolverMotion};
use crate::step::gpu::StepError;
use crate::step::gpu::record::all_modules;
use crate::types::solver_settings::SolverSettings;
use crate::types::stage::Stage;
use bytemuck::{Pod, cast_slice};
use std::collections::HashMap;
use wgpu::Buffer;

/// Solves on a device what the host hands it. Bodies stay there from interval to interval, and so do the impulses that
/// hold piles up; lists grow as needed.
pub struct GpuSolver {
    gpu: Gpu,
    kernels: Kernels,
    handed: Handed,
    lists: SolverBuffers,
    /// Of intervals that were run with the lists as they are.
    programs: HashMap<Passes, Program>,
    /// Of the last interval.
    dispatches: usize,
    bodies: u32,
    /// Bodies of the interval before, unless all were forgotten.
    old_bodies: u32,
    /// The host has said how they are numbered now.
    renumbered: bool,
}

buffers! {
    /// What the host hands over.
    Handed(Room), |room| {
        solver_bodies: ARRAY layout::SolverBody, room.bodies, "solver bodies";
        states: ARRAY layout::BodyState, room.bodies, "states of bodies";
        forces: ARRAY layout::BodyForces, room.bodies, "forces";
        renumbered: ARRAY u32, room.bodies, "new numbers of bodies";
        contact_pairs: ARRAY ContactPair, room.pairs, "contact pairs";
        contact_points: ARRAY ContactPoint, room.points, "contact points";
        contact_counters: ARRAY u32, CONTACT_COUNTERS, "contact counters";
        status: ARRAY u32, 4u32, "status";
        solver_arguments: INDIRECT u32, 3 * SLOTS, "arguments";
    }
}

impl GpuSolver {
    /// Compiles the kernels and makes room for a small scene.
    ///
    /// # Errors
    /// If the device cannot run it.
    pub fn new(gpu: &Gpu) -> Result<Self, StepError> {
        let room = Room {
            bodies: 256,
            pairs: 1024,
            points: 4096,
        };
        Self::with_room(gpu, room)
    }

    /// With lists of this size to begin with: results do not depend on them.
    ///
    /// # Errors
    /// If the device cannot run it.
    pub fn with_room(gpu: &Gpu, room: Room) -> Result<Self, StepError> {
        let shaders = [&crate::gpu::SHADERS, &solver::SHADERS, &sleep::gpu::SHADERS];
        let all = shaders.into_iter().flat_map(|shaders| shaders.kernels.iter().copied());
        let kernels = device(scoped(gpu, || Kernels::new(gpu, all_modules(), all)).and_then(|kernels| kernels))?;
        let made = scoped(gpu, || {
            Ok::<_, TooLarge>((Handed::new(gpu, room)?, SolverBuffers::new(gpu, room)?))
        });
        let (handed, lists) = device(made)??;
        Ok(Self {
            gpu: gpu.clone(),
            kernels,
            handed,
            lists,
            programs: HashMap::new(),
            dispatches: 0,
            bodies: 0,
            old_bodies: 0,
            renumbered: false,
        })
    }

    /// What fits into the solver's own lists.
    pub fn room(&self) -> Room {
        self.lists.sizes
    }

    /// Dispatches of the last interval.
    pub fn dispatches(&self) -> usize {
        self.dispatches
    }

    /// Puts bodies onto the device, poses, velocities, forces and all. Unless [`GpuSolver::renumber`] says otherwise they
    /// are numbered as before.
    ///
    /// # Errors
    /// If they do not fit or the device fails.
    pub fn put_bodies(&mut self, bodies: &SolverBodies) -> Result<(), StepError> {
        self.bodies = bodies.len() as u32;
        self.make_room(Room {
            bodies: self.bodies,
            ..Room::default()
        })?;
        let own: Vec<_> = bodies.bodies.iter().map(upload::body).collect();
        let states = bodies.motions.iter().zip(&bodies.sleep).zip(&bodies.keys);
        let states: Vec<_> = states
            .map(|((m, s), k)| upload::state(m, s, sleep::cpu::hash(*k) as u32))
            .collect();
        let forces: Vec<_> = bodies.forces.iter().map(upload::forces).collect();
        self.write(&[
            (&self.handed.solver_bodies, cast_slice(&own)),
            (&self.handed.states, cast_slice(&states)),
            (&self.handed.forces, cast_slice(&forces)),
        ])
    }

    /// Tells the number that each body of the last interval has now; `u32::MAX` for those that are gone.
    ///
    /// # Errors
    /// If the device fails.
    pub fn renumber(&mut self, new_numbers: &[u32]) -> Result<(), StepError> {
        self.old_bodies = self.old_bodies.min(new_numbers.len() as u32);
        self.renumbered = true;
        let known = &new_numbers[..self.old_bodies as usize];
        self.write(&[(&self.handed.renumbered, cast_slice(known))])
    }

    /// Puts the contact points of the next interval onto the device.
    ///
    /// # Errors
    /// If they do not fit or the device fails.
    pub fn put_contacts(&mut self, manifolds: &Manifolds) -> Result<(), StepError> {
        let pairs: Vec<_> = manifolds.pairs.iter().map(upload::contact_pair).collect();
        let points: Vec<_> = manifolds.points.iter().map(upload::contact_point).collect();
        let mut counters = [0; CONTACT_COUNTERS as usize];
        counters[CONTACT_PAIRS as usize] = pairs.len() as u32;
        counters[CONTACT_POINTS as usize] = points.len() as u32;
        let needed = Room {
            bodies: 0,
            pairs: pairs.len() as u32,
            points: points.len() as u32,
        };
        let grown = self.handed.sizes.grown(needed);
        if grown != self.handed.sizes {
            self.make_inputs(grown)?;
        }
        self.write(&[
            (&self.handed.contact_pairs, cast_slice(&pairs)),
            (&self.handed.contact_points, cast_slice(&points)),
            (&self.handed.contact_counters, cast_slice(&counters)),
        ])
    }

    /// Moves the bodies over one collision substep. If the solver's own lists are too small for the contacts, nothing
    /// moves; they are made larger and the interval runs again.
    ///
    /// # Errors
    /// If the device cannot hold the lists or fails.
    pub fn run(&mut self, settings: &SolverSettings, interval: &CollisionSubstep) -> Result<(), StepError> {
        if !self.renumbered {
            let same: Vec<u32> = (0..self.old_bodies).collect();
            self.write(&[(&self.handed.renumbered, cast_slice(&same))])?;
        }
        let mut counters = self.launch(settings, interval)?;
        if counters[SKIPPED as usize] != 0 {
            self.make_room(Room {
                bodies: 0,
                pairs: counters[PAIRS_FOUND as usize],
                points: counters[POINTS_FOUND as usize],
            })?;
            counters = self.launch(settings, interval)?;
        }
        if counters[SKIPPED as usize] != 0 {
            return Err(StepError::Device("lists stay too short".into()));
        }
        self.old_bodies = self.bodies;
        self.renumbered = false;
        Ok(())
    }

    /// Forgets the impulses of the last interval.
    ///
    /// # Errors
    /// If the device fails.
    pub fn forget(&mut self) -> Result<(), StepError> {
        self.old_bodies = 0;
        self.write(&[(&self.lists.solver_counters, cast_slice(&[0u32; COUNTERS as usize]))])
    }

    /// Where the bodies are and how they move.
    ///
    /// # Errors
    /// If the device fails.
    pub fn motions(&self) -> Result<Vec<SolverMotion>, StepError> {
        let states: Vec<layout::BodyState> = self.read(&self.handed.states, self.bodies)?;
        Ok(states.iter().map(SolverMotion::from).collect())
    }

    /// Which bodies are frozen. Of what they touched the lower half of the sum is known.
    ///
    /// # Errors
    /// If the device fails.
    pub fn sleep(&self) -> Result<Vec<SleepState>, StepError> {
        let states: Vec<layout::BodyState> = self.read(&self.handed.states, self.bodies)?;
        Ok(states.iter().map(SleepState::from).collect())
    }

    /// The normal impulse that each contact point gave over the last interval, newton seconds.
    ///
    /// # Errors
    /// If the device fails.
    pub fn impulses(&self) -> Result<Vec<f32>, StepError> {
        let counters: Vec<u32> = self.read(&self.lists.solver_counters, COUNTERS)?;
        let points: Vec<layout::PointState> = self.read(&self.lists.points, counters[POINTS as usize])?;
        Ok(points.iter().map(|p| p.total + p.impulse + p.bounce).collect())
    }

    /// Sends an interval off, waits, and reads the counters.
    fn launch(&mut self, settings: &SolverSettings, interval: &CollisionSubstep) -> Result<Vec<u32>, StepError> {
        let passes = Passes::new(settings, interval);
        let told = upload::interval(settings, interval, [self.bodies, self.old_bodies], self.lists.sizes);
        let Self {
            gpu,
            kernels,
            handed,
            lists,
            programs,
            dispatches,
            ..
        } = self;
        device(scoped(gpu, || {
            let program = programs.entry(passes).or_insert_with(|| {
                let mut calls = Calls::new(STAGE);
                record_arguments(&mut calls);
                sleep::gpu::record_wake(&mut calls, passes.sleeping);
                record(&mut calls, &lists.sizes, passes);
                sleep::gpu::record_fall_asleep(&mut calls, passes.sleeping);
                Program::new(gpu, kernels, &calls, &[handed, lists])
            });
            *dispatches = program.len(STAGE);
            gpu.queue.write_buffer(&lists.interval, 0, bytemuck::bytes_of(&told));
            gpu.queue.write_buffer(&handed.status, 0, &[0; 16]);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            program.record(STAGE, &mut encoder, told.bodies, None);
            gpu.queue.submit([encoder.finish()]);
        }))?;
        self.read(&self.lists.solver_counters, COUNTERS)
    }

    /// Makes the solver's lists larger where they do not suffice. What is remembered moves over.
    fn make_room(&mut self, needed: Room) -> Result<(), StepError> {
        let grown = self.lists.sizes.grown(needed);
        if grown != self.lists.sizes {
            let Self { gpu, lists, .. } = self;
            let larger = scoped(gpu, || {
                let larger = SolverBuffers::new(gpu, grown)?;
                copy_all(
                    gpu,
                    [
                        (&lists.solver_counters, &larger.solver_counters),
                        (&lists.kept_pairs, &larger.kept_pairs),
                        (&lists.kept_points, &larger.kept_points),
                    ],
                );
                Ok::<_, TooLarge>(larger)
            });
            self.lists = device(larger)??;
            self.programs.clear();
        }
        let bodies = Room {
            bodies: needed.bodies,
            ..Room::default()
        };
        let grown = self.handed.sizes.grown(bodies);
        if grown != self.handed.sizes {
            self.make_inputs(grown)?;
        }
        Ok(())
    }

    /// Makes larger lists for what the host hands over. Bodies move over.
    fn make_inputs(&mut self, room: Room) -> Result<(), StepError> {
        let Self { gpu, handed, .. } = self;
        let larger = scoped(gpu, || {
            let larger = Handed::new(gpu, room)?;
            copy_all(
                gpu,
                [
                    (&handed.solver_bodies, &larger.solver_bodies),
                    (&handed.states, &larger.states),
                    (&handed.forces, &larger.forces),
                    (&handed.renumbered, &larger.renumbered),
                ],
            );
            Ok::<_, TooLarge>(larger)
        });
        self.handed = device(larger)??;
        self.programs.clear();
        Ok(())
    }

    fn write(&self, parts: &[(&Buffer, &[u8])]) -> Result<(), StepError> {
        device(scoped(&self.gpu, || {
            for (buffer, bytes) in parts {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
            }
        }))
    }

    fn read<T: Pod>(&self, buffer: &Buffer, count: u32) -> Result<Vec<T>, StepError> {
        let words = device(read_words(&self.gpu, buffer, count as usize * size_of::<T>() / 4))?;
        Ok(bytemuck::pod_collect_to_vec(&words))
    }
}

/// Where a program of this solver alone keeps its calls.
const STAGE: Stage = Stage::Integrate;

fn device<T>(result: Result<T, String>) -> Result<T, StepError> {
    result.map_err(StepError::Device)
}

/// Copies each list to the beginning of a longer one.
fn copy_all<const N: usize>(gpu: &Gpu, lists: [(&Buffer, &Buffer); N]) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for (short, long) in lists {
        encoder.copy_buffer_to_buffer(short, 0, long, 0, short.size().min(long.size()));
    }
    gpu.queue.submit([encoder.finish()]);
}
