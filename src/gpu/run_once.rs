//! Runs a few kernels once and reads back: how the primitives are tried on their own.

use super::SHADERS;
use super::device::Gpu;
use super::kernel::{Kernel, Kernels};
use super::program::{BufferSet, Calls, Program};
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
    /// Compiles kernels that import nothing of a stage.
    ///
    /// # Errors
    /// The compiler's message.
    pub fn new<'k>(gpu: &'g Gpu, kernels: impl IntoIterator<Item = &'k Kernel>) -> Result<Self, String> {
        Ok(Self {
            gpu,
            kernels: scoped(gpu, || Kernels::new(gpu, SHADERS.modules, kernels))??,
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

    /// Runs calls on these buffers.
    ///
    /// # Errors
    /// What the device says.
    pub fn program(&self, buffers: &dyn BufferSet, add: impl FnOnce(&mut Calls)) -> Result<(), String> {
        const STAGE: Stage = Stage::BroadPhase;
        scoped(self.gpu, || {
            let mut calls = Calls::new(STAGE);
            add(&mut calls);
            let program = Program::new(self.gpu, &self.kernels, &calls, &[buffers]);
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            program.record(STAGE, &mut encoder, 0, None);
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
