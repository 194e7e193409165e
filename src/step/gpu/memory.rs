//! Reads and writes the memory between steps with contacts, so that a snapshot continues to the bit.

use super::buffers::StepCapacity;
use super::contact_programs::ContactPrograms;
use super::remap::LastBodies;
use super::{GpuStep, StepError};
use crate::gpu::buffers::{Buffers, Capacity};
use crate::gpu::device::Gpu;
use crate::gpu::layout::{ContactPair, ContactPoint, Moved};
use crate::gpu::readback::{DeviceError, read_words, scoped};
use crate::manifolds::gpu::ContactCapacity;
use crate::solver::gpu::layout::{COUNTERS, MotionState, PAIRS, POINTS, SavedPair, SavedPoint};
use bytemuck::cast_slice;
use wgpu::Buffer;

/// The device's memory of its last step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviceMemory {
    pub(super) last_bodies: LastBodies,
    pub(super) moved: Vec<u32>,
    pub(super) last_step_states: Vec<u32>,
    pub(super) counters: Vec<u32>,
    pub(super) pairs: Vec<u32>,
    pub(super) points: Vec<u32>,
    pub(super) last_pairs: Vec<u32>,
    pub(super) last_points: Vec<u32>,
}

impl DeviceMemory {
    /// Waits for the last step, and reads its memory.
    ///
    /// # Errors
    /// If the device fails.
    pub fn read(
        gpu: &Gpu,
        buffers: &Buffers,
        contacts: &ContactPrograms,
        last_bodies: &LastBodies,
    ) -> Result<Self, DeviceError> {
        if last_bodies.is_empty() {
            return Ok(Self::default());
        }
        let step = &contacts.step;
        let mut counters = read_words(gpu, &step.last_step_counters, COUNTERS as usize)?;
        // The others are of use within a collision substep only, and collision substeps without need change them.
        for (counter, value) in (0..).zip(&mut counters) {
            if ![PAIRS, POINTS].contains(&counter) {
                *value = 0;
            }
        }
        let read = |buffer: &Buffer, count: usize, size: usize| read_words(gpu, buffer, count * size / 4);
        let bodies = last_bodies.len();
        let rows = bodies + last_bodies.compounds.len();
        let [pairs, points] = [PAIRS, POINTS].map(|counter| counters[counter as usize] as usize);
        Ok(Self {
            last_bodies: last_bodies.clone(),
            moved: read(&buffers.moved, rows, size_of::<Moved>())?,
            last_step_states: read(&step.last_step_states, bodies, size_of::<MotionState>())?,
            pairs: read(&step.last_step_pairs, pairs, size_of::<SavedPair>())?,
            points: read(&step.last_step_points, points, size_of::<SavedPoint>())?,
            last_pairs: read(&step.last_step_contact_pairs, pairs, size_of::<ContactPair>())?,
            last_points: read(&step.last_step_contact_points, points, size_of::<ContactPoint>())?,
            counters,
        })
    }

    /// Whether there was no step with contacts.
    pub fn is_empty(&self) -> bool {
        self.last_bodies.is_empty()
    }

    /// Number of bodies, and numbers of pairs and points.
    pub fn lengths(&self) -> (u32, [u32; 2]) {
        let of = |counter: u32| self.counters.get(counter as usize).copied().unwrap_or(0);
        (self.last_bodies.len() as u32, [of(PAIRS), of(POINTS)])
    }

    /// Writes it to lists that are long enough, and returns the number of bytes.
    ///
    /// # Errors
    /// If the device fails.
    pub fn write(&self, gpu: &Gpu, buffers: &Buffers, contacts: &ContactPrograms) -> Result<u64, DeviceError> {
        let step = &contacts.step;
        let parts = [
            (&buffers.moved, &self.moved),
            (&step.last_step_states, &self.last_step_states),
            (&step.last_step_counters, &self.counters),
            (&step.last_step_pairs, &self.pairs),
            (&step.last_step_points, &self.points),
            (&step.last_step_contact_pairs, &self.last_pairs),
            (&step.last_step_contact_points, &self.last_points),
        ];
        scoped(gpu, || {
            for (buffer, words) in parts {
                gpu.queue.write_buffer(buffer, 0, cast_slice(words));
            }
            parts.iter().map(|(_, words)| 4 * words.len() as u64).sum()
        })
    }
}

impl GpuStep {
    /// The device's memory after the last submitted step, for which it waits. It is empty unless the response is
    /// [`Response::Contacts`](crate::types::settings::Response).
    ///
    /// # Errors
    /// As [`GpuStep::take`].
    pub fn memory(&mut self) -> Result<DeviceMemory, StepError> {
        let read = self.finish_all().and_then(|()| match &self.contacts {
            Some(contacts) => {
                let read = DeviceMemory::read(&self.gpu, &self.buffers, contacts, &self.last_bodies);
                read.map_err(StepError::Device)
            }
            None => Ok(DeviceMemory::default()),
        });
        read.inspect_err(|_| self.fail())
    }

    /// Gives up all steps in flight, and continues from `memory` in the next one.
    ///
    /// # Errors
    /// If the device cannot hold it, or fails. The next step then has no memory.
    pub fn remember(&mut self, memory: &DeviceMemory) -> Result<(), StepError> {
        self.forget();
        if memory.last_bodies.is_empty() {
            return Ok(());
        }
        self.write_memory(memory).inspect_err(|_| self.fail())
    }

    fn write_memory(&mut self, memory: &DeviceMemory) -> Result<(), StepError> {
        self.ensure_contacts(true)?;
        let Some(capacity) = self.contacts.as_ref().map(ContactPrograms::capacity) else {
            return Ok(());
        };
        let (bodies, [pairs, points]) = memory.lengths();
        let needed = Capacity {
            bodies,
            compounds: memory.last_bodies.compounds.len() as u32,
            ..Capacity::default()
        };
        let contacts = ContactCapacity {
            pairs,
            points,
            ..ContactCapacity::default()
        };
        self.reserve(
            needed,
            Some(StepCapacity {
                contacts,
                solves: true,
                ..capacity
            }),
        )?;
        if let Some(contacts) = &self.contacts {
            let written = memory.write(&self.gpu, &self.buffers, contacts);
            self.between.uploaded_bytes += written.map_err(StepError::Device)?;
            self.last_bodies = memory.last_bodies.clone();
        }
        Ok(())
    }
}
