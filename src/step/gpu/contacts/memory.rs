//! What outlives a step with contacts, brought to the host and back: so that a snapshot goes on to the bit.

use super::Contacts;
use super::lineage::Lineage;
use crate::gpu::buffers::Buffers;
use crate::gpu::device::Gpu;
use crate::gpu::layout::{ContactPair, ContactPoint, Moved};
use crate::gpu::readback::{read_words, scoped};
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
    pub fn read(gpu: &Gpu, buffers: &Buffers, contacts: &Contacts, lineage: &Lineage) -> Result<Self, String> {
        if lineage.is_empty() {
            return Ok(Self::default());
        }
        let lists = &contacts.lists;
        let counters = read_words(gpu, &lists.kept_counters, COUNTERS as usize)?;
        let read = |buffer: &Buffer, count: usize, size: usize| read_words(gpu, buffer, count * size / 4);
        let bodies = lineage.len();
        let [pairs, points] = [PAIRS, POINTS].map(|counter| counters[counter as usize] as usize);
        Ok(Self {
            lineage: lineage.clone(),
            moved: read(&buffers.moved, bodies, size_of::<Moved>())?,
            settled: read(&lists.settled, bodies, size_of::<BodyState>())?,
            pairs: read(&lists.kept_pairs, pairs, size_of::<KeptPair>())?,
            points: read(&lists.kept_points, points, size_of::<KeptPoint>())?,
            last_pairs: read(&lists.last_pairs, pairs, size_of::<ContactPair>())?,
            last_points: read(&lists.last_points, points, size_of::<ContactPoint>())?,
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
    pub fn write(&self, gpu: &Gpu, buffers: &Buffers, contacts: &Contacts) -> Result<(), String> {
        let lists = &contacts.lists;
        let parts = [
            (&buffers.moved, &self.moved),
            (&lists.settled, &self.settled),
            (&lists.kept_counters, &self.counters),
            (&lists.kept_pairs, &self.pairs),
            (&lists.kept_points, &self.points),
            (&lists.last_pairs, &self.last_pairs),
            (&lists.last_points, &self.last_points),
        ];
        scoped(gpu, || {
            for (buffer, words) in parts {
                gpu.queue.write_buffer(buffer, 0, cast_slice(words));
            }
        })
    }
}
