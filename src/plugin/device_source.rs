//! Where the device of the stages comes from, and how often a lost one is replaced.

use crate::gpu::device::{self, Gpu, NoGpu};
use crate::gpu::readback::catch_lost;
use crate::step::gpu::GpuStep;
use crate::types::kernel_cache::KernelCache;

/// The owner of the device.
#[derive(Clone)]
pub(crate) enum Source {
    /// Unknown until the renderer's plugins are finished.
    Unknown,
    /// The plugin opens its own device.
    Own,
    /// The program gave this device. If it is lost, the plugin opens its own.
    Given(Box<Gpu>),
    /// Bevy's renderer owns this device.
    #[cfg_attr(not(feature = "bevy_render"), expect(dead_code, reason = "there is none"))]
    Renderer(Box<Gpu>),
}

impl Source {
    /// Opens the source's device if it is suitable, and compiles the kernels. Those of contacts are compiled now with
    /// `contacts`, else when a step needs them. Those of our own device are kept where `kernels` says.
    pub fn open(&self, software: bool, contacts: bool, kernels: &KernelCache) -> Result<GpuStep, NoGpu> {
        let gpu = match self {
            Self::Renderer(gpu) | Self::Given(gpu) => {
                device::suits(&gpu.info, &gpu.device.limits(), software).map(|()| Gpu::clone(gpu))
            }
            Self::Own | Self::Unknown => device::open(software, kernels),
        };
        let gpu = gpu?;
        let adapter = gpu.info.name.clone();
        let make = || {
            let step = GpuStep::new(gpu)?;
            if contacts { step.with_contacts() } else { Ok(step) }
        };
        catch_lost(make).unwrap_or_else(|error| {
            let reason = error.to_string();
            Err(NoGpu::Failed { adapter, reason })
        })
    }

    /// Opens an own device from now on, if the program gave one that is lost.
    pub fn give_up_lost(&mut self) {
        if matches!(self, Self::Given(gpu) if device::is_lost(gpu)) {
            *self = Self::Own;
        }
    }

    /// Whether the device is the renderer's and is lost, so that Bevy must open another one.
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Renderer(gpu) if device::is_lost(gpu))
    }
}

/// How many times a lost device may be replaced. After a single loss, for example by a driver update, the reopened
/// device works. Losses that soon follow each other have another cause.
pub(crate) struct Retries {
    left: u32,
    /// Steps on the device since the last loss.
    steps: u32,
}

impl Retries {
    const MOST: u32 = 3;
    /// Steps, some ten seconds, after which a loss is independent of earlier ones.
    const STEADY_STEPS: u32 = 600;

    /// Counts a step on the device.
    pub fn count_step(&mut self) {
        self.steps = self.steps.saturating_add(1);
    }

    /// Counts a loss. Returns whether the device may be replaced.
    pub fn take(&mut self) -> bool {
        if std::mem::take(&mut self.steps) >= Self::STEADY_STEPS {
            self.left = Self::MOST;
        }
        let may = self.left > 0;
        self.left = self.left.saturating_sub(1);
        may
    }
}

impl Default for Retries {
    fn default() -> Self {
        Self {
            left: Self::MOST,
            steps: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Retries;

    #[test]
    fn losses_that_soon_follow_each_other_run_out_of_retries() {
        let mut retries = Retries::default();
        for _ in 0..Retries::MOST {
            assert!(retries.take());
            (1..Retries::STEADY_STEPS).for_each(|_| retries.count_step());
        }
        assert!(!retries.take());
    }

    #[test]
    fn a_device_that_was_steady_may_be_replaced_again() {
        let mut retries = Retries::default();
        for _ in 0..4 * Retries::MOST {
            assert!(retries.take());
            (0..Retries::STEADY_STEPS).for_each(|_| retries.count_step());
        }
    }
}
