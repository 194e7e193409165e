//! A step on the GPU: one submission, whose results are read at once or some steps later. With continuous collision
//! each collision substep has one to three more, and waits for them.
//!
//! A step can continue from the last one before the host has read its results, because poses and velocities stay on the
//! device. If a list overflows, or a step needs more collision substeps than are recorded, a flag on the device makes
//! that step and all later ones do nothing. The host makes the list longer, or records more, and submits them again.
//!
//! | file | contents |
//! |---|---|
//! | `upload`, `solver_input` | the input of a step |
//! | `remap` | the numbers of bodies in the last step and in this one |
//! | `record` | the kernels of each part of a step, in the order of [`order`](crate::step::order) |
//! | `reach` | how many collision substeps a step needs |
//! | `buffers`, `contact_programs` | buffers and calls of steps with contact points |
//! | `submit` | submission of a step |
//! | `fast_bodies` | continuous collision, by the CPU during a step |
//! | `flight` | a step in flight |
//! | `rest` | steps in which all bodies sleep |
//! | `overflow` | repetition of steps whose lists overflowed |
//! | `capacity`, `peak_usage` | creation of buffers; lists that become shorter |
//! | `results`, `readback_lengths` | the results of a step, and how much of them is read back |
//! | `memory` | the memory between steps, for snapshots |
//! | `hand_over` | the same memory on the CPU |

pub mod buffers;
mod capacity;
mod contact_programs;
mod fast_bodies;
mod flight;
mod hand_over;
pub mod memory;
mod overflow;
mod peak_usage;
mod poses;
mod reach;
mod readback_lengths;
pub mod record;
pub mod remap;
mod rest;
pub mod results;
mod solver_input;
mod submit;
pub mod upload;

use crate::ccd::stage::Ccd;
use crate::gpu::arena::Arena;
use crate::gpu::buffer_contents::BufferContents;
use crate::gpu::buffers::{Buffers, Capacity, TooLarge};
use crate::gpu::device::{Gpu, NoGpu};
use crate::gpu::layout;
use crate::gpu::program::{Population, Program};
use crate::gpu::readback::{DeviceError, read_words, scoped};
use crate::gpu::timer::Timer;
use crate::manifolds::gpu::BatchSize;
use crate::solver::apply_impulses;
use crate::solver::speeds::Speeds;
use crate::state::Motion;
use crate::step::StepState;
use crate::types::gpu_work::GpuWork;
use crate::types::settings::Response;
use contact_programs::ContactPrograms;
use flight::Flight;
use peak_usage::PeakUsage;
pub use poses::Poses;
use reach::RecentSubsteps;
use readback_lengths::RecentLengths;
use record::{all_modules, impulse_kernels, impulse_program};
use remap::LastBodies;
use rest::Rest;
use results::{Detail, Output};
use solver_input::HostSpeeds;
use std::collections::VecDeque;
use thiserror::Error;
use wgpu::Buffer;

/// Why a step did not run.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StepError {
    /// More than the device can hold.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The device reports an error or is lost.
    #[error("the device says: {0}")]
    Device(DeviceError),
    /// The device aborts long loops.
    #[error("the device left the test of a pair before its end: too many triangles of the two are near each other")]
    CutShort,
}

/// The stages on a GPU.
pub struct GpuStep {
    gpu: Gpu,
    arena: Arena,
    buffers: Buffers,
    program: Program,
    /// Buffers and calls for contact points; created when first needed.
    contacts: Option<ContactPrograms>,
    /// The kernels that are compiled.
    compiled: Compiled,
    /// The bodies of the last submitted step, if it had contacts.
    last_bodies: LastBodies,
    /// Speeds of bodies after the last step whose results were taken.
    speeds: Speeds,
    /// The numbers of collision substeps that the last of these steps needed.
    recent_substeps: RecentSubsteps,
    /// Changes of speed by the host in the steps since then, oldest first.
    host_speeds: VecDeque<HostSpeeds>,
    timer: Option<Timer>,
    /// The input that is on the device.
    buffer_contents: BufferContents,
    /// The memory of a batch of pairs whose contact points are made.
    batch_size: BatchSize,
    /// The use of lists.
    peak_usage: PeakUsage,
    /// The use of lists that are read back.
    recent_lengths: RecentLengths,
    /// Continuous collision.
    ccd: Ccd,
    /// Submitted steps, oldest first.
    flights: VecDeque<Flight>,
    /// The last finished step, if it was at rest.
    rest: Option<Rest>,
    /// Results that were read before they were asked for; older than all steps in flight.
    finished: VecDeque<Output>,
    /// Staging buffers that are not in use.
    spare: Vec<Buffer>,
    /// Number of colliders and compounds in the last submitted step.
    population: Population,
    waits: u64,
    /// What was done between steps. It counts for the next step.
    between: GpuWork,
}

/// The kernels that are compiled. Each response needs more than the one before.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Compiled {
    /// Kernels of [`Response::Impulse`](crate::types::settings::Response::Impulse).
    Impulses,
    /// Kernels for contact points too. Meshes include their topology.
    Points,
    /// All.
    All,
}

/// Initial capacity. Lists grow as needed.
const START: Capacity = Capacity {
    // One digit of the sort less than 256.
    bodies: 255,
    compounds: 0,
    parts: 0,
    // Lists of contact points have an element for each body and plane.
    planes: 0,
    pairs: 1024,
    hits: 4096,
    plane_contacts: 256,
    pieces: 256,
    meshes: 8,
    words: 1 << 16,
};

impl GpuStep {
    /// Compiles the kernels that the device does not have yet, which takes about a second for all of them. Creates
    /// buffers for a small scene.
    ///
    /// # Errors
    /// If the device cannot run the stages.
    pub fn new(gpu: Gpu) -> Result<Self, NoGpu> {
        Self::with_capacity(gpu, START)
    }

    /// A step with this initial capacity. Results do not depend on it.
    ///
    /// # Errors
    /// If the device cannot run the stages.
    pub fn with_capacity(gpu: Gpu, capacity: Capacity) -> Result<Self, NoGpu> {
        let made = scoped(&gpu, || {
            gpu.compile(all_modules(), impulse_kernels())?;
            let buffers = Buffers::new(&gpu, capacity).map_err(DeviceError::failed)?;
            let program = impulse_program(&gpu, &buffers);
            let timer = Timer::new(&gpu);
            Ok((buffers, program, timer))
        });
        match made.and_then(|made| made) {
            Ok((buffers, program, timer)) => Ok(Self {
                batch_size: BatchSize::of(&gpu),
                gpu,
                arena: Arena::default(),
                buffers,
                program,
                contacts: None,
                last_bodies: LastBodies::default(),
                speeds: Speeds::NONE,
                recent_substeps: RecentSubsteps::default(),
                host_speeds: VecDeque::new(),
                compiled: Compiled::Impulses,
                timer,
                buffer_contents: BufferContents::default(),
                peak_usage: PeakUsage::default(),
                recent_lengths: RecentLengths::default(),
                ccd: Ccd::default(),
                flights: VecDeque::new(),
                rest: None,
                finished: VecDeque::new(),
                spare: Vec::new(),
                population: Population::default(),
                waits: 0,
                between: GpuWork::default(),
            }),
            Err(error) => Err(NoGpu::Failed {
                adapter: gpu.info.name.clone(),
                reason: error.to_string(),
            }),
        }
    }

    /// This step with batches of this size. Results do not depend on it.
    pub fn with_batch_size(mut self, batch_size: BatchSize) -> Self {
        self.batch_size = batch_size;
        self
    }

    /// This step with commands for this many more collision substeps than the last steps suggest. Results do not depend
    /// on it.
    pub fn with_spare_substeps(mut self, spare: u32) -> Self {
        self.recent_substeps.spare = spare;
        self
    }

    /// Compiles the kernels for contact points, which takes some seconds, before they are needed.
    ///
    /// # Errors
    /// If the device cannot run them.
    pub fn with_contacts(mut self) -> Result<Self, NoGpu> {
        match self.ensure_contacts(true) {
            Ok(()) => Ok(self),
            Err(error) => Err(NoGpu::Failed {
                adapter: self.gpu.info.name.clone(),
                reason: error.to_string(),
            }),
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Current capacity of the lists.
    pub fn capacity(&self) -> Capacity {
        self.buffers.capacity
    }

    /// Total size of the buffers, bytes.
    pub fn bytes(&self) -> u64 {
        let flights = self.flights.iter().map(|flight| &flight.staging);
        let staging: u64 = flights.chain(&self.spare).map(Buffer::size).sum();
        self.buffers.bytes() + self.contacts.as_ref().map_or(0, ContactPrograms::bytes) + staging
    }

    /// Runs all stages on `state` and waits for the results. Steps in flight are given up.
    ///
    /// With [`Response::Contacts`] sleep states and saved impulses carry over to bodies with the same keys or numbers.
    /// Call [`GpuStep::forget`] before stepping another world.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails. `state` is then unchanged, but that external impulses have become
    /// velocities.
    pub fn run(&mut self, state: &mut StepState) -> Result<(), StepError> {
        if self.in_flight() > 0 {
            self.forget();
        }
        if state.input.config.response == Response::Contacts {
            apply_impulses(&mut state.input.bodies);
        }
        self.submit(&state.input, &[], Detail::All)?;
        if let Some(output) = self.take() {
            output?.put(state);
        }
        Ok(())
    }

    /// Number of submitted steps whose results have not been taken.
    pub fn in_flight(&self) -> usize {
        self.finished.len() + self.flights.len()
    }

    /// Number of times that [`GpuStep::take`] had to wait, or a step for what continuous collision reads.
    pub fn waits(&self) -> u64 {
        self.waits
    }

    /// Waits for the oldest step in flight and returns its results; `None` if there is none.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails. All steps in flight are then given up.
    pub fn take(&mut self) -> Option<Result<Output, StepError>> {
        let result = match self.finished.pop_front() {
            Some(output) => Ok(output),
            None if self.flights.is_empty() => return None,
            None => self.finish_oldest(None),
        };
        match &result {
            // Here and not when the results are read, which depends on the speed of the device.
            Ok(output) => {
                self.speeds = output.speeds;
                self.recent_substeps.add(output.collision_substeps);
                self.host_speeds.pop_front();
            }
            Err(_) => self.fail(),
        }
        Some(result)
    }

    /// Gives up all steps in flight. Nothing carries over to the next one.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.rest = None;
        self.finished.clear();
        self.last_bodies.forget();
        self.host_speeds.clear();
        self.speeds = Speeds::NONE;
        self.recent_substeps.forget();
        self.population = Population::default();
    }

    fn fail(&mut self) {
        self.forget();
        self.buffer_contents.clear();
        // Which meshes were written is unknown, so the next step writes all.
        self.arena = self.empty_arena();
    }

    /// An arena without meshes.
    fn empty_arena(&self) -> Arena {
        if self.compiled >= Compiled::Points {
            Arena::with_features()
        } else {
            Arena::default()
        }
    }

    /// Waits for the last submitted step, and returns the motions of all colliders after it, followed by those of
    /// compounds.
    ///
    /// # Errors
    /// As [`GpuStep::take`].
    pub fn motions(&mut self) -> Result<Vec<Motion>, StepError> {
        let Population { bodies, compounds, .. } = self.population;
        let words = (bodies + compounds) as usize * size_of::<layout::Moved>() / 4;
        let read = self.finish_all().and_then(|()| {
            let words = read_words(&self.gpu, &self.buffers.moved, words);
            words.map_err(StepError::Device)
        });
        let words = read.inspect_err(|_| self.fail())?;
        let moved: &[layout::Moved] = bytemuck::cast_slice(&words);
        Ok(moved.iter().map(Motion::from).collect())
    }

    /// The poses on the device, for rendering.
    pub fn poses(&self) -> Poses<'_> {
        Poses {
            previous: if self.last_bodies.is_empty() {
                &self.buffers.bodies
            } else {
                &self.buffers.before
            },
            current: &self.buffers.moved,
            bodies: self.population.bodies,
        }
    }
}
