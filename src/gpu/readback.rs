//! Readback: reading of buffers, and handling of lost devices.

use super::device::Gpu;
use bytemuck::Pod;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, channel};
use thiserror::Error;
use wgpu::{Buffer, BufferAsyncError, BufferDescriptor, BufferUsages, BufferView, ErrorFilter, MapMode, PollType};

/// Why a device did not do its work.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum DeviceError {
    /// The device has no memory left. A new device would have none either.
    #[error("out of memory: {0}")]
    OutOfMemory(String),
    /// The device is lost, or refuses a call.
    #[error("{0}")]
    Failed(String),
}

impl DeviceError {
    /// A loss or a refusal, with its reason.
    pub fn failed(reason: impl ToString) -> Self {
        Self::Failed(reason.to_string())
    }
}

impl From<wgpu::Error> for DeviceError {
    fn from(error: wgpu::Error) -> Self {
        let wgpu::Error::OutOfMemory { source } = &error else {
            return Self::Failed(error.to_string());
        };
        // wgpu's own text does not say which call found no memory.
        let mut reason = source.to_string();
        let mut cause = source.source();
        while let Some(deeper) = cause {
            reason += &format!(": {deeper}");
            cause = deeper.source();
        }
        Self::OutOfMemory(reason)
    }
}

/// Runs `work` in error scopes. Errors outside of a scope would make Bevy end the app.
///
/// # Errors
/// The error, if there is one; that the device is lost, if wgpu panics. Of several errors, an out-of-memory error comes
/// first: what could not be allocated is invalid in every later call.
pub fn scoped<T>(gpu: &Gpu, work: impl FnOnce() -> T) -> Result<T, DeviceError> {
    let filters = [ErrorFilter::OutOfMemory, ErrorFilter::Internal, ErrorFilter::Validation];
    let scopes = filters.map(|filter| gpu.device.push_error_scope(filter));
    let result = catch_lost(work);
    let mut worst = None;
    // Scopes are popped in reverse order.
    for scope in scopes.into_iter().rev() {
        worst = pollster::block_on(scope.pop()).or(worst);
    }
    worst.map_or(result, |error| Err(error.into()))
}

/// Waits until all work is done.
///
/// # Errors
/// If the device is lost.
pub fn wait(gpu: &Gpu) -> Result<(), DeviceError> {
    poll(gpu, PollType::wait_indefinitely())
}

/// Polls the device, or waits for it.
///
/// # Errors
/// If the device is lost.
pub fn poll(gpu: &Gpu, what: PollType) -> Result<(), DeviceError> {
    let polled = catch_lost(|| gpu.device.poll(what))?;
    polled.map(|_| ()).map_err(DeviceError::failed)
}

/// Checks that the device works. A lost device may report that a buffer is mapped, and reading it would panic.
///
/// # Errors
/// If the device is lost.
pub fn alive(gpu: &Gpu) -> Result<(), DeviceError> {
    scoped(gpu, || {
        // wgpu does not report errors of lost devices, but it refuses at once to map their buffers.
        match request(&staging(gpu, 4), 4).try_recv() {
            Ok(Err(_)) => Err(DeviceError::failed("it is lost")),
            _ => Ok(()),
        }
    })?
}

/// Requests that the first `bytes` of a staging buffer are mapped. The receiver is notified when they are.
pub fn request(staging: &Buffer, bytes: u64) -> Receiver<Result<(), BufferAsyncError>> {
    let (sender, receiver) = channel();
    staging.map_async(MapMode::Read, ..bytes, move |result| {
        // The receiver is gone if the step was given up, or if waiting failed, which is reported there.
        let _ = sender.send(result);
    });
    receiver
}

/// The mapped contents.
///
/// # Errors
/// If the device is lost.
pub fn view(gpu: &Gpu, staging: &Buffer, bytes: u64) -> Result<BufferView, DeviceError> {
    alive(gpu)?;
    catch_lost(|| staging.slice(..bytes).get_mapped_range())
}

/// Runs a call that makes wgpu panic if the device is lost. wgpu holds no lock then. A shared device may be lost at any
/// time.
///
/// # Errors
/// If it panicked, with the message of the panic.
pub fn catch_lost<T>(call: impl FnOnce() -> T) -> Result<T, DeviceError> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|panic| {
        let text = panic.downcast_ref::<&str>().copied();
        let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        match text {
            Some(text) => DeviceError::failed(format!("it is lost: {}", text.trim())),
            None => DeviceError::failed("it is lost"),
        }
    })
}

/// A staging buffer.
pub fn staging(gpu: &Gpu, bytes: u64) -> Buffer {
    gpu.device.create_buffer(&BufferDescriptor {
        label: Some("readback"),
        size: bytes.max(4),
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Waits for the first `bytes` of a staging buffer, calls `look` with them, and unmaps the buffer.
///
/// # Errors
/// If the device is lost.
pub fn map<T>(gpu: &Gpu, staging: &Buffer, bytes: u64, look: impl FnOnce(&[u8]) -> T) -> Result<T, DeviceError> {
    let receiver = scoped(gpu, || request(staging, bytes.max(4)))?;
    wait(gpu)?;
    let mapped = receiver.recv().map_err(DeviceError::failed)?;
    mapped.map_err(DeviceError::failed)?;
    let result = look(&view(gpu, staging, bytes.max(4))?[..bytes as usize]);
    scoped(gpu, || staging.unmap())?;
    Ok(result)
}

/// Copies these elements of a list.
///
/// # Errors
/// The device's message.
pub fn read_rows<T: Pod>(gpu: &Gpu, list: &Buffer, rows: Range<u64>) -> Result<Vec<T>, DeviceError> {
    let size = size_of::<T>() as u64;
    let bytes = size * (rows.end - rows.start);
    scoped(gpu, || {
        let staging = staging(gpu, bytes);
        if bytes > 0 {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(list, size * rows.start, &staging, 0, bytes);
            gpu.queue.submit([encoder.finish()]);
        }
        map(gpu, &staging, bytes, bytemuck::pod_collect_to_vec)
    })?
}

/// Copies the first words of a buffer.
///
/// # Errors
/// The device's message.
pub fn read_words(gpu: &Gpu, buffer: &Buffer, words: usize) -> Result<Vec<u32>, DeviceError> {
    read_rows(gpu, buffer, 0..words as u64)
}
