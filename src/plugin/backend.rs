//! The backend: whether the stages run on the CPU or on a GPU, and what happens when a device fails.
//!
//! With the feature `bevy_render`, in an app whose renderer has a device, the stages share that device and open none of
//! their own. They start when the renderer's plugins are finished. With [`Readback::Auto`] results are then published
//! [two steps later](Readback::Latent).
//!
//! **If the renderer loses its device**, Bevy's default handler ends the app. With `recover_from_device_loss` of this
//! module as the app's `RenderErrorHandler`, bodies stand still until Bevy has a new device, and then continue from the
//! state in their components.

#[cfg(feature = "bevy_render")]
pub use crate::plugin::renderer::recover_from_device_loss;

use crate::plugin::settings::{Backend, Readback};
#[cfg(feature = "gpu")]
use crate::state::StepInput;
use crate::step::StepState;
use crate::step::hooks::StepHooks;
use crate::step::pool::step_pool;
use crate::types::kernel_cache::KernelCache;
use crate::types::stage::Stage;
use bevy::prelude::*;
use rayon::ThreadPool;

#[cfg(feature = "gpu")]
use crate::gpu::device::{Gpu, NoGpu};
#[cfg(feature = "gpu")]
use crate::gpu::readback::DeviceError;
#[cfg(feature = "gpu")]
use crate::plugin::device_source::{Retries, Source};
#[cfg(feature = "gpu")]
use crate::step::gpu::results::{Detail, Output};
#[cfg(feature = "gpu")]
use crate::step::gpu::upload::Carried;
#[cfg(feature = "gpu")]
use crate::step::gpu::{GpuStep, StepError};
#[cfg(feature = "gpu")]
use std::thread::JoinHandle;

/// Where the stages run, and why. Changes when a device is ready, and when it fails.
#[derive(Resource, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Resource, Debug, PartialEq)]
pub enum ActiveBackend {
    /// On the CPU.
    Cpu {
        /// Number of threads of the step's pool.
        threads: usize,
        /// Why the stages do not run on a GPU.
        reason: String,
    },
    /// On a GPU.
    Gpu {
        /// Name and graphics API of the adapter.
        adapter: String,
        /// Whether the device belongs to Bevy's renderer or to the program.
        shared: bool,
    },
    /// A device is being opened and kernels are being compiled. Bodies do not move yet.
    Opening,
    /// The shared device of Bevy's renderer is lost. Bodies do not move until the renderer has a new one.
    Lost,
    /// There is no backend: no collisions are found and no body moves.
    None {
        /// The reason, and what to do.
        reason: String,
    },
}

impl ActiveBackend {
    /// The name for reports: `cpu`, `gpu`, `opening`, `lost` or `none`.
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

/// The backend is chosen and its kernels are compiled. Written before the first step, and before the first step on a
/// new device of Bevy's renderer.
#[derive(Message, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Message, Debug, PartialEq)]
pub struct BackendReady {
    /// The chosen backend.
    pub active: ActiveBackend,
}

/// The device on which the stages ran has failed. [`ActiveBackend`] shows where they continue with the same step: on
/// the reopened device or on the CPU. If it is [`ActiveBackend::Lost`], they wait for the renderer's new device.
#[derive(Message, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Message, Debug, PartialEq)]
pub struct BackendFailed {
    /// What happened, and what to do.
    pub reason: String,
}

/// Runs the stages on the chosen backend.
pub(crate) struct Engine {
    /// Threads of the CPU stages. `None`: the thread of the schedule is the only one. Rayon's global pool runs jobs
    /// from other threads last, so a bake on it would delay every step.
    pool: Option<ThreadPool>,
    /// Number of stages of the last step that used the pool.
    parallel_stages: u32,
    backend: Backend,
    #[cfg(feature = "gpu")]
    readback: Readback,
    #[cfg(feature = "gpu")]
    kernel_cache: KernelCache,
    #[cfg(feature = "gpu")]
    source: Source,
    #[cfg(feature = "gpu")]
    gpu: Option<Box<GpuStep>>,
    #[cfg(feature = "gpu")]
    opening: Option<JoinHandle<Result<GpuStep, NoGpu>>>,
    #[cfg(feature = "gpu")]
    retries: Retries,
    active: ActiveBackend,
    /// Whether `active` was returned by [`Engine::poll`].
    announced: bool,
    /// The failure that [`Engine::take_failure`] has not returned yet.
    failure: Option<String>,
    /// Whether steps run on the CPU although there is a device.
    on_cpu: bool,
    /// Whether the CPU stops bodies during a step on a device.
    pub has_fast_bodies: bool,
}

#[cfg(feature = "gpu")]
impl Drop for Engine {
    /// Waits for a device that is being opened. A driver may crash if the process ends while it compiles kernels.
    fn drop(&mut self) {
        if let Some(opening) = self.opening.take() {
            // What it has opened, or why not, is of no use any more.
            let _ = opening.join();
        }
    }
}

impl Engine {
    /// Creates the thread pool. The backend is not chosen yet.
    ///
    /// # Errors
    /// If the threads cannot be created.
    pub fn new(
        backend: Backend,
        threads: usize,
        readback: Readback,
        kernel_cache: KernelCache,
    ) -> Result<Self, String> {
        let pool = step_pool(threads).map_err(|e| format!("the threads of the step cannot be created: {e}"))?;
        #[cfg(not(feature = "gpu"))]
        let _ = (readback, kernel_cache);
        Ok(Self {
            pool,
            parallel_stages: 0,
            backend,
            #[cfg(feature = "gpu")]
            readback,
            #[cfg(feature = "gpu")]
            kernel_cache,
            #[cfg(feature = "gpu")]
            source: Source::Unknown,
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            opening: None,
            #[cfg(feature = "gpu")]
            retries: Retries::default(),
            active: ActiveBackend::Opening,
            announced: false,
            failure: None,
            on_cpu: false,
            has_fast_bodies: false,
        })
    }

    /// Chooses the backend, if that is still to be done: our own device, or the CPU.
    #[cfg(feature = "gpu")]
    pub fn choose(&mut self) {
        if matches!(self.source, Source::Unknown) {
            self.source = Source::Own;
            self.start();
        }
    }

    /// Chooses the device that the program gave, or the CPU.
    #[cfg(feature = "gpu")]
    pub fn choose_given(&mut self, gpu: Gpu) {
        self.source = Source::Given(Box::new(gpu));
        self.start();
    }

    /// Chooses the CPU, if that is still to be done.
    #[cfg(not(feature = "gpu"))]
    pub fn choose(&mut self) {
        match self.backend {
            _ if self.active != ActiveBackend::Opening => {}
            Backend::Cpu => self.fall_back("Backend::Cpu asks for it"),
            _ => self.fall_back("bevy_faceoff was built without its feature `gpu`"),
        }
    }

    /// Opens the device of `source` and compiles kernels; in the background with any [`Readback`] but `Lockstep`.
    #[cfg(feature = "gpu")]
    fn start(&mut self) {
        self.active = ActiveBackend::Opening;
        self.announced = false;
        self.source.give_up_lost();
        let (source, software) = (self.source.clone(), self.backend == Backend::Gpu);
        let kernels = self.kernel_cache.clone();
        if self.backend == Backend::Cpu {
            self.fall_back("Backend::Cpu asks for it");
        } else if cfg!(target_family = "wasm") {
            self.opened(Err(NoGpu::Web));
        } else if self.readback() == Readback::Lockstep {
            self.opened(source.open(software, false, &kernels));
        } else {
            let (thread, to_open) = (std::thread::Builder::new(), (source.clone(), kernels.clone()));
            let opening = thread.name("faceoff kernels".into());
            // Includes the kernels of contacts, whose compilation would delay the first step that needs them.
            match opening.spawn(move || to_open.0.open(software, true, &to_open.1)) {
                Ok(opening) => self.opening = Some(opening),
                Err(_) => self.opened(source.open(software, false, &kernels)),
            }
        }
    }

    /// Stores the opened device, or handles the error.
    #[cfg(feature = "gpu")]
    fn opened(&mut self, opened: Result<GpuStep, NoGpu>) {
        match opened {
            Ok(gpu) => {
                let info = &gpu.gpu().info;
                self.active = ActiveBackend::Gpu {
                    adapter: format!("{} ({})", info.name, info.backend),
                    shared: matches!(self.source, Source::Renderer(_) | Source::Given(_)),
                };
                self.gpu = Some(Box::new(gpu));
            }
            Err(error) if self.source.is_lost() => self.wait_for_renderer(&error.to_string()),
            Err(error) => self.fall_back(&error.to_string()),
        }
    }

    /// Stops until Bevy's renderer has a new device.
    #[cfg(feature = "gpu")]
    fn wait_for_renderer(&mut self, error: &str) {
        self.active = ActiveBackend::Lost;
        self.failure = Some(format!(
            "the device that the stages share with Bevy's renderer is lost: bodies stand still until the renderer has \
             a new one. To get one, the app needs a RenderErrorHandler that recovers, like \
             backend::recover_from_device_loss: {error}"
        ));
    }

    /// Falls back to the CPU, or to no backend with [`Backend::Gpu`].
    fn fall_back(&mut self, reason: &str) {
        let reason = reason.to_string();
        self.active = if self.backend == Backend::Gpu {
            ActiveBackend::None { reason }
        } else {
            ActiveBackend::Cpu {
                threads: self.threads(),
                reason,
            }
        };
    }

    /// The backend, once after it is ready.
    pub fn poll(&mut self) -> Option<ActiveBackend> {
        #[cfg(feature = "gpu")]
        if let Some(opening) = self.opening.take_if(|opening| opening.is_finished()) {
            match opening.join() {
                Ok(opened) => self.opened(opened),
                Err(_) => self.fall_back("the driver panicked while kernels were compiled"),
            }
        }
        if self.announced || matches!(self.active, ActiveBackend::Opening | ActiveBackend::Lost) {
            return None;
        }
        self.announced = true;
        Some(self.active.clone())
    }

    /// Number of threads of the CPU stages.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, ThreadPool::current_num_threads)
    }

    /// The backend.
    pub fn active(&self) -> &ActiveBackend {
        &self.active
    }

    /// Whether there is a backend to run a step on.
    pub fn runs(&self) -> bool {
        matches!(self.active, ActiveBackend::Cpu { .. } | ActiveBackend::Gpu { .. })
    }

    /// Whether this value of `on_cpu` moves the simulation from the GPU to the CPU or back.
    #[cfg(feature = "gpu")]
    pub fn changes_place(&self, on_cpu: bool) -> bool {
        self.on_cpu != on_cpu && matches!(self.active, ActiveBackend::Gpu { .. })
    }

    /// Sets whether steps run on the CPU from now on although there may be a device.
    pub fn keep_on_cpu(&mut self, on_cpu: bool) {
        if on_cpu && matches!(self.active, ActiveBackend::Gpu { .. }) {
            info_once!(
                "steps run on the CPU because there are colliders or planes with ActiveCollisionHooks, which the GPU does \
                 not have"
            );
        }
        self.on_cpu = on_cpu;
    }

    /// Runs a stage. A device runs all stages in the call for the first one.
    ///
    /// If the device fails, no body has moved. The same step runs again on a new device or on the CPU. It does not run
    /// if the renderer's new device is still to come.
    pub fn run(&mut self, stage: Stage, state: &mut StepState, hooks: &mut dyn StepHooks) {
        if stage == Stage::BroadPhase {
            self.parallel_stages = 0;
        }
        #[cfg(feature = "gpu")]
        while let Some(gpu) = self.gpu.as_mut().filter(|_| !self.on_cpu) {
            if stage != Stage::BroadPhase {
                return;
            }
            state.scratch.age(&mut state.results);
            match within(self.pool.as_ref(), self.has_fast_bodies, || gpu.run(state)) {
                Ok(()) => return self.retries.count_step(),
                Err(error) => self.replace(&error),
            }
        }
        if self.runs() {
            self.parallel_stages += u32::from(crate::step::cpu::run_on(self.pool.as_ref(), stage, state, hooks));
        }
    }

    /// Number of steps with pending results, and how many times a step has waited for results.
    pub fn flights(&self) -> (usize, u64) {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            return (gpu.in_flight(), gpu.waits());
        }
        (0, 0)
    }

    /// Number of stages of the last step that used the thread pool.
    pub fn parallel_stages(&self) -> u32 {
        self.parallel_stages
    }

    /// Whether there was a failure since the last call of [`Engine::take_failure`].
    pub fn has_failed(&self) -> bool {
        self.failure.is_some()
    }

    /// The failure since the last call, if there was one.
    pub fn take_failure(&mut self) -> Option<String> {
        self.failure.take()
    }

    /// Whether results come later than in the step that finds them.
    pub fn is_latent(&self) -> bool {
        #[cfg(feature = "gpu")]
        let is_latent = self.latent().is_some();
        #[cfg(not(feature = "gpu"))]
        let is_latent = false;
        is_latent
    }
}

#[cfg(feature = "gpu")]
impl Engine {
    /// Whether steps run on a device.
    pub fn is_on_gpu(&self) -> bool {
        self.gpu.is_some() && !self.on_cpu
    }

    /// The stages on a device, if there is one.
    pub fn gpu_step(&mut self) -> Option<&mut GpuStep> {
        self.gpu.as_deref_mut()
    }

    /// The stages on a device, if there is one.
    pub fn gpu(&self) -> Option<&GpuStep> {
        self.gpu.as_deref()
    }

    /// The device, if there is one.
    pub fn device(&self) -> Option<&Gpu> {
        self.gpu.as_ref().map(|step| step.gpu())
    }

    /// Uses the new device of Bevy's renderer. Returns whether the backend changes; then no state of earlier steps is
    /// carried over. If the stages have fallen back to the CPU, they stay there.
    #[cfg(feature = "bevy_render")]
    pub fn share(&mut self, gpu: Gpu) -> bool {
        if self.backend == Backend::Cpu || matches!(self.source, Source::Given(_)) {
            return false;
        }
        let before = std::mem::replace(&mut self.source, Source::Renderer(Box::new(gpu)));
        if matches!(before, Source::Renderer(_)) && matches!(self.active, ActiveBackend::Cpu { .. }) {
            return false;
        }
        if let (Some(step), Source::Renderer(_)) = (self.gpu.take(), before) {
            let name = &step.gpu().info.name;
            self.retries.take();
            self.failure = Some(format!(
                "Bevy's renderer opened {name} again, and the stages continue there"
            ));
        }
        self.opening = None;
        self.start();
        true
    }

    /// When results are published, with [`Readback::Auto`] resolved.
    fn readback(&self) -> Readback {
        match (self.readback, &self.source) {
            (Readback::Auto, Source::Renderer(_)) => Readback::Latent,
            (Readback::Auto, _) => Readback::Lockstep,
            (readback, _) => readback,
        }
    }

    /// What is read back of a step, if its results come later.
    pub fn latent(&self) -> Option<Detail> {
        match (self.is_on_gpu(), self.readback()) {
            (true, Readback::Latent) => Some(Detail::All),
            (true, Readback::Resident) => Some(Detail::Counts),
            _ => None,
        }
    }

    /// Submits a step, and waits for the results of the step `latency` steps before, if there is one.
    ///
    /// `None` if the device failed. Then run the step again, according to [`Engine::latent`], with nothing carried
    /// over.
    pub fn advance(
        &mut self,
        state: &StepInput,
        carried: &[Option<Carried>],
        detail: Detail,
        latency: usize,
    ) -> Option<Option<Output>> {
        self.parallel_stages = 0;
        let gpu = self.gpu.as_mut()?;
        let submitted = within(self.pool.as_ref(), self.has_fast_bodies, || {
            gpu.submit(state, carried, detail)
        });
        let result = submitted.and_then(|()| {
            if gpu.in_flight() > latency {
                gpu.take().transpose()
            } else {
                Ok(None)
            }
        });
        match result {
            Ok(output) => {
                self.retries.count_step();
                Some(output)
            }
            Err(error) => {
                self.replace(&error);
                None
            }
        }
    }

    /// Waits for the results of the oldest pending step. `None` if there is none, or if the device failed: then no
    /// pending results will come.
    pub fn land(&mut self) -> Option<Output> {
        match self.gpu.as_mut()?.take()? {
            Ok(output) => Some(output),
            Err(error) => {
                self.replace(&error);
                None
            }
        }
    }

    /// Drops a device that failed. Reopens it if that may help, else falls back to the CPU.
    pub fn replace(&mut self, error: &StepError) {
        let Some(failed) = self.gpu.take() else { return };
        let name = failed.gpu().info.name.clone();
        drop(failed);
        let may_be_cured = matches!(error, StepError::Device(DeviceError::Failed(_)));
        if may_be_cured && self.retries.take() {
            self.source.give_up_lost();
            if self.source.is_lost() {
                return self.wait_for_renderer(&error.to_string());
            }
            if let Ok(gpu) = self
                .source
                .open(self.backend == Backend::Gpu, false, &self.kernel_cache)
            {
                self.opened(Ok(gpu));
                self.failure = Some(format!("{name} failed and was opened again: {error}"));
                return;
            }
        }
        let reason = format!("{name} failed, and the stages continue on the CPU: {error}");
        self.active = ActiveBackend::Cpu {
            threads: self.threads(),
            reason: reason.clone(),
        };
        self.failure = Some(reason);
    }
}

/// Runs `work` on the threads of the pool, or on this one if it is not `shared` out.
#[cfg(feature = "gpu")]
fn within<R: Send>(pool: Option<&ThreadPool>, shared: bool, work: impl FnOnce() -> R + Send) -> R {
    match pool.filter(|_| shared) {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
