//! What the stages run on, how it is chosen, and what happens when it fails.

use crate::settings::Backend;
use crate::stages::Stage;
use crate::stages::state::StepState;
use bevy::prelude::*;
use rayon::ThreadPool;

#[cfg(feature = "gpu")]
use crate::gpu::{
    device::{self, NoGpu},
    step::GpuStep,
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

/// The device on which the stages ran failed; they went on, from the same step, where
/// [`ActiveBackend`] says.
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
    /// What failed since it was last asked.
    failure: Option<String>,
}

impl Engine {
    /// Makes the choice, and tells what it is.
    ///
    /// # Errors
    /// If nothing can run the stages.
    pub fn new(backend: Backend, threads: usize) -> Result<(Self, ActiveBackend), String> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("faceoff step {i}"))
            .build()
            .map_err(|error| format!("there are no threads to work on: {error}"))?;
        let threads = pool.current_num_threads();
        let engine = Self {
            pool,
            #[cfg(feature = "gpu")]
            gpu: None,
            failure: None,
        };
        engine.choose(backend, threads)
    }

    #[cfg(feature = "gpu")]
    fn choose(mut self, backend: Backend, threads: usize) -> Result<(Self, ActiveBackend), String> {
        let opened = match backend {
            Backend::Cpu => {
                let reason = "Backend::Cpu asks for it".into();
                return Ok((self, ActiveBackend::Cpu { threads, reason }));
            }
            Backend::Auto => open(false),
            Backend::Gpu => open(true),
        };
        match opened {
            Ok(gpu) => {
                let info = &gpu.gpu().info;
                let adapter = format!("{} ({})", info.name, info.backend);
                self.gpu = Some(Box::new(gpu));
                Ok((self, ActiveBackend::Gpu { adapter }))
            }
            Err(error) if backend == Backend::Gpu => Err(error.to_string()),
            Err(error) => {
                let reason = error.to_string();
                Ok((self, ActiveBackend::Cpu { threads, reason }))
            }
        }
    }

    #[cfg(not(feature = "gpu"))]
    fn choose(self, backend: Backend, threads: usize) -> Result<(Self, ActiveBackend), String> {
        let reason = match backend {
            Backend::Gpu => return Err("bevy_faceoff was built without its feature `gpu`: enable it".into()),
            Backend::Auto => "bevy_faceoff was built without its feature `gpu`".into(),
            Backend::Cpu => "Backend::Cpu asks for it".into(),
        };
        Ok((self, ActiveBackend::Cpu { threads, reason }))
    }

    /// Runs a stage. A device runs all five at once, when it is asked for the first. If it fails nothing has moved: the
    /// CPU takes over with the same stage, for good.
    pub fn run(&mut self, stage: Stage, state: &mut StepState) {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &mut self.gpu {
            if stage != Stage::BroadPhase {
                return;
            }
            match gpu.run(state) {
                Ok(()) => return,
                Err(error) => {
                    self.failure = Some(format!(
                        "{} cannot go on: {error}. The CPU takes over; restart the app to use the GPU again",
                        gpu.gpu().info.name
                    ));
                    self.gpu = None;
                }
            }
        }
        self.pool.install(|| stage.run_on_cpu(state));
    }

    /// What failed since the last call, and where the stages run now.
    pub fn take_failure(&mut self) -> Option<(String, ActiveBackend)> {
        let reason = self.failure.take()?;
        let active = ActiveBackend::Cpu {
            threads: self.pool.current_num_threads(),
            reason: reason.clone(),
        };
        Some((reason, active))
    }
}

#[cfg(feature = "gpu")]
fn open(software: bool) -> Result<GpuStep, NoGpu> {
    GpuStep::new(device::open(software)?)
}
