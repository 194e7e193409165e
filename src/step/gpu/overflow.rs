//! Overflow: lists that were too short are made longer, and the steps in flight are repeated.
//!
//! A kernel that finds a list too short sets a flag in `status` and in the step's counters: `broad_phase/arguments`
//! does for pairs, `step/overflow_lists` and `step/overflow_touches` for other lists. So does `step/begin_substep` if a
//! step needs more collision substeps than are recorded. That step and all later ones then change nothing.

use super::buffers::StepCapacity;
use super::fast_bodies::FastBodies;
use super::flight::Flight;
use super::readback_lengths::ReadbackLengths;
use super::rest::Rest;
use super::results::{Output, RawResults};
use super::upload::Input;
use super::{GpuStep, StepError};
use crate::gpu::buffers::Capacity;
use crate::gpu::layout::{
    CONTACTS_CUT_SHORT, CUT_SHORT, HITS, MAX_SPHERE_PAIRS, NEEDED_SUBSTEPS, PIECES, PLANE_CONTACTS, SKIPPED,
    SPHERE_PAIRS, TOUCHES,
};
use crate::gpu::program::Population;
use crate::gpu::readback::{DeviceError, scoped};
use crate::types::gpu_work::{GpuList, GpuLists, GpuWork};
use crate::types::settings::Response;

impl GpuStep {
    /// Waits for all steps in flight.
    pub(super) fn finish_all(&mut self) -> Result<(), StepError> {
        self.finish_all_with(None)
    }

    /// Waits for all steps in flight. `fast_bodies` are those of the last one. Earlier ones have none, because a step
    /// with fast bodies is finished when it is submitted.
    pub(super) fn finish_all_with(&mut self, fast_bodies: Option<FastBodies>) -> Result<(), StepError> {
        while !self.flights.is_empty() {
            let output = self.finish_oldest(fast_bodies)?;
            self.finished.push_back(output);
        }
        Ok(())
    }

    /// Waits for the oldest step in flight.
    pub(super) fn finish_oldest(&mut self, fast_bodies: Option<FastBodies>) -> Result<Output, StepError> {
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
                let work = self.work_of(&flight, &raw);
                self.note_use(&flight.input, &work, &raw.tally);
                self.spare.push(flight.staging);
                let output = raw.sort(&flight.input, &flight.impacts, self.timer.as_ref());
                let output = Output { work, ..output };
                self.rest = Rest::of(&output, flight.detail);
                self.recent_lengths.add(ReadbackLengths::used(&work.lists));
                return Ok(output);
            }
            if !self.repeat(&raw.counters, &raw.tally, fast_bodies)? {
                return Err(StepError::Device(DeviceError::failed(
                    "a list is too short, and none needs to be longer",
                )));
            }
        }
        Err(StepError::Device(DeviceError::failed("there is no step to wait for")))
    }

    /// What a step asked of the device, with memory and lists.
    fn work_of(&self, flight: &Flight, raw: &RawResults) -> GpuWork {
        let of = |length: u32, capacity: u32| GpuList { length, capacity };
        let counter = |counter: u32| raw.counters[counter as usize];
        let capacity = &self.buffers.capacity;
        let mut lists = GpuLists {
            sphere_pairs: of(
                counter(SPHERE_PAIRS).max(raw.tally[MAX_SPHERE_PAIRS as usize]),
                capacity.pairs,
            ),
            face_pairs: of(flight.input.listed_hits(counter(HITS)), capacity.hits),
            plane_contacts: of(counter(PLANE_CONTACTS), capacity.plane_contacts),
            pair_pieces: of(counter(PIECES), capacity.pieces),
            ..GpuLists::default()
        };
        let with_points = flight.input.response != Response::Impulse;
        let mut batches = 0;
        if let Some(contacts) = self.contacts.as_ref().filter(|_| with_points) {
            let StepCapacity { contacts, touches, .. } = contacts.capacity();
            let needed = self.batch_size.needed(&raw.tally, contacts.batches);
            batches = contacts.batches;
            lists.near_triangles = of(needed.near_triangles, contacts.near_triangles);
            lists.near_pieces = of(needed.pieces, contacts.pieces);
            lists.features = of(needed.features, contacts.features);
            lists.segments = of(needed.segments, contacts.segments);
            lists.staged_points = of(needed.staged_points, contacts.staged_points);
            lists.manifolds = of(needed.pairs, contacts.pairs);
            lists.contact_points = of(needed.points, contacts.points);
            lists.touches = of(raw.tally[TOUCHES as usize], touches);
        }
        GpuWork {
            memory_bytes: self.bytes() + flight.staging.size(),
            batches,
            lists,
            ..flight.work
        }
    }

    /// Notes how much of each list a step used.
    fn note_use(&mut self, input: &Input, work: &GpuWork, tally: &[u32]) {
        let lists = &work.lists;
        let Population {
            bodies,
            compounds,
            planes,
            ..
        } = input.population();
        let used = Capacity {
            bodies,
            compounds,
            parts: input.part_count(),
            planes,
            pairs: lists.sphere_pairs.length,
            hits: lists.face_pairs.length,
            plane_contacts: lists.plane_contacts.length,
            pieces: lists.pair_pieces.length,
            ..Capacity::default()
        };
        let with_points = input.response != Response::Impulse;
        let for_contacts = with_points.then(|| StepCapacity {
            contacts: self.batch_size.needed(tally, work.batches),
            bodies: input.old_bodies().max(bodies + planes),
            touches: lists.touches.length,
            solves: input.response == Response::Contacts,
            // Games shoot again.
            has_fast_bodies: false,
        });
        self.peak_usage.add(used, for_contacts);
    }

    /// Repeats all steps in flight with longer lists, or with more collision substeps. Returns whether lists or
    /// collision substeps were too few. No body has moved since the first of these steps, because its overflow made the
    /// others do nothing.
    fn repeat(&mut self, counters: &[u32], tally: &[u32], fast_bodies: Option<FastBodies>) -> Result<bool, StepError> {
        let needed = Capacity {
            pairs: counters[SPHERE_PAIRS as usize].max(tally[MAX_SPHERE_PAIRS as usize]),
            hits: (self.flights.front()).map_or(0, |flight| flight.input.listed_hits(counters[HITS as usize])),
            plane_contacts: counters[PLANE_CONTACTS as usize],
            pieces: counters[PIECES as usize],
            ..Capacity::default()
        };
        let for_contacts = self.contacts.as_ref().map(|contacts| {
            let has = contacts.capacity();
            StepCapacity {
                contacts: self.batch_size.needed(tally, has.contacts.batches),
                touches: tally[TOUCHES as usize],
                ..has
            }
        });
        let lengths = ReadbackLengths::in_buffers(&needed, for_contacts);
        let lacks_length = self.flights.front().is_some_and(|flight| flight.lengths.lacks(lengths));
        let substeps = counters[NEEDED_SUBSTEPS as usize];
        let lacks_substeps = (self.flights.front()).is_some_and(|flight| flight.input.recorded_substeps() < substeps);
        if !lacks_length && !lacks_substeps && !self.needs_growth(needed, for_contacts) {
            return Ok(false);
        }
        self.recent_lengths.raise(lengths);
        self.reserve(needed, for_contacts)?;
        let mut between = std::mem::take(&mut self.between);
        for mut flight in std::mem::take(&mut self.flights) {
            // Later steps are likely to need as many collision substeps.
            flight.input.record_substeps(substeps);
            let earlier = flight.work.after(&std::mem::take(&mut between));
            self.launch(flight.input, flight.detail, earlier, fast_bodies)?;
        }
        Ok(true)
    }
}
