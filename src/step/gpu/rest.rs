//! Steps in which all bodies sleep: the device has nothing to do.
//!
//! In a step at rest every collider is inactive from the beginning, so contacts are those of the step before, nothing
//! is solved, and every body that can move is asleep at the end. The kernels `step/finish` and `step/finish_compounds`
//! tell whether a step was one; `step/remember` then leaves the memory between steps as it is. The next step with the
//! same input would change nothing, so it is not submitted: its results are those of the last one.

use super::GpuStep;
use super::results::{Detail, Output};
use super::upload::Input;
use crate::gpu::commands::Commands;
use crate::types::gpu_work::GpuWork;

/// The results of the last step, if it was at rest.
pub(super) struct Rest {
    output: Output,
    detail: Detail,
}

impl Rest {
    /// The results of a finished step, if it was at rest.
    pub fn of(output: &Output, detail: Detail) -> Option<Self> {
        output.rests.then(|| Self {
            output: output.clone(),
            detail,
        })
    }

    /// Whether a step with this input, whose changes are recorded, follows and is the same.
    pub fn goes_on(&self, input: &Input, detail: Detail, commands: &Commands, earlier: &GpuWork) -> bool {
        let is_unchanged = commands.uploaded_bytes() == 0 && earlier.uploaded_bytes == 0;
        let may_sleep = input.solver.as_ref().is_some_and(|solver| solver.may_sleep());
        is_unchanged && may_sleep && self.detail == detail
    }
}

impl GpuStep {
    /// The results of a step that need not run, because it is at rest like the last one. `earlier` is what was done
    /// since.
    pub(super) fn at_rest(&self, earlier: GpuWork) -> Option<Output> {
        let Rest { output, .. } = self.rest.as_ref()?;
        Some(Output {
            times: Default::default(),
            work: GpuWork {
                memory_bytes: self.bytes(),
                batches: output.work.batches,
                lists: output.work.lists,
                ..earlier
            },
            ..output.clone()
        })
    }
}
