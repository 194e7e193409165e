//! Overflow: lists that were too short are made longer, and the steps in flight are repeated.
//!
//! A kernel that finds a list too short sets a flag in `status` and in the step's counters: `broad_phase/arguments`
//! does for pairs, `step/overflow_lists` and `step/overflow_touches` for other lists. That step and all later ones then
//! change nothing.

use super::buffers::StepCapacity;
use super::results::Output;
use super::{GpuStep, StepError};
use crate::gpu::buffers::Capacity;
use crate::gpu::layout::{
    CONTACTS_CUT_SHORT, CUT_SHORT, HITS, MAX_SPHERE_PAIRS, PLANE_CONTACTS, SKIPPED, SPHERE_PAIRS, TOUCHES,
};
use crate::gpu::readback::scoped;
use crate::manifolds::gpu::ContactCapacity;

impl GpuStep {
    /// Waits for all steps in flight.
    pub(super) fn finish_all(&mut self) -> Result<(), StepError> {
        while !self.flights.is_empty() {
            let output = self.finish_oldest()?;
            self.finished.push_back(output);
        }
        Ok(())
    }

    /// Waits for the oldest step in flight.
    pub(super) fn finish_oldest(&mut self) -> Result<Output, StepError> {
        while let Some(flight) = self.flights.front_mut() {
            let results = scoped(&self.gpu, || flight.wait(&self.gpu));
            let (raw, waited) = results.and_then(|results| results).map_err(StepError::Device)?;
            self.waits += u64::from(waited);
            if raw.counters[CUT_SHORT as usize] != 0 || raw.tally[CONTACTS_CUT_SHORT as usize] != 0 {
                return Err(StepError::CutShort);
            }
            if raw.counters[SKIPPED as usize] == 0
                && let Some(flight) = self.flights.pop_front()
            {
                self.spare.push(flight.staging);
                return Ok(raw.sort(&flight.input, self.timer.as_ref()));
            }
            if !self.repeat(&raw.counters, &raw.tally)? {
                return Err(StepError::Device(
                    "a list is too short, and none needs to be longer".into(),
                ));
            }
        }
        Err(StepError::Device("there is no step to wait for".into()))
    }

    /// Repeats all steps in flight with longer lists, and returns whether a list was too short. No body has moved since
    /// the first of them, because its overflow made the others do nothing.
    fn repeat(&mut self, counters: &[u32], tally: &[u32]) -> Result<bool, StepError> {
        let needed = Capacity {
            pairs: counters[SPHERE_PAIRS as usize].max(tally[MAX_SPHERE_PAIRS as usize]),
            hits: counters[HITS as usize],
            plane_contacts: counters[PLANE_CONTACTS as usize],
            ..Capacity::default()
        };
        let for_contacts = self.contacts.as_ref().map(|contacts| StepCapacity {
            contacts: ContactCapacity::needed(tally),
            touches: tally[TOUCHES as usize],
            ..contacts.capacity()
        });
        if !self.needs_growth(needed, for_contacts) {
            return Ok(false);
        }
        self.reserve(needed, for_contacts)?;
        for flight in std::mem::take(&mut self.flights) {
            self.launch(flight.input, flight.detail)?;
        }
        Ok(true)
    }
}
