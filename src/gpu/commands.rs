//! Commands of a step: kernels, copies and uploads, counted where they are recorded.

use super::buffer_contents::BufferContents;
use super::device::Gpu;
use super::kernel_timer::KernelTimer;
use super::readback::{DeviceError, map, scoped, staging};
use crate::types::gpu_work::GpuWork;
use std::ops::Range;
use wgpu::{
    Buffer, CommandEncoder, CommandEncoderDescriptor, ComputePass, ComputePassDescriptor, ComputePassTimestampWrites,
    SubmissionIndex,
};

/// Commands that are submitted together.
pub struct Commands<'g> {
    gpu: &'g Gpu,
    /// For commands that are not counted.
    pub encoder: CommandEncoder,
    work: GpuWork,
}

impl<'g> Commands<'g> {
    /// No commands yet.
    pub fn new(gpu: &'g Gpu, label: &'static str) -> Self {
        if let Some(timer) = &gpu.kernel_timer {
            timer.begin();
        }
        Self {
            gpu,
            encoder: encoder(gpu, label),
            work: GpuWork::default(),
        }
    }

    /// Writes bytes from the start of a buffer, before all other commands.
    pub fn write(&mut self, buffer: &Buffer, bytes: &[u8]) {
        self.write_at(buffer, 0, bytes);
    }

    /// Writes only what has changed since the last time to a buffer that no kernel writes.
    pub fn write_changes(&mut self, contents: &mut BufferContents, buffer: &Buffer, bytes: &[u8]) {
        for range in contents.change(buffer, bytes) {
            let changed = &bytes[range.clone()];
            self.write_at(buffer, range.start as u64, changed);
        }
    }

    /// Sets a buffer to zero.
    pub fn clear(&mut self, buffer: &Buffer) {
        self.encoder.clear_buffer(buffer, 0, None);
        self.work.copies += 1;
    }

    /// Copies a buffer, or as much of it as fits.
    pub fn copy(&mut self, from: &Buffer, to: &Buffer) {
        self.encoder
            .copy_buffer_to_buffer(from, 0, to, 0, from.size().min(to.size()));
        self.work.copies += 1;
    }

    /// Copies the first bytes of a buffer.
    pub fn copy_start(&mut self, from: &Buffer, to: &Buffer, bytes: u64) {
        if bytes > 0 {
            self.encoder.copy_buffer_to_buffer(from, 0, to, 0, bytes);
            self.work.copies += 1;
        }
    }

    /// Writes bytes into a buffer from this place on, before the commands that are still to be submitted.
    pub fn write_at(&mut self, buffer: &Buffer, at: u64, bytes: &[u8]) {
        self.gpu.queue.write_buffer(buffer, at, bytes);
        self.work.uploaded_bytes += bytes.len() as u64;
    }

    /// Number of bytes written so far.
    pub fn uploaded_bytes(&self) -> u64 {
        self.work.uploaded_bytes
    }

    /// Submits what is recorded so far, waits for it, and returns these ranges of buffers, one after the other.
    /// Commands can be recorded from then on as before.
    ///
    /// # Errors
    /// If the device is lost or refuses a call.
    pub fn fetch(&mut self, ranges: &[(&Buffer, Range<u64>)]) -> Result<Vec<u8>, DeviceError> {
        let total: u64 = ranges.iter().map(|(_, range)| range.end - range.start).sum();
        let staging = scoped(self.gpu, || {
            let staging = staging(self.gpu, total);
            let mut at = 0;
            for (buffer, range) in ranges.iter().filter(|(_, range)| !range.is_empty()) {
                let bytes = range.end - range.start;
                self.encoder
                    .copy_buffer_to_buffer(buffer, range.start, &staging, at, bytes);
                at += bytes;
                self.work.copies += 1;
            }
            let recorded = std::mem::replace(&mut self.encoder, encoder(self.gpu, "faceoff step, continued"));
            self.gpu.queue.submit([recorded.finish()]);
            staging
        })?;
        self.work.submissions += 1;
        self.work.read_back_bytes += total;
        map(self.gpu, &staging, total, <[u8]>::to_vec)
    }

    /// Copies the start of a buffer to this range of another one, which the CPU will read.
    pub fn read_back(&mut self, from: &Buffer, to: &Buffer, range: &Range<u64>) {
        let bytes = range.end - range.start;
        self.encoder.copy_buffer_to_buffer(from, 0, to, range.start, bytes);
        self.work.copies += 1;
        self.work.read_back_bytes += bytes;
    }

    /// Begins a compute pass.
    pub fn pass(&mut self, label: &'static str, timestamps: Option<ComputePassTimestampWrites>) -> Pass<'_> {
        self.work.passes += 1;
        Pass {
            pass: self.encoder.begin_compute_pass(&ComputePassDescriptor {
                label: Some(label),
                timestamp_writes: timestamps,
            }),
            work: &mut self.work,
            validates_indirect: self.gpu.validates_indirect,
            timer: self.gpu.kernel_timer.as_deref(),
        }
    }

    /// Submits them.
    pub fn submit(mut self) -> (SubmissionIndex, GpuWork) {
        if let Some(timer) = &self.gpu.kernel_timer {
            timer.resolve(&mut self.encoder);
        }
        let submission = self.gpu.queue.submit([self.encoder.finish()]);
        self.work.submissions += 1;
        (submission, self.work)
    }
}

fn encoder(gpu: &Gpu, label: &'static str) -> CommandEncoder {
    gpu.device
        .create_command_encoder(&CommandEncoderDescriptor { label: Some(label) })
}

/// A compute pass.
pub struct Pass<'c> {
    /// For commands that are not counted.
    pub pass: ComputePass<'c>,
    work: &'c mut GpuWork,
    validates_indirect: bool,
    timer: Option<&'c KernelTimer>,
}

impl Pass<'_> {
    /// If kernels are timed, a time stamp before this one, or at the end of the pass.
    pub fn time(&mut self, kernel: Option<&'static str>) {
        if let Some(timer) = self.timer {
            timer.stamp(&mut self.pass, kernel);
        }
    }

    /// Calls the current kernel in this many workgroups along each axis.
    pub fn dispatch(&mut self, [x, y, z]: [u32; 3]) {
        self.pass.dispatch_workgroups(x, y, z);
        self.work.dispatches += 1;
    }

    /// Calls the current kernel in as many workgroups as three words of a buffer say, from `first_word` on.
    pub fn dispatch_indirect(&mut self, arguments: &Buffer, first_word: u32) {
        self.pass
            .dispatch_workgroups_indirect(arguments, 4 * u64::from(first_word));
        self.work.dispatches += 1;
        self.work.indirect += 1;
        self.work.validations += u32::from(self.validates_indirect);
    }
}
