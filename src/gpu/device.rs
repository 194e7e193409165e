//! The GPU device that the stages run on, and why there may be none.

use super::kernel::Kernels;
use super::kernel_timer::KernelTimer;
use super::pipeline_cache::StoredKernels;
use super::readback::{alive, wait};
use crate::types::kernel_cache::KernelCache;
use std::sync::Arc;
use thiserror::Error;
use wgpu::{Adapter, AdapterInfo, Backends, Device, DeviceType, Features, InstanceFlags, Limits, Queue};

/// A device of our own, or the device of Bevy's renderer. Clones refer to the same device.
///
/// Put every call into an error scope, and do not set the device's callbacks: on a shared device these belong to the
/// renderer, and an error that reaches them ends the app.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Creates buffers and pipelines.
    pub device: Device,
    /// Receives the work.
    pub queue: Queue,
    /// Name, type and backend of the adapter.
    pub info: AdapterInfo,
    /// Whether wgpu checks the arguments of indirect dispatches on the device, with a dispatch before each.
    pub(super) validates_indirect: bool,
    /// Each kernel is compiled once, when it is first needed.
    pub(super) kernels: Kernels,
    /// The compiled kernels on disk.
    pub(super) stored: Option<StoredKernels>,
    /// For benches.
    pub(super) kernel_timer: Option<Arc<KernelTimer>>,
}

impl Gpu {
    /// A device without kernels. `flags` are those of its instance.
    pub fn new(device: Device, queue: Queue, info: AdapterInfo, flags: InstanceFlags) -> Self {
        Self {
            device,
            queue,
            info,
            validates_indirect: flags.contains(InstanceFlags::VALIDATION_INDIRECT_CALL),
            kernels: Kernels::default(),
            stored: None,
            kernel_timer: None,
        }
    }

    /// The compiled kernels on disk, if the device keeps them.
    pub fn stored_kernels(&self) -> Option<&StoredKernels> {
        self.stored.as_ref()
    }
}

/// Why the stages cannot run on a GPU.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoGpu {
    /// No driver, no loader, or no GPU.
    #[error("no GPU adapter is found: install a Vulkan, Metal or DirectX 12 driver, or use Backend::Cpu")]
    NoAdapter,
    /// The machine has no GPU, so adapters are not enumerated.
    #[error(
        "there is no GPU: nothing in /dev through which a driver would reach one. Backend::Gpu looks for adapters all the same"
    )]
    NoCard,
    /// The program runs in a browser, where a step cannot wait for a GPU.
    #[error("a step cannot wait for a GPU in a browser: use Backend::Auto or Backend::Cpu")]
    Web,
    /// The adapter computes on the CPU. [`Backend::Auto`](crate::plugin::settings::Backend) does not use it.
    #[error("the adapter {0} computes on the CPU: Backend::Gpu uses it, Backend::Auto does not")]
    OnlySoftware(String),
    /// Bevy's renderer uses OpenGL, which the stages do not support.
    #[error("Bevy's renderer drives {0} through OpenGL, which the stages do not use")]
    OpenGl(String),
    /// The driver refused to open a device.
    #[error("{adapter} gives no device: {reason}")]
    Device {
        /// Name of the adapter.
        adapter: String,
        /// The driver's message.
        reason: String,
    },
    /// A limit of the device is too low.
    #[error("{adapter} allows {limit} of {has} only, and the stages need {needs}")]
    Limit {
        /// Name of the adapter.
        adapter: String,
        /// The limit's name in wgpu.
        limit: &'static str,
        /// The device's value.
        has: u64,
        /// The value that the stages need.
        needs: u64,
    },
    /// A kernel did not compile, or a first step failed.
    #[error("{adapter} cannot run the stages: {reason}")]
    Failed {
        /// Name of the adapter.
        adapter: String,
        /// The error message.
        reason: String,
    },
}

/// Opens the best adapter: discrete before integrated before virtual. If it cannot run the stages or gives no device,
/// the next one is tried. Adapters that compute on the CPU are used only if `software` is true. Compiled kernels are
/// kept where `kernels` says.
///
/// # Errors
/// If no adapter can run the stages: why the best one cannot.
pub fn open(software: bool, kernels: &KernelCache) -> Result<Gpu, NoGpu> {
    if !software && !may_have_card() {
        return Err(NoGpu::NoCard);
    }
    // Reads WGPU_BACKEND, WGPU_VALIDATION and the like from the environment.
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.flags = own_flags(descriptor.flags, std::env::var_os(VALIDATION_VARIABLE).is_some());
    let flags = descriptor.flags;
    let adapters = pollster::block_on(async {
        let instance = wgpu::Instance::new(descriptor);
        let mut adapters = instance.enumerate_adapters(Backends::all()).await;
        adapters.retain(|adapter| adapter.get_info().backend != wgpu::Backend::Gl);
        adapters.sort_by_key(|adapter| rank(adapter.get_info().device_type));
        adapters
    });
    first_that_opens(&adapters, |adapter| {
        suits(&adapter.get_info(), &adapter.limits(), software)?;
        let mut gpu = pollster::block_on(request(adapter, flags))?;
        gpu.stored = StoredKernels::open(&gpu, kernels);
        Ok(gpu)
    })
}

/// The environment variable that switches wgpu's check of indirect dispatches on or off.
const VALIDATION_VARIABLE: &str = "WGPU_VALIDATION_INDIRECT_CALL";

/// The flags of an instance of our own. The check of indirect dispatches costs a dispatch each, and is off unless it is
/// asked for. Nothing depends on it: the device computes the arguments by `rows` of `shaders/shared/dispatch.wgsl`,
/// which stays within the limit, and kernels do not use `num_workgroups`, which is 0 on DirectX 12 without the check.
fn own_flags(flags: InstanceFlags, is_asked_for: bool) -> InstanceFlags {
    if is_asked_for {
        flags
    } else {
        flags - InstanceFlags::VALIDATION_INDIRECT_CALL
    }
}

/// The first device that is opened, or the first error.
fn first_that_opens<A, D>(adapters: &[A], mut open: impl FnMut(&A) -> Result<D, NoGpu>) -> Result<D, NoGpu> {
    let mut first = None;
    for adapter in adapters {
        match open(adapter) {
            Ok(device) => {
                if let Some(error) = first {
                    tracing::warn!("{error}; the next adapter is used");
                }
                return Ok(device);
            }
            Err(error) => first = first.or(Some(error)),
        }
    }
    Err(first.unwrap_or(NoGpu::NoAdapter))
}

/// Whether there may be a GPU. Without one, creating an instance would load software drivers only for us to
/// refuse them, which takes a while. A layer of Mesa's, which looks for a Wayland display, would also print an error if
/// `XDG_RUNTIME_DIR` is missing, as on servers and in containers.
fn may_have_card() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    // The device files of drivers: most of them; NVIDIA's; WSL's; those of Adreno, Mali and PowerVR.
    const DEVICES: [&str; 6] = ["dri", "nvidia", "dxg", "kgsl", "mali", "pvr"];
    let Ok(files) = std::fs::read_dir("/dev") else {
        return true;
    };
    let is_card = |name: &str| DEVICES.iter().any(|device| name.starts_with(device));
    files.flatten().any(|file| is_card(&file.file_name().to_string_lossy()))
}

/// Whether the stages can run on an adapter. One that computes on the CPU is accepted only if `software` is true.
///
/// # Errors
/// The reason why not.
pub fn suits(info: &AdapterInfo, limits: &Limits, software: bool) -> Result<(), NoGpu> {
    let name = &info.name;
    if info.device_type == DeviceType::Cpu && !software {
        Err(NoGpu::OnlySoftware(name.clone()))
    } else if info.backend == wgpu::Backend::Gl {
        Err(NoGpu::OpenGl(name.clone()))
    } else {
        check(name, limits)
    }
}

/// Whether the device is lost. Waits until it is idle, because the loss of a destroyed device is reported only then.
pub fn is_lost(gpu: &Gpu) -> bool {
    wait(gpu).and_then(|()| alive(gpu)).is_err()
}

async fn request(adapter: &Adapter, flags: InstanceFlags) -> Result<Gpu, NoGpu> {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let (device, queue) = adapter
        .request_device(&wgpu::DeviceDescriptor {
            label: Some("faceoff"),
            required_features: adapter.features()
                & (Features::TIMESTAMP_QUERY | Features::TIMESTAMP_QUERY_INSIDE_PASSES | Features::PIPELINE_CACHE),
            // The limits of the adapter instead of the defaults, for longer lists.
            required_limits: limits,
            ..Default::default()
        })
        .await
        .map_err(|error| NoGpu::Device {
            adapter: info.name.clone(),
            reason: error.to_string(),
        })?;
    Ok(Gpu::new(device, queue, info, flags))
}

/// Whether a device with these limits can run all kernels.
pub fn check(adapter: &str, limits: &Limits) -> Result<(), NoGpu> {
    let needs = [
        (
            "max_storage_buffers_per_shader_stage",
            u64::from(limits.max_storage_buffers_per_shader_stage),
            8,
        ),
        (
            "max_compute_invocations_per_workgroup",
            limits.max_compute_invocations_per_workgroup.into(),
            256,
        ),
        (
            "max_compute_workgroup_storage_size",
            limits.max_compute_workgroup_storage_size.into(),
            16 << 10,
        ),
        (
            "max_compute_workgroups_per_dimension",
            limits.max_compute_workgroups_per_dimension.into(),
            65_535,
        ),
        (
            "max_storage_buffer_binding_size",
            limits.max_storage_buffer_binding_size,
            128 << 20,
        ),
    ];
    match needs.into_iter().find(|&(_, has, needs)| has < needs) {
        Some((limit, has, needs)) => Err(NoGpu::Limit {
            adapter: adapter.to_string(),
            limit,
            has,
            needs,
        }),
        None => Ok(()),
    }
}

fn rank(kind: DeviceType) -> u32 {
    match kind {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_adapter_is_tried_and_the_first_error_told() {
        let error = |name: &str| NoGpu::OpenGl(name.into());
        let open = |name: &&str| {
            if name.starts_with("good") {
                Ok(name.to_string())
            } else {
                Err(error(name))
            }
        };
        assert_eq!(first_that_opens(&["bad", "good", "good too"], open), Ok("good".into()));
        assert_eq!(first_that_opens(&["bad", "worse"], open), Err(error("bad")));
        assert_eq!(first_that_opens(&[], open), Err(NoGpu::NoAdapter));
    }
}
