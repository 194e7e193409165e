//! Readback: reading of buffers, and handling of lost devices.

use super::device::Gpu;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, channel};
use wgpu::{Buffer, BufferAsyncError, BufferDescriptor, BufferUsages, BufferView, ErrorFilter, MapMode, PollType};

/// Runs `work` in error scopes. Errors outside of a scope would make Bevy end the app.
///
/// # Errors
/// The first error, if there is one; that the device is lost, if wgpu panics.
pub fn scoped<T>(gpu: &Gpu, work: impl FnOnce() -> T) -> Result<T, String> {
    let filters = [ErrorFilter::Internal, ErrorFilter::OutOfMemory, ErrorFilter::Validation];
    let scopes = filters.map(|filter| gpu.device.push_error_scope(filter));
    let result = catch_lost(work);
    let mut first = None;
    // Scopes are popped in reverse order.
    for scope in scopes.into_iter().rev() {
        let error = pollster::block_on(scope.pop());
        first = first.or(error);
    }
    first.map_or(result, |error| Err(error.to_string()))
}

/// Waits until all work is done.
///
/// # Errors
/// If the device is lost.
pub fn wait(gpu: &Gpu) -> Result<(), String> {
    poll(gpu, PollType::wait_indefinitely())
}

/// Polls the device, or waits for it.
///
/// # Errors
/// If the device is lost.
pub fn poll(gpu: &Gpu, what: PollType) -> Result<(), String> {
    let polled = catch_lost(|| gpu.device.poll(what))?;
    polled.map(|_| ()).map_err(|error| error.to_string())
}

/// Checks that the device works. A lost device may report that a buffer is mapped, and reading it would panic.
///
/// # Errors
/// If the device is lost.
pub fn alive(gpu: &Gpu) -> Result<(), String> {
    scoped(gpu, || {
        // wgpu does not report errors of lost devices, but it refuses at once to map their buffers.
        match request(&staging(gpu, 4), 4).try_recv() {
            Ok(Err(_)) => Err("it is lost".to_string()),
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
pub fn view(gpu: &Gpu, staging: &Buffer, bytes: u64) -> Result<BufferView, String> {
    alive(gpu)?;
    catch_lost(|| staging.slice(..bytes).get_mapped_range())
}

/// Runs a call that makes wgpu panic if the device is lost. wgpu holds no lock then. A shared device may be lost at any
/// time.
///
/// # Errors
/// If it panicked, with the message of the panic.
pub fn catch_lost<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|panic| {
        let text = panic.downcast_ref::<&str>().copied();
        let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        match text {
            Some(text) => format!("it is lost: {}", text.trim()),
            None => "it is lost".to_string(),
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
pub fn map<T>(gpu: &Gpu, staging: &Buffer, bytes: u64, look: impl FnOnce(&[u8]) -> T) -> Result<T, String> {
    let receiver = scoped(gpu, || request(staging, bytes.max(4)))?;
    wait(gpu)?;
    let mapped = receiver.recv().map_err(|error| error.to_string())?;
    mapped.map_err(|error| error.to_string())?;
    let result = look(&view(gpu, staging, bytes.max(4))?[..bytes as usize]);
    scoped(gpu, || staging.unmap())?;
    Ok(result)
}

/// Copies the first words of a buffer.
///
/// # Errors
/// The device's message.
pub fn read_words(gpu: &Gpu, buffer: &Buffer, words: usize) -> Result<Vec<u32>, String> {
    let bytes = 4 * words as u64;
    scoped(gpu, || {
        let staging = staging(gpu, bytes);
        if words > 0 {
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, bytes);
            gpu.queue.submit([encoder.finish()]);
        }
        map(gpu, &staging, bytes, bytemuck::pod_collect_to_vec)
    })?
}
