//! Steps on the device: everything in, one submission, everything out, at once or some steps later.
//!
//! A step can go on from the one before although the host has not seen its results: poses and velocities stay on the
//! device. If a list turns out to be too short a flag on the device turns that step and all later ones into nothing;
//! the host makes the list longer and sends them off again.

use super::arena::{Arena, Change};
use super::buffers::{Buffers, Sizes, TooLarge};
use super::device::{Gpu, NoGpu};
use super::flight::Flight;
use super::kernel::{Builder, Kernel, Kernels, Program};
use super::layout::{self, CUT_SHORT, HITS, PLANE_CONTACTS, SKIPPED, SPHERE_PAIRS};
use super::readback::{read_words, scoped, staging};
use super::results::{Detail, Output, Parts};
use super::timer::Timer;
use super::upload::{Carried, Input};
use super::{radix_sort, scan};
use crate::stages::state::{Motion, StepState};
use crate::stages::{Stage, angles, broad_phase, force_scan, integrate, triangle_test};
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

/// Every kernel there is.
pub fn kernels() -> impl Iterator<Item = &'static Kernel> {
    (scan::KERNELS.into_iter())
        .chain(radix_sort::KERNELS)
        .chain(broad_phase::gpu::KERNELS)
        .chain(angles::gpu::KERNELS)
        .chain(triangle_test::gpu::KERNELS)
        .chain(force_scan::gpu::KERNELS)
        .chain(integrate::gpu::KERNELS)
}

/// The five stages on a device.
pub struct GpuStep {
    gpu: Gpu,
    kernels: Kernels,
    arena: Arena,
    buffers: Buffers,
    program: Program,
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

/// Each repeat needs at least one list to grow, and an earlier list may hide what a later one needs.
const REPEATS: usize = 8;

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
            let kernels = Kernels::new(&gpu, kernels())?;
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
        self.buffers.bytes()
    }

    /// Dispatches of each stage, in order.
    pub fn dispatches(&self) -> [usize; Stage::COUNT] {
        Stage::ALL.map(|stage| self.program.len(stage))
    }

    /// Runs all five stages on `state` and waits for the results. Steps in flight are given up.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails. `state` is then as it was.
    pub fn run(&mut self, state: &mut StepState) -> Result<(), StepError> {
        self.forget();
        self.submit(state, &[], Detail::All)?;
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
    pub fn submit(&mut self, state: &StepState, carried: &[Option<Carried>], detail: Detail) -> Result<(), StepError> {
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
        if let Some(output) = self.landed.pop_front() {
            return Some(Ok(output));
        }
        if self.flights.is_empty() {
            return None;
        }
        let result = self.land();
        if result.is_err() {
            self.fail();
        }
        Some(result)
    }

    /// Gives up all steps in flight. The next one can carry nothing over.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.landed.clear();
    }

    fn fail(&mut self) {
        self.forget();
        // Nobody knows which meshes arrived: the next step writes all of them.
        self.arena = Arena::default();
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
            previous: &self.buffers.bodies,
            current: &self.buffers.moved,
            bodies: self.bodies,
        }
    }

    fn submit_within(
        &mut self,
        state: &StepState,
        carried: &[Option<Carried>],
        detail: Detail,
    ) -> Result<(), StepError> {
        let input = Input::new(state, carried);
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
        if self.buffers.sizes.grown(needed) != self.buffers.sizes {
            self.settle()?;
        }
        if !self.make_room(needed)? {
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
        for _ in 0..REPEATS {
            let Some(flight) = self.flights.front_mut() else { break };
            let results = scoped(&self.gpu, || flight.wait(&self.gpu));
            let (raw, waited) = results.and_then(|results| results).map_err(StepError::Device)?;
            self.waits += u64::from(waited);
            if raw.counters[CUT_SHORT as usize] != 0 {
                return Err(StepError::CutShort);
            }
            if raw.counters[SKIPPED as usize] == 0
                && let Some(flight) = self.flights.pop_front()
            {
                self.spare.push(flight.staging);
                return Ok(raw.sort(&flight.input, self.timer.as_ref()));
            }
            self.repeat(&raw.counters)?;
        }
        Err(StepError::Device(
            "lists stay too short however long they are made".into(),
        ))
    }

    /// Runs all steps in flight again, with longer lists. Nothing has moved: the first one found a list too short, and
    /// that made the others do nothing.
    fn repeat(&mut self, counters: &[u32]) -> Result<(), StepError> {
        self.make_room(Sizes {
            pairs: counters[SPHERE_PAIRS as usize],
            hits: counters[HITS as usize],
            plane_contacts: counters[PLANE_CONTACTS as usize],
            ..Sizes::default()
        })?;
        for flight in std::mem::take(&mut self.flights) {
            self.launch(flight.input, flight.detail)?;
        }
        Ok(())
    }

    /// Makes lists longer where they do not suffice, and tells whether it did; the meshes are written anew then.
    fn make_room(&mut self, needed: Sizes) -> Result<bool, StepError> {
        let grown = self.buffers.sizes.grown(needed);
        if grown == self.buffers.sizes {
            return Ok(false);
        }
        let made = scoped(&self.gpu, || {
            let buffers = Buffers::new(&self.gpu, grown)?;
            let program = program(&self.gpu, &self.kernels, &buffers);
            // The only thing that outlives a step.
            let (from, to) = (&self.buffers.moved, &buffers.moved);
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size().min(to.size()));
            self.gpu.queue.submit([encoder.finish()]);
            Ok::<_, TooLarge>((buffers, program))
        });
        (self.buffers, self.program) = made.map_err(StepError::Device)??;
        self.spare.clear();
        self.write(self.arena.contents())?;
        Ok(true)
    }

    fn write(&self, changes: Vec<Change>) -> Result<(), StepError> {
        if changes.is_empty() {
            return Ok(());
        }
        scoped(&self.gpu, || {
            for change in changes {
                let queue = &self.gpu.queue;
                match change {
                    Change::Words(at, words) => {
                        queue.write_buffer(&self.buffers.words, 4 * u64::from(at), bytemuck::cast_slice(&words));
                    }
                    Change::Header(slot, header) => {
                        let at = u64::from(slot) * size_of::<layout::Mesh>() as u64;
                        queue.write_buffer(&self.buffers.meshes, at, bytemuck::bytes_of(&header));
                    }
                }
            }
        })
        .map_err(StepError::Device)
    }

    fn launch(&mut self, input: Input, detail: Detail) -> Result<(), StepError> {
        let Self {
            gpu,
            buffers,
            program,
            timer,
            flights,
            spare,
            ..
        } = self;
        let parts = Parts::new(&buffers.sizes, input.len(), detail);
        let flight = scoped(gpu, || {
            input.write(gpu, buffers);
            if flights.is_empty() {
                // No list is known to be too short.
                gpu.queue.write_buffer(&buffers.status, 0, &[0; 16]);
            }
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("faceoff step"),
            });
            encoder.clear_buffer(&buffers.buckets, 0, None);
            encoder.clear_buffer(&buffers.body_contacts, 0, None);
            for stage in Stage::ALL {
                let timestamps = timer.as_ref().map(|timer| timer.around(stage));
                program.record(stage, &mut encoder, input.len(), &buffers.arguments, timestamps);
            }
            if let Some(timer) = timer {
                timer.resolve(&mut encoder);
            }
            let fitting = spare.iter().position(|buffer| buffer.size() >= parts.total);
            let staging = match fitting {
                Some(at) => spare.swap_remove(at),
                None => staging(gpu, parts.total),
            };
            parts.copy(buffers, timer.as_ref(), &mut encoder, &staging);
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
    /// Before that step: an array of `Body` of `shaders/types.wgsl`, 128 bytes each, which begins with position, mesh and
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
            // Its kernels are not part of the step yet: `Response::Contacts` runs on the CPU.
            Stage::Manifolds => {}
            Stage::ForceScan => force_scan::gpu::record(&mut builder, buffers),
            Stage::Integrate => integrate::gpu::record(&mut builder, buffers),
        }
    }
    builder.finish()
}
