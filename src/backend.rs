//! What the stages run on, how it is chosen, and what happens when it fails.

use crate::settings::{Backend, Reading};
use crate::stages::Stage;
use crate::stages::state::StepState;
use bevy::prelude::*;
use rayon::ThreadPool;

#[cfg(feature = "gpu")]
use crate::gpu::{
    device::{self, Gpu, NoGpu},
    results::{Detail, Output},
    step::{GpuStep, StepError},
    upload::Carried,
};
#[cfg(feature = "gpu")]
use std::thread::JoinHandle;

/// Where the stages run at present, and why there. Changes when a device is ready, and when it fails.
#[derive(Resource, Clone, Debug, PartialEq, Eq)]
pub enum ActiveBackend {
    /// On the CPU.
    Cpu {
        /// Threads of the step's own pool.
        threads: usize,
        /// Why not on a GPU.
        reason: String,
    },
    /// On a GPU.
    Gpu {
        /// The adapter's name and driver interface.
        adapter: String,
    },
    /// Not yet: a GPU is looked for and kernels are compiled. Bodies do not move.
    Opening,
    /// Nowhere: no collision is found and no body moves.
    None {
        /// Why, and what to do.
        reason: String,
    },
}

impl ActiveBackend {
    /// `cpu`, `gpu`, `opening` or `none`, for reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cpu { .. } => "cpu",
            Self::Gpu { .. } => "gpu",
            Self::Opening => "opening",
            Self::None { .. } => "none",
        }
    }
}

/// The first step is about to run: the choice is made, and what the stages need is compiled.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct BackendReady {
    /// Where they run.
    pub active: ActiveBackend,
}

/// The device on which the stages ran failed. They went on with the same step where [`ActiveBackend`] says: on the device
/// opened anew, or on the CPU.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct BackendFailed {
    /// What happened, and what to do.
    pub reason: String,
}

/// What runs the stages.
pub(crate) struct Engine {
    /// The threads that the CPU stages run on. A pool of their own: rayon's global one serves jobs from outside last, so
    /// a bake on it would hold up every step.
    pub pool: ThreadPool,
    backend: Backend,
    #[cfg(feature = "gpu")]
    reading: Reading,
    #[cfg(feature = "gpu")]
    gpu: Option<Box<GpuStep>>,
    #[cfg(feature = "gpu")]
    opening: Option<JoinHandle<Result<GpuStep, NoGpu>>>,
    /// How often a lost device may still be replaced.
    #[cfg(feature = "gpu")]
    retries: u32,
    active: ActiveBackend,
    /// Whether anybody knows where the stages run.
    told: bool,
    /// What failed since it was last asked.
    failure: Option<String>,
}

/// A device that is lost once, by a driver update say, works when it is opened anew; one that is lost again and again has
/// a reason.
#[cfg(feature = "gpu")]
const RETRIES: u32 = 3;

impl Engine {
    /// Makes the choice; with [`Reading::Latent`] and [`Reading::Resident`] in the background.
    ///
    /// # Errors
    /// If there are no threads to run on.
    pub fn new(backend: Backend, threads: usize, reading: Reading) -> Result<Self, String> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("faceoff step {i}"))
            .build()
            .map_err(|error| format!("there are no threads to work on: {error}"))?;
        let mut engine = Self {
            pool,
            backend,
            #[cfg(feature = "gpu")]
            reading,
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            opening: None,
            #[cfg(feature = "gpu")]
            retries: RETRIES,
            active: ActiveBackend::Opening,
            told: false,
            failure: None,
        };
        engine.start(reading);
        Ok(engine)
    }

    #[cfg(feature = "gpu")]
    fn start(&mut self, reading: Reading) {
        let software = self.backend == Backend::Gpu;
        if self.backend == Backend::Cpu {
            self.fall_back("Backend::Cpu asks for it");
        } else if matches!(reading, Reading::Auto | Reading::Lockstep) {
            self.opened(open(software));
        } else {
            let thread = std::thread::Builder::new().name("faceoff kernels".into());
            match thread.spawn(move || open(software)) {
                Ok(opening) => self.opening = Some(opening),
                Err(_) => self.opened(open(software)),
            }
        }
    }

    #[cfg(not(feature = "gpu"))]
    fn start(&mut self, _: Reading) {
        match self.backend {
            Backend::Cpu => self.fall_back("Backend::Cpu asks for it"),
            _ => self.fall_back("bevy_faceoff was built without its feature `gpu`"),
        }
    }

    /// Takes what there is: a device, or the reason why there is none.
    #[cfg(feature = "gpu")]
    fn opened(&mut self, opened: Result<GpuStep, NoGpu>) {
        match opened {
            Ok(gpu) => {
                let info = &gpu.gpu().info;
                self.active = ActiveBackend::Gpu {
                    adapter: format!("{} ({})", info.name, info.backend),
                };
                self.gpu = Some(Box::new(gpu));
            }
            Err(error) => self.fall_back(&error.to_string()),
        }
    }

    /// The CPU does the work, unless a GPU was insisted on.
    fn fall_back(&mut self, reason: &str) {
        let reason = reason.to_string();
        self.active = if self.backend == Backend::Gpu {
            ActiveBackend::None { reason }
        } else {
            ActiveBackend::Cpu {
                threads: self.pool.current_num_threads(),
                reason,
            }
        };
    }

    /// Where the stages run, once that is known; only the first time.
    pub fn poll(&mut self) -> Option<ActiveBackend> {
        #[cfg(feature = "gpu")]
        if let Some(opening) = self.opening.take_if(|opening| opening.is_finished()) {
            match opening.join() {
                Ok(opened) => self.opened(opened),
                Err(_) => self.fall_back("the driver panicked while kernels were compiled"),
            }
        }
        if self.told || self.active == ActiveBackend::Opening {
            return None;
        }
        self.told = true;
        Some(self.active.clone())
    }

    /// Where the stages run.
    pub fn active(&self) -> &ActiveBackend {
        &self.active
    }

    /// Runs a stage. A device runs all five at once, when it is asked for the first. If it fails nothing has moved: the
    /// same step runs again on a new device, or on the CPU.
    pub fn run(&mut self, stage: Stage, state: &mut StepState) {
        #[cfg(feature = "gpu")]
        while let Some(gpu) = &mut self.gpu {
            if stage != Stage::BroadPhase {
                return;
            }
            match gpu.run(state) {
                Ok(()) => return,
                Err(error) => self.replace(&error),
            }
        }
        self.pool.install(|| stage.run_on_cpu(state));
    }

    /// Steps whose results are on their way, and how often one was waited for.
    pub fn flights(&self) -> (usize, u64) {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            return (gpu.in_flight(), gpu.waits());
        }
        (0, 0)
    }

    /// What failed since the last call.
    pub fn take_failure(&mut self) -> Option<String> {
        self.failure.take()
    }
}

#[cfg(feature = "gpu")]
fn open(software: bool) -> Result<GpuStep, NoGpu> {
    device::open(software).and_then(GpuStep::new)
}

#[cfg(feature = "gpu")]
impl Engine {
    /// The stages on a device, if they run on one.
    pub fn gpu_step(&mut self) -> Option<&mut GpuStep> {
        self.gpu.as_deref_mut()
    }

    /// The same, only to look.
    pub fn gpu(&self) -> Option<&GpuStep> {
        self.gpu.as_deref()
    }

    /// The device, if the stages run on one.
    pub fn device(&self) -> Option<&Gpu> {
        self.gpu.as_ref().map(|step| step.gpu())
    }

    /// What comes back of a step, if that is later and not at once.
    pub fn latent(&self) -> Option<Detail> {
        match (&self.gpu, self.reading) {
            (Some(_), Reading::Latent) => Some(Detail::All),
            (Some(_), Reading::Resident) => Some(Detail::Counts),
            _ => None,
        }
    }

    /// Sends a step off, and waits for the one that was sent off `latency` steps before, if there is one. `None` if the
    /// device failed: the step is to be run anew, by what [`Engine::latent`] then says, with nothing carried over.
    pub fn advance(
        &mut self,
        state: &StepState,
        carried: &[Option<Carried>],
        detail: Detail,
        latency: usize,
    ) -> Option<Option<Output>> {
        let gpu = self.gpu.as_mut()?;
        let result = gpu.submit(state, carried, detail).and_then(|()| {
            if gpu.in_flight() > latency {
                gpu.take().transpose()
            } else {
                Ok(None)
            }
        });
        match result {
            Ok(output) => Some(output),
            Err(error) => {
                self.replace(&error);
                None
            }
        }
    }

    /// Drops a device that failed, and takes another one if that may help.
    pub fn replace(&mut self, error: &StepError) {
        let Some(failed) = self.gpu.take() else { return };
        let name = failed.gpu().info.name.clone();
        drop(failed);
        let lost = matches!(error, StepError::Device(_));
        if lost && self.retries > 0 {
            self.retries -= 1;
            if let Ok(gpu) = open(self.backend == Backend::Gpu) {
                self.opened(Ok(gpu));
                self.failure = Some(format!("{name} failed and was opened anew: {error}"));
                return;
            }
        }
        let reason = format!("{name} cannot go on, and the CPU takes over: {error}");
        self.active = ActiveBackend::Cpu {
            threads: self.pool.current_num_threads(),
            reason: reason.clone(),
        };
        self.failure = Some(reason);
    }
}
