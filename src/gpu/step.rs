//! One step on the device: everything in, one submission, everything out.

use super::arena::{Arena, Change};
use super::buffers::{Buffers, Sizes, TooLarge};
use super::device::{Gpu, NoGpu};
use super::kernel::{Builder, Kernel, Kernels, Program};
use super::layout::{self, COUNTERS, CUT_SHORT, HITS, PLANE_CONTACTS, SKIPPED, SPHERE_PAIRS};
use super::readback::scoped;
use super::results::Results;
use super::timer::Timer;
use super::upload;
use super::{radix_sort, scan};
use crate::stages::state::StepState;
use crate::stages::{Stage, angles, broad_phase, force_scan, integrate, triangle_test};
use thiserror::Error;

/// Why a step did not run.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StepError {
    /// More than the device can hold.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The device reports an error, is lost, or cannot finish a kernel.
    #[error("the device says: {0}")]
    Device(String),
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
    results: Results,
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
                results: Results::default(),
                gpu,
                kernels,
                arena: Arena::default(),
                buffers,
                program,
                timer,
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
    pub fn dispatches(&self) -> [usize; 5] {
        Stage::ALL.map(|stage| self.program.len(stage))
    }

    /// Runs all five stages on `state` and waits for the results.
    ///
    /// # Errors
    /// If the device cannot hold the lists, or fails. `state` is then as it was, its results stale.
    pub fn run(&mut self, state: &mut StepState) -> Result<(), StepError> {
        let result = self.run_within(state);
        if result.is_err() {
            // Nobody knows which meshes arrived: the next step writes all of them.
            self.arena = Arena::default();
        }
        result
    }

    fn run_within(&mut self, state: &mut StepState) -> Result<(), StepError> {
        let changes = self.arena.update(&state.meshes)?;
        let needed = Sizes {
            bodies: state.bodies.len() as u32,
            planes: state.planes.len() as u32,
            meshes: self.arena.slots(),
            words: self.arena.words(),
            ..Sizes::default()
        };
        if !self.make_room(needed)? {
            self.write(changes)?;
        }
        for _ in 0..REPEATS {
            self.submit(state)?;
            let counters = self.results.counters(&self.gpu).map_err(StepError::Device)?;
            if counters[CUT_SHORT as usize] != 0 {
                return Err(StepError::Device(
                    "it left the test of a pair before the end: too many triangles of the two are near each other"
                        .into(),
                ));
            }
            if counters[SKIPPED as usize] == 0 {
                return self
                    .results
                    .fetch(&self.gpu, &self.buffers, &counters, state)
                    .map_err(StepError::Device)
                    .map(|()| self.note_times(state));
            }
            // Nothing has moved: the same step once more, with longer lists.
            self.make_room(Sizes {
                pairs: counters[SPHERE_PAIRS as usize],
                hits: counters[HITS as usize],
                plane_contacts: counters[PLANE_CONTACTS as usize],
                ..Sizes::default()
            })?;
        }
        Err(StepError::Device(
            "lists stay too short however long they are made".into(),
        ))
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
            Ok::<_, TooLarge>((buffers, program))
        });
        (self.buffers, self.program) = made.map_err(StepError::Device)??;
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

    fn submit(&mut self, state: &StepState) -> Result<(), StepError> {
        let Self {
            gpu,
            buffers,
            program,
            timer,
            results,
            ..
        } = self;
        let bodies = state.bodies.len() as u32;
        scoped(gpu, || {
            upload::write(gpu, buffers, state);
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("faceoff step"),
            });
            encoder.clear_buffer(&buffers.buckets, 0, None);
            encoder.clear_buffer(&buffers.body_contacts, 0, None);
            for stage in Stage::ALL {
                let timestamps = timer.as_ref().map(|timer| timer.around(stage));
                program.record(stage, &mut encoder, bodies, &buffers.arguments, timestamps);
            }
            if let Some(timer) = timer {
                timer.resolve(&mut encoder);
            }
            results.copy_counters(gpu, buffers, &mut encoder);
            gpu.queue.submit([encoder.finish()]);
        })
        .map_err(StepError::Device)
    }

    fn note_times(&self, state: &mut StepState) {
        state.times = match &self.timer {
            Some(timer) => timer.read(&self.gpu).unwrap_or_default(),
            None => Default::default(),
        };
    }
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
            Stage::ForceScan => force_scan::gpu::record(&mut builder, buffers),
            Stage::Integrate => integrate::gpu::record(&mut builder, buffers),
        }
    }
    builder.finish()
}

/// Words of the counters.
pub(super) const COUNTER_BYTES: u64 = 4 * COUNTERS as u64;
