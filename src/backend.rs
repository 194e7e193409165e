//! What the stages run on, how it is chosen, and what happens when it fails.

use crate::settings::Backend;
use crate::stages::Stage;
use crate::stages::state::StepState;
use bevy::prelude::*;
use rayon::ThreadPool;

#[cfg(feature = "gpu")]
use crate::gpu::{
    device::{self, Gpu},
    step::{GpuStep, StepError},
};

/// Where the stages run at present, and why there. Changes when a device fails.
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
    /// Nowhere: no collision is found and no body moves.
    None {
        /// Why, and what to do.
        reason: String,
    },
}

impl ActiveBackend {
    /// `cpu`, `gpu` or `none`, for reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cpu { .. } => "cpu",
            Self::Gpu { .. } => "gpu",
            Self::None { .. } => "none",
        }
    }
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
    #[cfg(feature = "gpu")]
    gpu: Option<Box<GpuStep>>,
    /// How often a lost device may still be replaced.
    #[cfg(feature = "gpu")]
    retries: u32,
    /// Whether an adapter that computes on the CPU will do.
    #[cfg(feature = "gpu")]
    software: bool,
    active: ActiveBackend,
    /// What failed since it was last asked.
    failure: Option<String>,
}

/// A device that is lost once, by a driver update say, works when it is opened anew; one that is lost again and again has
/// a reason.
#[cfg(feature = "gpu")]
const RETRIES: u32 = 3;

impl Engine {
    /// Makes the choice.
    ///
    /// # Errors
    /// If nothing can run the stages: why, and what to do.
    pub fn new(backend: Backend, threads: usize) -> Result<Self, String> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("faceoff step {i}"))
            .build()
            .map_err(|error| format!("there are no threads to work on: {error}"))?;
        let threads = pool.current_num_threads();
        let on_cpu = |reason: &str| ActiveBackend::Cpu {
            threads,
            reason: reason.to_string(),
        };
        let mut engine = Self {
            pool,
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            retries: RETRIES,
            #[cfg(feature = "gpu")]
            software: backend == Backend::Gpu,
            active: on_cpu("Backend::Cpu asks for it"),
            failure: None,
        };
        if backend != Backend::Cpu
            && let Err(reason) = engine.open()
        {
            if backend == Backend::Gpu {
                return Err(reason);
            }
            engine.active = on_cpu(&reason);
        }
        Ok(engine)
    }

    /// Where the stages run.
    pub fn active(&self) -> &ActiveBackend {
        &self.active
    }

    #[cfg(feature = "gpu")]
    fn open(&mut self) -> Result<(), String> {
        let opened = device::open(self.software).and_then(GpuStep::new);
        let gpu = opened.map_err(|error| error.to_string())?;
        let info = &gpu.gpu().info;
        self.active = ActiveBackend::Gpu {
            adapter: format!("{} ({})", info.name, info.backend),
        };
        self.gpu = Some(Box::new(gpu));
        Ok(())
    }

    #[cfg(not(feature = "gpu"))]
    fn open(&mut self) -> Result<(), String> {
        Err("bevy_faceoff was built without its feature `gpu`".into())
    }

    /// The device, if the stages run on one.
    #[cfg(feature = "gpu")]
    pub fn gpu(&self) -> Option<&Gpu> {
        self.gpu.as_ref().map(|step| step.gpu())
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

    /// Drops a device that failed, and takes another one if that may help.
    #[cfg(feature = "gpu")]
    fn replace(&mut self, error: &StepError) {
        let Some(failed) = self.gpu.take() else { return };
        let name = failed.gpu().info.name.clone();
        drop(failed);
        let lost = matches!(error, StepError::Device(_));
        if lost && self.retries > 0 {
            self.retries -= 1;
            if self.open().is_ok() {
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

    /// What failed since the last call.
    pub fn take_failure(&mut self) -> Option<String> {
        self.failure.take()
    }
}
