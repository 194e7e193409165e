//! A step whose results are on their way.

use super::device::Gpu;
use super::readback::{poll, view};
use super::results::{Detail, Output, Parts, Raw};
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
    raw: Option<Raw>,
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
            raw: None,
        }
    }

    /// Waits for the results if they are not there yet, and tells whether it had to.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn wait(&mut self, gpu: &Gpu) -> Result<bool, String> {
        poll(gpu, PollType::Poll)?;
        let mapped = self.mapped.get();
        let (result, waited) = match mapped.try_recv() {
            Err(TryRecvError::Empty) => {
                let this = PollType::Wait {
                    submission_index: Some(self.submission.clone()),
                    timeout: None,
                };
                poll(gpu, this)?;
                (mapped.recv().map_err(|error| error.to_string())?, true)
            }
            Err(TryRecvError::Disconnected) => return Err("the results of a step were dropped".into()),
            Ok(result) => (result, false),
        };
        result.map_err(|error| error.to_string())?;
        let bytes = view(gpu, &self.staging, self.parts.total)?;
        self.raw = Some(self.parts.read(&bytes));
        drop(bytes);
        self.staging.unmap();
        Ok(waited)
    }

    /// The results as they came, once [`Flight::wait`] has waited for them.
    pub fn raw(&self) -> Option<&Raw> {
        self.raw.as_ref()
    }

    /// The results, and the buffer in which they came, once [`Flight::wait`] has waited for them.
    pub fn land(self, timer: Option<&Timer>) -> Option<(Output, Buffer)> {
        Some((self.raw?.sort(&self.input, timer), self.staging))
    }
}
