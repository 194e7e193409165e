//! What the device remembers between steps, for snapshots.

use super::{GpuStep, StepError};
use crate::gpu::buffers::Sizes;
use crate::manifolds::gpu::ContactCapacity;
use crate::step::gpu::contacts::lists::StepCapacity;
use crate::step::gpu::contacts::memory::DeviceMemory;

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
        let Some(room) = self.contacts.as_ref().map(|contacts| contacts.room) else {
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
