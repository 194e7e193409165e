//! A step in flight: submitted, with results that have not been read.

use super::fast_bodies::Impacts;
use super::readback_lengths::ReadbackLengths;
use super::results::{Detail, RawResults, StagingRanges};
use super::upload::Input;
use crate::gpu::device::Gpu;
use crate::gpu::readback::{DeviceError, poll, request, view};
use crate::types::gpu_work::GpuWork;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::sync::{Mutex, PoisonError};
use wgpu::{Buffer, BufferAsyncError, PollType, SubmissionIndex};

/// A submitted step.
pub(super) struct Flight {
    /// The input of the step, in case it has to be repeated.
    pub input: Input,
    /// Which results are read.
    pub detail: Detail,
    /// What was asked of the device.
    pub work: GpuWork,
    /// Impacts of bodies with continuous collision.
    pub impacts: Impacts,
    /// Receives the results.
    pub staging: Buffer,
    /// How much of each list is read.
    pub lengths: ReadbackLengths,
    ranges: StagingRanges,
    submission: SubmissionIndex,
    /// A receiver is not `Sync`, but steps are shared with systems. Only [`Flight::wait`] locks it.
    mapped: Mutex<Receiver<Result<(), BufferAsyncError>>>,
}

impl Flight {
    /// Call it after the submission that copies the results to `staging`.
    pub fn new(
        input: Input,
        detail: Detail,
        lengths: ReadbackLengths,
        ranges: StagingRanges,
        staging: Buffer,
        submission: SubmissionIndex,
        work: GpuWork,
        impacts: Impacts,
    ) -> Self {
        let mapped = request(&staging, ranges.total);
        Self {
            input,
            detail,
            work,
            impacts,
            staging,
            lengths,
            ranges,
            submission,
            mapped: Mutex::new(mapped),
        }
    }

    /// The results, and whether it had to wait for them.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn wait(&mut self, gpu: &Gpu) -> Result<(RawResults, bool), DeviceError> {
        poll(gpu, PollType::Poll)?;
        let mapped = self.mapped.get_mut().unwrap_or_else(PoisonError::into_inner);
        let (result, waited) = match mapped.try_recv() {
            Err(TryRecvError::Empty) => {
                let this = PollType::Wait {
                    submission_index: Some(self.submission.clone()),
                    timeout: None,
                };
                poll(gpu, this)?;
                (mapped.recv().map_err(DeviceError::failed)?, true)
            }
            Err(TryRecvError::Disconnected) => return Err(DeviceError::failed("the results of a step were dropped")),
            Ok(result) => (result, false),
        };
        result.map_err(DeviceError::failed)?;
        let bytes = view(gpu, &self.staging, self.ranges.total)?;
        let raw = self.ranges.read(&bytes);
        drop(bytes);
        self.staging.unmap();
        Ok((raw, waited))
    }
}
