//! Runs a few kernels once and reads back: how the primitives are tried on their own.

use super::device::Gpu;
use super::kernel::{Builder, Kernel, Kernels};
use super::readback::{read_words, scoped};
use crate::types::stage::Stage;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages};

/// A device with some kernels.
pub struct RunOnce<'g> {
    gpu: &'g Gpu,
    kernels: Kernels,
}

impl<'g> RunOnce<'g> {
    /// Compiles.
    ///
    /// # Errors
    /// The compiler's message.
    pub fn new<'k>(gpu: &'g Gpu, kernels: impl IntoIterator<Item = &'k &'k Kernel>) -> Result<Self, String> {
        Ok(Self {
            gpu,
            kernels: scoped(gpu, || Kernels::new(gpu, kernels.into_iter().copied()))??,
        })
    }

    /// An array with contents, at least one word long.
    pub fn buffer(&self, words: &[u32]) -> Buffer {
        let words = if words.is_empty() { &[0] } else { words };
        self.gpu.device.create_buffer_init(&BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(words),
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        })
    }

    /// Runs calls.
    ///
    /// # Errors
    /// What the device says.
    pub fn program(&self, add: impl FnOnce(&mut Builder)) -> Result<(), String> {
        scoped(self.gpu, || {
            let mut builder = Builder::new(self.gpu, &self.kernels);
            add(&mut builder);
            let program = builder.finish();
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            let arguments = self.buffer(&[]);
            program.record(Stage::BroadPhase, &mut encoder, 0, &arguments, None);
            self.gpu.queue.submit([encoder.finish()]);
        })
    }

    /// Reads the first words of an array.
    ///
    /// # Errors
    /// What the device says.
    pub fn read(&self, buffer: &Buffer, words: usize) -> Result<Vec<u32>, String> {
        read_words(self.gpu, buffer, words)
    }
}
