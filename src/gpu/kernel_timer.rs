//! The time of each kernel on the device, for benches.

use super::device::{Gpu, NoGpu};
use super::readback::{DeviceError, read_words};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePass, Features, QUERY_SIZE, QuerySet,
    QuerySetDescriptor, QueryType,
};

/// Most time stamps of a submission. Kernels after that are not timed.
const MOST: u32 = wgpu::QUERY_SET_MAX_QUERIES;

/// A time stamp before each kernel and at the end of each pass. Kernels that would run side by side then run one after
/// the other on some devices, so that the sum may exceed the time of a step.
#[derive(Debug)]
pub struct KernelTimer {
    queries: QuerySet,
    resolved: Buffer,
    /// Nanoseconds per tick.
    period: f64,
    /// What runs after each time stamp of the last submission. Nothing runs after the last one of a pass.
    kernels: Mutex<Vec<Option<&'static str>>>,
}

impl Gpu {
    /// This device, which times each kernel from now on; see [`Gpu::kernel_times`].
    ///
    /// # Errors
    /// If the device has no time stamps within passes.
    pub fn with_kernel_times(self) -> Result<Self, NoGpu> {
        if !self.device.features().contains(Features::TIMESTAMP_QUERY_INSIDE_PASSES) {
            return Err(NoGpu::Failed {
                adapter: self.info.name.clone(),
                reason: "it has no time stamps within passes".into(),
            });
        }
        let timer = KernelTimer {
            queries: self.device.create_query_set(&QuerySetDescriptor {
                label: Some("kernel times"),
                ty: QueryType::Timestamp,
                count: MOST,
            }),
            resolved: self.device.create_buffer(&BufferDescriptor {
                label: Some("kernel times"),
                size: u64::from(MOST * QUERY_SIZE),
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            period: f64::from(self.queue.get_timestamp_period()),
            kernels: Mutex::default(),
        };
        Ok(Self {
            kernel_timer: Some(Arc::new(timer)),
            ..self
        })
    }

    /// The kernels of the last submission in order, each with its time. Empty without [`Gpu::with_kernel_times`].
    ///
    /// # Errors
    /// If the device is lost.
    pub fn kernel_times(&self) -> Result<Vec<(&'static str, Duration)>, DeviceError> {
        let Some(timer) = &self.kernel_timer else {
            return Ok(Vec::new());
        };
        let kernels = timer.kernels();
        let words = read_words(self, &timer.resolved, 2 * kernels.len())?;
        let stamps: Vec<u64> = bytemuck::pod_collect_to_vec(&words);
        let time = |pair: &[u64]| {
            let ticks = pair[1].saturating_sub(pair[0]);
            Duration::from_nanos((ticks as f64 * timer.period) as u64)
        };
        let named = kernels.iter().zip(stamps.windows(2));
        Ok(named
            .filter_map(|(kernel, pair)| kernel.map(|kernel| (kernel, time(pair))))
            .collect())
    }
}

impl KernelTimer {
    fn kernels(&self) -> std::sync::MutexGuard<'_, Vec<Option<&'static str>>> {
        self.kernels.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Forgets the last submission.
    pub(super) fn begin(&self) {
        self.kernels().clear();
    }

    /// Writes a time stamp before a kernel, or at the end of a pass.
    pub(super) fn stamp(&self, pass: &mut ComputePass, kernel: Option<&'static str>) {
        let mut kernels = self.kernels();
        if kernels.len() < MOST as usize {
            pass.write_timestamp(&self.queries, kernels.len() as u32);
            kernels.push(kernel);
        }
    }

    /// Resolves the time stamps. Record it after all passes.
    pub(super) fn resolve(&self, encoder: &mut CommandEncoder) {
        let stamps = self.kernels().len() as u32;
        if stamps > 0 {
            encoder.resolve_query_set(&self.queries, 0..stamps, &self.resolved, 0);
        }
    }
}
