//! The solver by itself on a device: bodies and contacts from the host, results back to it.

use crate::gpu::buffers::{TooLarge, check, make};
use crate::gpu::device::Gpu;
use crate::gpu::kernel::{Builder, Kernels, Program};
use crate::gpu::layout::{ContactPair, ContactPoint};
use crate::gpu::radix_sort;
use crate::gpu::readback::{read_words, scoped};
use crate::gpu::scan;
use crate::manifolds::Manifolds;
use crate::solver::gpu::layout::{self, COUNTERS, PAIRS_FOUND, POINTS, POINTS_FOUND, SKIPPED, SLOTS};
use crate::solver::gpu::lists::{Inputs, Lists, Room};
use crate::solver::gpu::record::{Passes, record};
use crate::solver::gpu::{KERNELS, upload};
use crate::solver::{CollisionSubstep, SleepState, SolverBodies, SolverMotion};
use crate::step::gpu::StepError;
use crate::types::solver_settings::SolverSettings;
use crate::types::stage::Stage;
use bytemuck::{Pod, cast_slice};
use std::collections::HashMap;
use wgpu::{Buffer, BufferUsages};

/// Solves on a device what the host hands it. Bodies stay there from interval to interval, and so do the impulses that
/// hold piles up; lists grow as needed.
pub struct GpuSolver {
    gpu: Gpu,
    kernels: Kernels,
    handed: Handed,
    lists: Lists,
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

/// What the host hands over.
struct Handed {
    room: Room,
    bodies: Buffer,
    states: Buffer,
    forces: Buffer,
    renumbered: Buffer,
    contact_pairs: Buffer,
    contact_points: Buffer,
    contact_counters: Buffer,
    status: Buffer,
    arguments: Buffer,
}

impl Handed {
    fn new(gpu: &Gpu, room: Room) -> Result<Self, TooLarge> {
        fn list<T>(gpu: &Gpu, what: &'static str, count: u32) -> Result<Buffer, TooLarge> {
            let bytes = check(gpu, what, u64::from(count) * size_of::<T>() as u64)?;
            Ok(make(gpu, what, bytes, BufferUsages::empty()))
        }
        Ok(Self {
            room,
            bodies: list::<layout::SolverBody>(gpu, "solver bodies", room.bodies)?,
            states: list::<layout::BodyState>(gpu, "states of bodies", room.bodies)?,
            forces: list::<layout::BodyForces>(gpu, "forces", room.bodies)?,
            renumbered: list::<u32>(gpu, "new numbers of bodies", room.bodies)?,
            contact_pairs: list::<ContactPair>(gpu, "contact pairs", room.pairs)?,
            contact_points: list::<ContactPoint>(gpu, "contact points", room.points)?,
            contact_counters: list::<u32>(gpu, "contact counters", 4)?,
            status: list::<u32>(gpu, "status", 4)?,
            arguments: make(gpu, "arguments", u64::from(12 * SLOTS), BufferUsages::INDIRECT),
        })
    }

    fn inputs(&self) -> Inputs<'_> {
        Inputs {
            bodies: &self.bodies,
            states: &self.states,
            forces: &self.forces,
            renumbered: &self.renumbered,
            contact_pairs: &self.contact_pairs,
            contact_points: &self.contact_points,
            contact_counters: &self.contact_counters,
            counter_of: [0, 1],
            status: &self.status,
            arguments: &self.arguments,
            first_slot: 0,
        }
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
        let all = KERNELS.into_iter().chain(scan::KERNELS).chain(radix_sort::KERNELS);
        let kernels = device(scoped(gpu, || Kernels::new(gpu, all)).and_then(|kernels| kernels))?;
        let made = scoped(gpu, || {
            Ok::<_, TooLarge>((Handed::new(gpu, room)?, Lists::new(gpu, room)?))
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
        self.lists.room
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
        let states: Vec<_> = states.map(|((m, s), k)| upload::state(m, s, *k)).collect();
        let forces: Vec<_> = bodies.forces.iter().map(upload::forces).collect();
        self.write(&[
            (&self.handed.bodies, cast_slice(&own)),
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
        let counts = [pairs.len() as u32, points.len() as u32];
        let needed = Room {
            bodies: 0,
            pairs: counts[0],
            points: counts[1],
        };
        let grown = self.handed.room.grown(needed);
        if grown != self.handed.room {
            self.make_inputs(grown)?;
        }
        self.write(&[
            (&self.handed.contact_pairs, cast_slice(&pairs)),
            (&self.handed.contact_points, cast_slice(&points)),
            (&self.handed.contact_counters, cast_slice(&counts)),
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
        self.write(&[(&self.lists.counters, cast_slice(&[0u32; COUNTERS as usize]))])
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
        let counters: Vec<u32> = self.read(&self.lists.counters, COUNTERS)?;
        let points: Vec<layout::PointState> = self.read(&self.lists.points, counters[POINTS as usize])?;
        Ok(points.iter().map(|p| p.total + p.impulse + p.bounce).collect())
    }

    /// Sends an interval off, waits, and reads the counters.
    fn launch(&mut self, settings: &SolverSettings, interval: &CollisionSubstep) -> Result<Vec<u32>, StepError> {
        let passes = Passes::new(settings, interval);
        let told = upload::interval(settings, interval, [self.bodies, self.old_bodies], self.lists.room);
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
                let mut builder = Builder::new(gpu, kernels);
                builder.stage(STAGE);
                record(&mut builder, &handed.inputs(), lists, passes);
                builder.finish()
            });
            *dispatches = program.len(STAGE);
            gpu.queue.write_buffer(&lists.interval, 0, bytemuck::bytes_of(&told));
            gpu.queue.write_buffer(&handed.status, 0, &[0; 16]);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            program.record(STAGE, &mut encoder, told.bodies, &handed.arguments, None);
            gpu.queue.submit([encoder.finish()]);
        }))?;
        self.read(&self.lists.counters, COUNTERS)
    }

    /// Makes the solver's lists larger where they do not suffice. What is remembered moves over.
    fn make_room(&mut self, needed: Room) -> Result<(), StepError> {
        let grown = self.lists.room.grown(needed);
        if grown != self.lists.room {
            let Self { gpu, lists, .. } = self;
            let larger = scoped(gpu, || {
                let larger = Lists::new(gpu, grown)?;
                copy_all(
                    gpu,
                    [
                        (&lists.counters, &larger.counters),
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
        let grown = self.handed.room.grown(bodies);
        if grown != self.handed.room {
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
                    (&handed.bodies, &larger.bodies),
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
