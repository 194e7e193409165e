//! What outlives a step with contacts, brought to the host and back: so that a snapshot goes on to the bit.

use super::buffers::StepCapacity;
use super::contact_programs::ContactPrograms;
use super::lineage::Lineage;
use super::{GpuStep, StepError};
use crate::gpu::buffers::{Buffers, Sizes};
use crate::gpu::device::Gpu;
use crate::gpu::layout::{ContactPair, ContactPoint, Moved};
use crate::gpu::readback::{read_words, scoped};
use crate::manifolds::gpu::ContactCapacity;
use crate::solver::gpu::layout::{BodyState, COUNTERS, KeptPair, KeptPoint, PAIRS, POINTS};
use bytemuck::cast_slice;
use wgpu::Buffer;

/// What the device remembers of its last step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviceMemory {
    pub(crate) lineage: Lineage,
    moved: Vec<u32>,
    settled: Vec<u32>,
    counters: Vec<u32>,
    pairs: Vec<u32>,
    points: Vec<u32>,
    last_pairs: Vec<u32>,
    last_points: Vec<u32>,
}

impl DeviceMemory {
    /// Waits for the last step, and reads.
    ///
    /// # Errors
    /// If the device fails.
    pub fn read(gpu: &Gpu, buffers: &Buffers, contacts: &ContactPrograms, lineage: &Lineage) -> Result<Self, String> {
        if lineage.is_empty() {
            return Ok(Self::default());
        }
        let step = &contacts.step;
        let counters = read_words(gpu, &step.stored_counters, COUNTERS as usize)?;
        let read = |buffer: &Buffer, count: usize, size: usize| read_words(gpu, buffer, count * size / 4);
        let bodies = lineage.len();
        let [pairs, points] = [PAIRS, POINTS].map(|counter| counters[counter as usize] as usize);
        Ok(Self {
            lineage: lineage.clone(),
            moved: read(&buffers.moved, bodies, size_of::<Moved>())?,
            settled: read(&step.settled, bodies, size_of::<BodyState>())?,
            pairs: read(&step.stored_pairs, pairs, size_of::<KeptPair>())?,
            points: read(&step.stored_points, points, size_of::<KeptPoint>())?,
            last_pairs: read(&step.stored_contact_pairs, pairs, size_of::<ContactPair>())?,
            last_points: read(&step.stored_contact_points, points, size_of::<ContactPoint>())?,
            counters,
        })
    }

    /// How many bodies it is about, and how many pairs and points.
    pub fn lengths(&self) -> (u32, [u32; 2]) {
        let of = |counter: u32| self.counters.get(counter as usize).copied().unwrap_or(0);
        (self.lineage.len() as u32, [of(PAIRS), of(POINTS)])
    }

    /// Writes it back to lists that are long enough.
    ///
    /// # Errors
    /// If the device fails.
    pub fn write(&self, gpu: &Gpu, buffers: &Buffers, contacts: &ContactPrograms) -> Result<(), String> {
        let step = &contacts.step;
        let parts = [
            (&buffers.moved, &self.moved),
            (&step.settled, &self.settled),
            (&step.stored_counters, &self.counters),
            (&step.stored_pairs, &self.pairs),
            (&step.stored_points, &self.points),
            (&step.stored_contact_pairs, &self.last_pairs),
            (&step.stored_contact_points, &self.last_points),
        ];
        scoped(gpu, || {
            for (buffer, words) in parts {
                gpu.queue.write_buffer(buffer, 0, cast_slice(words));
            }
        })
    }
}

impl GpuStep {
    /// What the device remembers of the last step that was submitted, for which it waits; empty but with
    /// [`Response::Contacts`](crate::types::settings::Response).
    ///
    /// # Errors
    /// As [`GpuStep::take`].
    pub fn memory(&mut self) -> Result<DeviceMemory, StepError> {
        let read = self.settle().and_then(|()| match &self.contacts {
            Some(contacts) => {
                let read = DeviceMemory::read(&self.gpu, &self.buffers, contacts, &self.lineage);
                read.map_err(StepError::Device)
            }
            None => Ok(DeviceMemory::default()),
        });
        read.inspect_err(|_| self.fail())
    }

    /// Gives up all steps in flight and lets the next one go on from `memory`.
    ///
    /// # Errors
    /// If the device cannot hold it, or fails. The next step goes on from nothing then.
    pub fn remember(&mut self, memory: &DeviceMemory) -> Result<(), StepError> {
        self.forget();
        if memory.lineage.is_empty() {
            return Ok(());
        }
        self.write_memory(memory).inspect_err(|_| self.fail())
    }

    fn write_memory(&mut self, memory: &DeviceMemory) -> Result<(), StepError> {
        self.want_contacts()?;
        let Some(room) = self.contacts.as_ref().map(ContactPrograms::room) else {
            return Ok(());
        };
        let (bodies, [pairs, points]) = memory.lengths();
        let needed = Sizes {
            bodies,
            ..Sizes::default()
        };
        let contacts = ContactCapacity {
            pairs,
            points,
            ..ContactCapacity::default()
        };
        self.make_room(needed, Some(StepCapacity { contacts, ..room }))?;
        if let Some(contacts) = &self.contacts {
            memory
                .write(&self.gpu, &self.buffers, contacts)
                .map_err(StepError::Device)?;
            self.lineage = memory.lineage.clone();
        }
        Ok(())
    }
}
