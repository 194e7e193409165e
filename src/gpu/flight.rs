//! A step whose results are on their way.

use super::device::Gpu;
use super::results::{Detail, Output, Parts};
use super::timer::Timer;
use super::upload::Input;
use bevy::platform::cell::SyncCell;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use wgpu::{Buffer, BufferAsyncError, MapMode, PollType, SubmissionIndex};

/// A step that was submitted.
pub(super) struct Flight {
    /// What it was told.
    pub input: Input,
    /// How much of it is wanted.
    pub detail: Detail,
    parts: Parts,
    staging: Buffer,
    submission: SubmissionIndex,
    mapped: SyncCell<Receiver<Result<(), BufferAsyncError>>>,
}

impl Flight {
    /// After the submission that copies the results into `staging`.
    pub fn new(input: Input, detail: Detail, parts: Parts, staging: Buffer, submission: SubmissionIndex) -> Self {
        let (sender, mapped) = channel();
        staging.map_async(MapMode::Read, ..parts.total, move |result| {
            // Nobody waits for a step that was given up.
            let _ = sender.send(result);
        });
        Self {
            input,
            detail,
            parts,
            staging,
            submission,
            mapped: SyncCell::new(mapped),
        }
    }

    /// Waits for the results if they are not there yet, and tells whether it had to.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn wait(&mut self, gpu: &Gpu) -> Result<bool, String> {
        let arrived = |result: Result<(), BufferAsyncError>| result.map_err(|error| error.to_string());
        gpu.device.poll(PollType::Poll).map_err(|error| error.to_string())?;
        let mapped = self.mapped.get();
        match mapped.try_recv() {
            Ok(result) => return arrived(result).map(|()| false),
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => return Err("the results of a step were dropped".into()),
        }
        let this = PollType::Wait {
            submission_index: Some(self.submission.clone()),
            timeout: None,
        };
        gpu.device.poll(this).map_err(|error| error.to_string())?;
        let result = mapped.recv().map_err(|error| error.to_string())?;
        arrived(result).map(|()| true)
    }

    /// The counters, for which [`Flight::wait`] has waited.
    pub fn counters(&self) -> Vec<u32> {
        self.parts
            .counters(&self.staging.slice(..self.parts.total).get_mapped_range())
    }

    /// The results, for which [`Flight::wait`] has waited, and the buffer in which they came.
    pub fn land(self, timer: Option<&Timer>) -> (Output, Buffer) {
        let bytes = self.staging.slice(..self.parts.total).get_mapped_range();
        let output = self.parts.read(&bytes, &self.input, self.detail, timer);
        drop(bytes);
        self.staging.unmap();
        (output, self.staging)
    }
}
