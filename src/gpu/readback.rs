//! From the device to the host.

use super::device::Gpu;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, channel};
use wgpu::{Buffer, BufferAsyncError, BufferDescriptor, BufferUsages, BufferView, ErrorFilter, MapMode, PollType};

/// Runs `work` and reports what the device says against it. An error out of any scope would make Bevy end the app.
///
/// # Errors
/// The first error, if there is any.
pub fn scoped<T>(gpu: &Gpu, work: impl FnOnce() -> T) -> Result<T, String> {
    let filters = [ErrorFilter::Internal, ErrorFilter::OutOfMemory, ErrorFilter::Validation];
    let scopes = filters.map(|filter| gpu.device.push_error_scope(filter));
    let result = work();
    let mut first = None;
    // The last one pushed is the first to be popped.
    for scope in scopes.into_iter().rev() {
        let error = pollster::block_on(scope.pop());
        first = first.or(error);
    }
    first.map_or(Ok(result), |error| Err(error.to_string()))
}

/// Waits until all work is done.
///
/// # Errors
/// If the device is lost.
pub fn wait(gpu: &Gpu) -> Result<(), String> {
    poll(gpu, PollType::wait_indefinitely())
}

/// Sees what is done, or waits for it.
///
/// # Errors
/// If the device is lost.
pub fn poll(gpu: &Gpu, what: PollType) -> Result<(), String> {
    let polled = catch_lost(|| gpu.device.poll(what))?;
    polled.map(|_| ()).map_err(|error| error.to_string())
}

/// Whether the device still works. A lost one may report that a buffer is mapped, and looking at it is a panic.
///
/// # Errors
/// If the device is lost.
pub fn alive(gpu: &Gpu) -> Result<(), String> {
    scoped(gpu, || {
        // wgpu keeps errors of lost devices to itself, but refuses to map their buffers, at once.
        match request(&staging(gpu, 4), 4).try_recv() {
            Ok(Err(_)) => Err("it is lost".to_string()),
            _ => Ok(()),
        }
    })?
}

/// Asks for the first `bytes` of a staging buffer to be mapped, and is told when they are.
pub fn request(staging: &Buffer, bytes: u64) -> Receiver<Result<(), BufferAsyncError>> {
    let (sender, receiver) = channel();
    staging.map_async(MapMode::Read, ..bytes, move |result| {
        // Nobody waits any more: the step was given up, or waiting failed, which is reported there.
        let _ = sender.send(result);
    });
    receiver
}

/// What was mapped.
///
/// # Errors
/// If the device is lost.
pub fn view(gpu: &Gpu, staging: &Buffer, bytes: u64) -> Result<BufferView, String> {
    alive(gpu)?;
    catch_lost(|| staging.slice(..bytes).get_mapped_range())
}

/// Some calls make wgpu panic, without a lock in its hands, if the device is lost by then; and a shared one may be lost at any
/// time, to somebody else.
///
/// # Errors
/// If it did.
pub fn catch_lost<T>(call: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|_| "it is lost".to_string())
}

/// A buffer to map.
pub fn staging(gpu: &Gpu, bytes: u64) -> Buffer {
    gpu.device.create_buffer(&BufferDescriptor {
        label: Some("readback"),
        size: bytes.max(4),
        usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Waits for the first `bytes` of a staging buffer, hands them to `look`, and unmaps it.
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
/// What the device says.
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
