//! Steps on the device: everything in, one submission, everything out, at once or some steps later.
//!
//! A step can go on from the one before although the host has not seen its results: poses and velocities stay on the
//! device. If a list turns out to be too short a flag on the device turns that step and all later ones into nothing;
//! the host makes the list longer and sends them off again.

pub mod contacts;
mod flight;
mod memory;
pub mod results;
mod room;
pub mod upload;

use crate::gpu::arena::Arena;
use crate::gpu::buffers::{Buffers, Sizes, TooLarge};
use crate::gpu::device::{Gpu, NoGpu};
use crate::gpu::kernel::{Builder, Kernel, Kernels, Program};
use crate::gpu::layout::{
    self, CONTACTS_CUT_SHORT, CUT_SHORT, HITS, MOST_PAIRS, PLANE_CONTACTS, SKIPPED, SPHERE_PAIRS, TOUCHES,
};
use crate::gpu::readback::{read_words, scoped, staging};
use crate::gpu::timer::Timer;
use crate::gpu::{radix_sort, scan};
use crate::integrate;
use crate::manifolds::gpu::ContactCapacity;
use crate::solver::speeds::Speeds;
use crate::state::{Motion, StepInput};
use crate::step::StepState;
use crate::triangle_test;
use crate::types::settings::Response;
use crate::types::stage::Stage;
use crate::{angles, broad_phase, force_scan};
use contacts::Contacts;
use contacts::input::{SolverInput, Told};
use contacts::lineage::Lineage;
use contacts::lists::StepCapacity;
use flight::Flight;
use results::{Detail, Output, Parts};
use std::collections::VecDeque;
use thiserror::Error;
use upload::{Carried, Input};
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

/// Every kernel there is.
pub fn kernels() -> impl Iterator<Item = &'static Kernel> {
    own_kernels().chain(contacts::all_kernels())
}

/// Those of a step without contact points.
fn own_kernels() -> impl Iterator<Item = &'static Kernel> {
    (scan::KERNELS.into_iter())
        .chain(radix_sort::KERNELS)
        .chain(broad_phase::gpu::KERNELS)
        .chain(angles::gpu::KERNELS)
        .chain(triangle_test::gpu::KERNELS)
        .chain(force_scan::gpu::KERNELS)
        .chain(integrate::gpu::KERNELS)
}

/// The stages on a device.
pub struct GpuStep {
    gpu: Gpu,
    kernels: Kernels,
    arena: Arena,
    buffers: Buffers,
    program: Program,
    /// What finds contact points and moves bodies by them, where somebody asks for it.
    contacts: Option<Contacts>,
    /// Somebody has: its kernels are compiled, and meshes come with their corners and edges.
    has_features: bool,
    /// Which body was which in the last step, if it had contacts.
    lineage: Lineage,
    /// How fast bodies moved after the last step whose results were taken.
    speeds: Speeds,
    /// What the host told of motions in the steps since, oldest first.
    told: VecDeque<Told>,
    timer: Option<Timer>,
    /// Submitted, oldest first.
    flights: VecDeque<Flight>,
    /// Results that were waited for before anybody asked for them; older than all flights.
    landed: VecDeque<Output>,
    /// Buffers to read from that no flight uses.
    spare: Vec<Buffer>,
    /// Bodies of the last step that was submitted.
    bodies: u32,
    waits: u64,
}

/// Lists start with room for this many things, and grow.
const START: Sizes = Sizes {
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
        Self::with_room(gpu, START)
    }

    /// With lists of these sizes to begin with: results do not depend on them.
    ///
    /// # Errors
    /// If the device cannot run the stages.
    pub fn with_room(gpu: Gpu, sizes: Sizes) -> Result<Self, NoGpu> {
        let made = scoped(&gpu, || {
            let kernels = Kernels::new(&gpu, own_kernels())?;
            let buffers = Buffers::new(&gpu, sizes).map_err(|error| error.to_string())?;
            let program = program(&gpu, &kernels, &buffers);
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
                lineage: Lineage::default(),
                speeds: Speeds::NONE,
                told: VecDeque::new(),
                has_features: false,
                timer,
                flights: VecDeque::new(),
                landed: VecDeque::new(),
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
        match self.want_contacts() {
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
    pub fn sizes(&self) -> Sizes {
        self.buffers.sizes
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.buffers.bytes() + self.contacts.as_ref().map_or(0, Contacts::bytes)
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

    /// Sends a step off. `carried` has an entry for each body of `state`, or none at all: bodies then are where `state`
    /// says.
    ///
    /// # Errors
    /// If the device cannot hold the bodies or meshes, or fails: all steps in flight are given up then.
    pub fn submit(&mut self, state: &StepInput, carried: &[Option<Carried>], detail: Detail) -> Result<(), StepError> {
        let result = self.submit_within(state, carried, detail);
        if result.is_err() {
            self.fail();
        }
        result
    }

    /// Steps that were submitted and not taken.
    pub fn in_flight(&self) -> usize {
        self.landed.len() + self.flights.len()
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
        let result = match self.landed.pop_front() {
            Some(output) => Ok(output),
            None if self.flights.is_empty() => return None,
            None => self.land(),
        };
        match &result {
            // Now and not when it landed, which depends on how fast the device is.
            Ok(output) => {
                self.speeds = output.speeds;
                self.told.pop_front();
            }
            Err(_) => self.fail(),
        }
        Some(result)
    }

    /// Gives up all steps in flight. The next one can carry nothing over.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.landed.clear();
        self.lineage.forget();
        self.told.clear();
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
        let read = self.settle().and_then(|()| {
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
            previous: if self.lineage.is_empty() {
                &self.buffers.bodies
            } else {
                &self.buffers.before
            },
            current: &self.buffers.moved,
            bodies: self.bodies,
        }
    }

    fn submit_within(
        &mut self,
        state: &StepInput,
        carried: &[Option<Carried>],
        detail: Detail,
    ) -> Result<(), StepError> {
        let wants_points = state.config.response != Response::Impulse;
        if wants_points {
            self.want_contacts()?;
        }
        let mut input = Input::new(state, carried);
        if state.config.response == Response::Contacts {
            let descent = self.lineage.follow(state);
            // What may have changed while the results are on their way: what the host told, and what falls.
            let push = self.told.iter().map(|told| told.push).sum();
            let fall = self.in_flight() as f32 * state.config.dt * state.config.gravity;
            let known = self
                .told
                .iter()
                .fold(self.speeds, |speeds, told| speeds.and(told.speeds));
            let solver = SolverInput::new(state, carried, known.after(push, fall), descent);
            self.told.push_back(solver.told);
            input = input.with_solver(solver);
        } else {
            self.lineage.forget();
            self.told.push_back(Told::default());
        }
        let mut changes = Vec::new();
        if !self.arena.holds(&state.meshes) {
            // Steps that must run again find their meshes where they were.
            self.settle()?;
            changes = self.arena.update(&state.meshes)?;
        }
        let needed = Sizes {
            bodies: input.len(),
            planes: state.planes.len() as u32,
            meshes: self.arena.slots(),
            words: self.arena.words(),
            ..Sizes::default()
        };
        if !wants_points && self.buffers.sizes.grown(needed) != self.buffers.sizes {
            // Swarms of impulses need no room for contact points: it is made again when somebody wants some.
            self.settle()?;
            self.contacts = None;
        }
        let for_contacts = self.contacts.as_ref().map(|contacts| StepCapacity {
            bodies: input.old_bodies(),
            ..contacts.room
        });
        if self.lacks(needed, for_contacts) {
            self.settle()?;
        }
        if !self.make_room(needed, for_contacts)? {
            self.write(changes)?;
        }
        self.bodies = input.len();
        self.launch(input, detail)
    }

    /// Waits until every step in flight has landed.
    fn settle(&mut self) -> Result<(), StepError> {
        while !self.flights.is_empty() {
            let output = self.land()?;
            self.landed.push_back(output);
        }
        Ok(())
    }

    /// Waits for the oldest flight.
    fn land(&mut self) -> Result<Output, StepError> {
        while let Some(flight) = self.flights.front_mut() {
            let results = scoped(&self.gpu, || flight.wait(&self.gpu));
            let (raw, waited) = results.and_then(|results| results).map_err(StepError::Device)?;
            self.waits += u64::from(waited);
            if raw.counters[CUT_SHORT as usize] != 0 || raw.tally[CONTACTS_CUT_SHORT as usize] != 0 {
                return Err(StepError::CutShort);
            }
            if raw.counters[SKIPPED as usize] == 0
                && let Some(flight) = self.flights.pop_front()
            {
                self.spare.push(flight.staging);
                return Ok(raw.sort(&flight.input, self.timer.as_ref()));
            }
            if !self.repeat(&raw.counters, &raw.tally)? {
                return Err(StepError::Device(
                    "a list is too short, and none needs to be longer".into(),
                ));
            }
        }
        Err(StepError::Device("there is no step to wait for".into()))
    }

    /// Runs all steps in flight again, with longer lists, and tells whether some list had to be longer. Nothing has moved:
    /// the first one found a list too short, and that made the others do nothing.
    fn repeat(&mut self, counters: &[u32], tally: &[u32]) -> Result<bool, StepError> {
        let needed = Sizes {
            pairs: counters[SPHERE_PAIRS as usize].max(tally[MOST_PAIRS as usize]),
            hits: counters[HITS as usize],
            plane_contacts: counters[PLANE_CONTACTS as usize],
            ..Sizes::default()
        };
        let for_contacts = self.contacts.as_ref().map(|contacts| StepCapacity {
            contacts: ContactCapacity::needed(tally),
            touches: tally[TOUCHES as usize],
            ..contacts.room
        });
        if !self.lacks(needed, for_contacts) {
            return Ok(false);
        }
        self.make_room(needed, for_contacts)?;
        for flight in std::mem::take(&mut self.flights) {
            self.launch(flight.input, flight.detail)?;
        }
        Ok(true)
    }

    fn launch(&mut self, input: Input, detail: Detail) -> Result<(), StepError> {
        let Self {
            gpu,
            kernels,
            contacts,
            buffers,
            program,
            timer,
            flights,
            spare,
            ..
        } = self;
        let wanted = input.response != Response::Impulse;
        let mut contacts = contacts.as_mut().filter(|_| wanted);
        let flight = scoped(gpu, || {
            if let (Some(contacts), Some(solver)) = (&mut contacts, &input.solver) {
                contacts.prepare(gpu, kernels, buffers, solver.passes());
            }
            let contacts = contacts.as_deref();
            let parts = Parts::new(&buffers.sizes, contacts, &input, detail);
            input.write(gpu, buffers, contacts);
            if flights.is_empty() {
                // No list is known to be too short.
                gpu.queue.write_buffer(&buffers.status, 0, &[0; 16]);
            }
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("faceoff step"),
            });
            encoder.clear_buffer(&buffers.buckets, 0, None);
            encoder.clear_buffer(&buffers.body_contacts, 0, None);
            match (contacts, &input.solver) {
                (Some(contacts), Some(solver)) => contacts.record(&mut encoder, buffers, solver, timer.as_ref()),
                (Some(contacts), None) => contacts.record_detection(&mut encoder, buffers, input.len(), timer.as_ref()),
                (None, _) => {
                    for stage in Stage::ALL {
                        let timestamps = timer.as_ref().map(|timer| timer.around(stage, 0));
                        program.record(stage, &mut encoder, input.len(), &buffers.arguments, timestamps);
                    }
                }
            }
            if let Some(timer) = timer {
                timer.resolve(&mut encoder, input.collision_substeps());
            }
            let fitting = spare.iter().position(|buffer| buffer.size() >= parts.total);
            let staging = match fitting {
                Some(at) => spare.swap_remove(at),
                None => staging(gpu, parts.total),
            };
            parts.copy(buffers, contacts, timer.as_ref(), &mut encoder, &staging);
            let submission = gpu.queue.submit([encoder.finish()]);
            Flight::new(input, detail, parts, staging, submission)
        });
        flights.push_back(flight.map_err(StepError::Device)?);
        Ok(())
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

/// All calls, by stage.
fn program(gpu: &Gpu, kernels: &Kernels, buffers: &Buffers) -> Program {
    let mut builder = Builder::new(gpu, kernels);
    for stage in Stage::ALL {
        builder.stage(stage);
        match stage {
            Stage::BroadPhase => broad_phase::gpu::record(&mut builder, buffers),
            Stage::Angles => angles::gpu::record(&mut builder, buffers),
            Stage::TriangleTest => triangle_test::gpu::record(&mut builder, buffers),
            // Impulses need no contact points.
            Stage::Manifolds => {}
            Stage::ForceScan => force_scan::gpu::record(&mut builder, buffers),
            Stage::Integrate => integrate::gpu::record(&mut builder, buffers),
        }
    }
    builder.finish()
}
