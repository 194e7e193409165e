//! What the stages run on, how it is chosen, and what happens when it fails.
//!
//! With the feature `bevy_render`, and a renderer in the app that has a device, the stages run on that device and open none
//! of their own. They begin when the renderer's plugins are finished, and with [`Reading::Auto`] results are published
//! [two steps later](Reading::Latent).
//!
//! **If the renderer loses its device** the app ends, unless it has a `RenderErrorHandler` that recovers: so Bevy decides.
//! With `recover_from_device_loss` of this module as that handler the bodies stand still until Bevy has a new device, and then
//! go on from where their components say.

#[cfg(feature = "bevy_render")]
pub use crate::plugin::renderer::recover_from_device_loss;

use crate::plugin::settings::{Backend, Reading};
use crate::state::StepInput;
use crate::step::StepState;
use crate::types::stage::Stage;
use bevy::prelude::*;
use rayon::ThreadPool;

#[cfg(feature = "gpu")]
use crate::gpu::device::{self, Gpu, NoGpu};
use crate::gpu::readback::outlive;
use crate::step::gpu::results::{Detail, Output};
use crate::step::gpu::upload::Carried;
use crate::step::gpu::{GpuStep, StepError};
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
        /// Whether the device is that of Bevy's renderer.
        shared: bool,
    },
    /// Not yet: a GPU is looked for and kernels are compiled. Bodies do not move.
    Opening,
    /// The device of Bevy's renderer, on which the stages ran, is lost. Bodies do not move until the renderer has another.
    Lost,
    /// Nowhere: no collision is found and no body moves.
    None {
        /// Why, and what to do.
        reason: String,
    },
}

impl ActiveBackend {
    /// `cpu`, `gpu`, `opening`, `lost` or `none`, for reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cpu { .. } => "cpu",
            Self::Gpu { .. } => "gpu",
            Self::Opening => "opening",
            Self::Lost => "lost",
            Self::None { .. } => "none",
        }
    }
}

/// The first step is about to run, or the first one on the device that Bevy's renderer has instead of a lost one: the choice
/// is made, and what the stages need is compiled.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct BackendReady {
    /// Where they run.
    pub active: ActiveBackend,
}

/// The device on which the stages ran failed. They went on with the same step where [`ActiveBackend`] says: on the device
/// opened anew, or on the CPU; or they wait for the renderer's next one.
#[derive(Message, Clone, Debug, PartialEq, Eq)]
pub struct BackendFailed {
    /// What happened, and what to do.
    pub reason: String,
}

/// Where a device comes from.
#[cfg(feature = "gpu")]
#[derive(Clone)]
enum Source {
    /// It is not known yet whether Bevy's renderer has one.
    Unknown,
    /// The stages have one of their own.
    Own,
    /// Bevy's renderer.
    #[cfg_attr(not(feature = "bevy_render"), expect(dead_code, reason = "there is none"))]
    Renderer(Gpu),
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
    source: Source,
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
    /// Whether steps run on the CPU although there is a device.
    on_cpu: bool,
}

/// A device that is lost once, by a driver update say, works when it is opened anew; one that is lost again and again has
/// a reason.
#[cfg(feature = "gpu")]
const RETRIES: u32 = 3;

impl Engine {
    /// With nothing chosen yet.
    ///
    /// # Errors
    /// If there are no threads to run on.
    pub fn new(backend: Backend, threads: usize, reading: Reading) -> Result<Self, String> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("faceoff step {i}"))
            .build()
            .map_err(|error| format!("there are no threads to work on: {error}"))?;
        #[cfg(not(feature = "gpu"))]
        let _ = reading;
        Ok(Self {
            pool,
            backend,
            #[cfg(feature = "gpu")]
            reading,
            #[cfg(feature = "gpu")]
            source: Source::Unknown,
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            opening: None,
            #[cfg(feature = "gpu")]
            retries: RETRIES,
            active: ActiveBackend::Opening,
            told: false,
            failure: None,
            on_cpu: false,
        })
    }

    /// Makes the choice, if it is not made yet: a device of our own, or the CPU.
    #[cfg(feature = "gpu")]
    pub fn choose(&mut self) {
        if matches!(self.source, Source::Unknown) {
            self.source = Source::Own;
            self.start();
        }
    }

    /// Makes the choice, if it is not made yet.
    #[cfg(not(feature = "gpu"))]
    pub fn choose(&mut self) {
        match self.backend {
            _ if self.active != ActiveBackend::Opening => {}
            Backend::Cpu => self.fall_back("Backend::Cpu asks for it"),
            _ => self.fall_back("bevy_faceoff was built without its feature `gpu`"),
        }
    }

    /// Opens what the source has; in the background if results are not waited for.
    #[cfg(feature = "gpu")]
    fn start(&mut self) {
        self.active = ActiveBackend::Opening;
        self.told = false;
        let (source, software) = (self.source.clone(), self.backend == Backend::Gpu);
        if self.backend == Backend::Cpu {
            self.fall_back("Backend::Cpu asks for it");
        } else if self.reading() == Reading::Lockstep {
            self.opened(source.open(software, false));
        } else {
            let (thread, to_open) = (std::thread::Builder::new(), source.clone());
            let opening = thread.name("faceoff kernels".into());
            // What contacts need would hold up the first step if it were compiled then.
            match opening.spawn(move || to_open.open(software, true)) {
                Ok(opening) => self.opening = Some(opening),
                Err(_) => self.opened(source.open(software, false)),
            }
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
                    shared: matches!(self.source, Source::Renderer(_)),
                };
                self.gpu = Some(Box::new(gpu));
            }
            Err(error) if self.source.is_lost() => self.wait_for_renderer(&error.to_string()),
            Err(error) => self.fall_back(&error.to_string()),
        }
    }

    /// Nobody does the work until Bevy's renderer has a new device.
    #[cfg(feature = "gpu")]
    fn wait_for_renderer(&mut self, error: &str) {
        self.active = ActiveBackend::Lost;
        self.failure = Some(format!(
            "the device that the stages share with Bevy's renderer is lost: bodies stand still until the renderer has a new \
             one, for which the app needs a RenderErrorHandler that recovers, like backend::recover_from_device_loss: {error}"
        ));
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
        if self.told || matches!(self.active, ActiveBackend::Opening | ActiveBackend::Lost) {
            return None;
        }
        self.told = true;
        Some(self.active.clone())
    }

    /// Where the stages run.
    pub fn active(&self) -> &ActiveBackend {
        &self.active
    }

    /// Whether there is something to run a step on.
    pub fn runs(&self) -> bool {
        matches!(self.active, ActiveBackend::Cpu { .. } | ActiveBackend::Gpu { .. })
    }

    /// Whether steps that run on the CPU from now on, or no more, although there is a device, are steps that move.
    pub fn changes_place(&self, on_cpu: bool) -> bool {
        self.on_cpu != on_cpu && matches!(self.active, ActiveBackend::Gpu { .. })
    }

    /// Whether steps run on the CPU from now on, although there may be a device.
    pub fn keep_on_cpu(&mut self, on_cpu: bool) {
        if on_cpu && matches!(self.active, ActiveBackend::Gpu { .. }) {
            info_once!(
                "there are bodies with ContinuousCollision, and steps run on the CPU: a GPU does not stop fast bodies"
            );
        }
        self.on_cpu = on_cpu;
    }

    /// Runs a stage. A device runs all at once, when it is asked for the first. If it fails nothing has moved: the
    /// same step runs again on a new device, or on the CPU, or not at all if the renderer's next device has to be waited for.
    pub fn run(&mut self, stage: Stage, state: &mut StepState) {
        #[cfg(feature = "gpu")]
        while let Some(gpu) = self.gpu.as_mut().filter(|_| !self.on_cpu) {
            if stage != Stage::BroadPhase {
                return;
            }
            match gpu.run(state) {
                Ok(()) => return,
                Err(error) => self.replace(&error),
            }
        }
        if self.runs() {
            self.pool.install(|| crate::step::cpu::run(stage, state));
        }
    }

    /// Steps whose results are on their way, and how often one was waited for.
    pub fn flights(&self) -> (usize, u64) {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            return (gpu.in_flight(), gpu.waits());
        }
        (0, 0)
    }

    /// Whether something failed since the last call of [`Engine::take_failure`].
    pub fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// What failed since the last call.
    pub fn take_failure(&mut self) -> Option<String> {
        self.failure.take()
    }
}

#[cfg(feature = "gpu")]
impl Source {
    /// The stages on the source's device, if it suits them; ready for `contacts`, or when a step asks for them.
    fn open(&self, software: bool, contacts: bool) -> Result<GpuStep, NoGpu> {
        let gpu = match self {
            Self::Renderer(gpu) => device::suits(&gpu.info, &gpu.device.limits(), software).map(|()| gpu.clone()),
            Self::Own | Self::Unknown => device::open(software),
        };
        let gpu = gpu?;
        let adapter = gpu.info.name.clone();
        let make = || {
            let step = GpuStep::new(gpu)?;
            if contacts { step.with_contacts() } else { Ok(step) }
        };
        outlive(make).unwrap_or_else(|reason| Err(NoGpu::Failed { adapter, reason }))
    }

    /// Whether another device is Bevy's to open.
    fn is_lost(&self) -> bool {
        matches!(self, Self::Renderer(gpu) if device::is_lost(gpu))
    }
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

    /// Takes the device of Bevy's renderer, which has a new one, and tells whether anything changes: nothing is carried over
    /// then. Who has come to the CPU stays there.
    #[cfg(feature = "bevy_render")]
    pub fn share(&mut self, gpu: Gpu) -> bool {
        if self.backend == Backend::Cpu {
            return false;
        }
        let before = std::mem::replace(&mut self.source, Source::Renderer(gpu));
        if matches!(before, Source::Renderer(_)) && matches!(self.active, ActiveBackend::Cpu { .. }) {
            return false;
        }
        if let (Some(step), Source::Renderer(_)) = (self.gpu.take(), before) {
            let name = &step.gpu().info.name;
            self.retries = self.retries.saturating_sub(1);
            self.failure = Some(format!(
                "Bevy's renderer opened {name} anew, and the stages go on there"
            ));
        }
        self.opening = None;
        self.start();
        true
    }

    /// When results are published, with the choice made that [`Reading::Auto`] leaves open.
    fn reading(&self) -> Reading {
        match (self.reading, &self.source) {
            (Reading::Auto, Source::Renderer(_)) => Reading::Latent,
            (Reading::Auto, _) => Reading::Lockstep,
            (reading, _) => reading,
        }
    }

    /// What comes back of a step, if that is later and not at once.
    pub fn latent(&self) -> Option<Detail> {
        match (self.gpu.as_ref().filter(|_| !self.on_cpu), self.reading()) {
            (Some(_), Reading::Latent) => Some(Detail::All),
            (Some(_), Reading::Resident) => Some(Detail::Counts),
            _ => None,
        }
    }

    /// Sends a step off, and waits for the one that was sent off `latency` steps before, if there is one. `None` if the
    /// device failed: the step is to be run anew, by what [`Engine::latent`] then says, with nothing carried over.
    pub fn advance(
        &mut self,
        state: &StepInput,
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

    /// The results of the oldest step that was sent off, for which it waits. `None` if there is none, or if the device failed:
    /// nothing of what is on its way will come then.
    pub fn land(&mut self) -> Option<Output> {
        match self.gpu.as_mut()?.take()? {
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
            if self.source.is_lost() {
                return self.wait_for_renderer(&error.to_string());
            }
            if let Ok(gpu) = self.source.open(self.backend == Backend::Gpu, false) {
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
