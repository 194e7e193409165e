//! Steps on the device: everything in, one submission, everything out, at once or some steps later.
//!
//! A step can go on from the one before although the host has not seen its results: poses and velocities stay on the
//! device. If a list turns out to be too short a flag on the device turns that step and all later ones into nothing;
//! the host makes the list longer and sends them off again.
//!
//! | file | holds |
//! |---|---|
//! | `upload`, `solver_input` | what a step is told |
//! | `last_bodies` | which body of a step was which in the step before |
//! | `record` | the kernels of each part of a step, in the order of `order`(crate::step::order) |
//! | `buffers`, `contact_programs` | what only steps with contact points have |
//! | `submit` | sends a step off |
//! | `flight` | a step whose results are on their way |
//! | `overflow` | lists that turn out to be too short |
//! | `capacity` | makes buffers |
//! | `results` | what comes of a step |
//! | `memory` | what outlives it, for snapshots |

pub mod buffers;
mod capacity;
mod contact_programs;
mod flight;
pub mod memory;
mod overflow;
pub mod record;
pub mod remap;
pub mod results;
mod solver_input;
mod submit;
pub mod upload;

use crate::gpu::arena::Arena;
use crate::gpu::buffers::{Buffers, Capacity, TooLarge};
use crate::gpu::device::{Gpu, NoGpu};
use crate::gpu::kernel::Kernels;
use crate::gpu::layout;
use crate::gpu::program::Program;
use crate::gpu::readback::{read_words, scoped};
use crate::gpu::timer::Timer;
use crate::solver::speeds::Speeds;
use crate::state::Motion;
use crate::step::StepState;
use crate::types::stage::Stage;
use contact_programs::ContactPrograms;
use flight::Flight;
use record::{all_modules, impulse_calls, impulse_program};
use remap::LastBodies;
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
    Device(String),
    /// The device ends long loops before their time.
    #[error("the device left the test of a pair before its end: too many triangles of the two are near each other")]
    CutShort,
}

/// The stages on a device.
pub struct GpuStep {
    gpu: Gpu,
    kernels: Kernels,
    arena: Arena,
    buffers: Buffers,
    program: Program,
    /// What finds contact points and moves bodies by them, where somebody asks for it.
    contacts: Option<ContactPrograms>,
    /// Somebody has: its kernels are compiled, and meshes come with their corners and edges.
    has_features: bool,
    /// Which body was which in the last step, if it had contacts.
    last_bodies: LastBodies,
    /// How fast bodies moved after the last step whose results were taken.
    speeds: Speeds,
    /// What the host told of motions in the steps since, oldest first.
    host_speeds: VecDeque<HostSpeeds>,
    timer: Option<Timer>,
    /// Submitted, oldest first.
    flights: VecDeque<Flight>,
    /// Results that were waited for before anybody asked for them; older than all flights.
    finished: VecDeque<Output>,
    /// Buffers to read from that no flight uses.
    spare: Vec<Buffer>,
    /// Bodies of the last step that was submitted.
    bodies: u32,
    waits: u64,
}

/// Lists start with room for this many things, and grow.
const START: Capacity = Capacity {
    bodies: 256,
    planes: 8,
    pairs: 1024,
    hits: 4096,
    plane_contacts: 256,
    meshes: 8,
    words: 1 << 16,
};

impl GpuStep {
    /// Compiles the kernels, which takes a second or so, and makes room for a small scene.
    ///
    /// # Errors
    /// If the device cannot run the stages.
    pub fn new(gpu: Gpu) -> Result<Self, NoGpu> {
        Self::with_capacity(gpu, START)
    }

    /// With lists of these sizes to begin with: results do not depend on them.
    ///
    /// # Errors
    /// If the device cannot run the stages.
    pub fn with_capacity(gpu: Gpu, capacity: Capacity) -> Result<Self, NoGpu> {
        let made = scoped(&gpu, || {
            let calls = impulse_calls(&capacity);
            let kernels = Kernels::new(&gpu, all_modules(), calls.iter().map(|call| call.kernel))?;
            let buffers = Buffers::new(&gpu, capacity).map_err(|error| error.to_string())?;
            let program = impulse_program(&gpu, &kernels, &buffers);
            let timer = Timer::new(&gpu);
            Ok((kernels, buffers, program, timer))
        });
        match made.and_then(|made| made) {
            Ok((kernels, buffers, program, timer)) => Ok(Self {
                gpu,
                kernels,
                arena: Arena::default(),
                buffers,
                program,
                contacts: None,
                last_bodies: LastBodies::default(),
                speeds: Speeds::NONE,
                host_speeds: VecDeque::new(),
                has_features: false,
                timer,
                flights: VecDeque::new(),
                finished: VecDeque::new(),
                spare: Vec::new(),
                bodies: 0,
                waits: 0,
            }),
            Err(reason) => Err(NoGpu::Failed {
                adapter: gpu.info.name.clone(),
                reason,
            }),
        }
    }

    /// Compiles what only steps with contact points need, which takes some seconds, before the first one asks for it.
    ///
    /// # Errors
    /// If the device cannot run it.
    pub fn with_contacts(mut self) -> Result<Self, NoGpu> {
        match self.ensure_contacts() {
            Ok(()) => Ok(self),
            Err(error) => Err(NoGpu::Failed {
                adapter: self.gpu.info.name.clone(),
                reason: error.to_string(),
            }),
        }
    }

    /// Where it runs.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// What fits at present.
    pub fn capacity(&self) -> Capacity {
        self.buffers.capacity
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.buffers.bytes() + self.contacts.as_ref().map_or(0, ContactPrograms::bytes)
    }

    /// Dispatches of each stage, in order; of a step with contacts those of one interval, once there was one.
    pub fn dispatches(&self) -> [usize; Stage::COUNT] {
        match &self.contacts {
            Some(contacts) => contacts.dispatches(),
            None => Stage::ALL.map(|stage| self.program.len(stage)),
        }
    }

    /// Runs all stages on `state` and waits for the results. Steps in flight are given up.
    ///
    /// With [`Response::Contacts`] bodies of the same keys, or numbers, go on sleeping and pushing each other as they did in the
    /// step before: call [`GpuStep::forget`] before that of another world.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails. `state` is then as it was.
    pub fn run(&mut self, state: &mut StepState) -> Result<(), StepError> {
        if self.in_flight() > 0 {
            self.forget();
        }
        self.submit(&state.input, &[], Detail::All)?;
        if let Some(output) = self.take() {
            output?.put(state);
        }
        Ok(())
    }

    /// Steps that were submitted and not taken.
    pub fn in_flight(&self) -> usize {
        self.finished.len() + self.flights.len()
    }

    /// How often results were asked for before they were there.
    pub fn waits(&self) -> u64 {
        self.waits
    }

    /// The results of the oldest step in flight; waits for them. `None` if there is no such step.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails: all steps in flight are given up then.
    pub fn take(&mut self) -> Option<Result<Output, StepError>> {
        let result = match self.finished.pop_front() {
            Some(output) => Ok(output),
            None if self.flights.is_empty() => return None,
            None => self.finish_oldest(),
        };
        match &result {
            // Now and not when it landed, which depends on how fast the device is.
            Ok(output) => {
                self.speeds = output.speeds;
                self.host_speeds.pop_front();
            }
            Err(_) => self.fail(),
        }
        Some(result)
    }

    /// Gives up all steps in flight. The next one can carry nothing over.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.finished.clear();
        self.last_bodies.forget();
        self.host_speeds.clear();
        self.speeds = Speeds::NONE;
        self.bodies = 0;
    }

    fn fail(&mut self) {
        self.forget();
        // Nobody knows which meshes arrived: the next step writes all of them.
        self.arena = self.empty_arena();
    }

    /// Without any mesh.
    fn empty_arena(&self) -> Arena {
        if self.has_features {
            Arena::with_features()
        } else {
            Arena::default()
        }
    }

    /// Where the bodies are after the last step that was submitted, for which it waits.
    ///
    /// # Errors
    /// As [`GpuStep::take`].
    pub fn motions(&mut self) -> Result<Vec<Motion>, StepError> {
        let words = self.bodies as usize * size_of::<layout::Moved>() / 4;
        let read = self.finish_all().and_then(|()| {
            let words = read_words(&self.gpu, &self.buffers.moved, words);
            words.map_err(StepError::Device)
        });
        let words = read.inspect_err(|_| self.fail())?;
        let moved: &[layout::Moved] = bytemuck::cast_slice(&words);
        Ok(moved.iter().map(Motion::from).collect())
    }

    /// The poses on the device, to draw from.
    pub fn poses(&self) -> Poses<'_> {
        Poses {
            previous: if self.last_bodies.is_empty() {
                &self.buffers.bodies
            } else {
                &self.buffers.before
            },
            current: &self.buffers.moved,
            bodies: self.bodies,
        }
    }
}

/// Two poses of every body, in the order of the last step that was submitted; its results may not be known yet.
#[derive(Clone, Copy, Debug)]
pub struct Poses<'a> {
    /// Before that step: an array of `Body` of `shaders/shared/types.wgsl`, 144 bytes each, which begins with position, mesh and
    /// rotation.
    pub previous: &'a Buffer,
    /// After it: an array of `Moved`, 64 bytes each, which begins with position, a word of padding and rotation.
    pub current: &'a Buffer,
    /// How many there are.
    pub bodies: u32,
}
