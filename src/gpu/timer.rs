//! How long each stage took on the device, where it can tell.

use super::device::Gpu;
use crate::types::stage::Stage;
use std::time::Duration;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Features, QuerySet,
    QuerySetDescriptor, QueryType,
};

/// Two time stamps for each stage of each interval.
pub struct Timer {
    queries: QuerySet,
    resolved: Buffer,
    /// Nanoseconds a tick.
    period: f64,
}

/// Stamps of an interval.
const COUNT: u32 = 2 * Stage::ALL.len() as u32;
/// Bytes that they take.
pub const BYTES: u32 = 8 * COUNT;
/// The most intervals there can be.
const LAPS: u32 = crate::types::solver_settings::MAX_COLLISION_SUBSTEPS;

impl Timer {
    /// `None` if the device has no time stamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(Features::TIMESTAMP_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&QuerySetDescriptor {
                label: Some("stage times"),
                ty: QueryType::Timestamp,
                count: LAPS * COUNT,
            }),
            resolved: gpu.device.create_buffer(&BufferDescriptor {
                label: Some("stage times"),
                size: u64::from(LAPS * BYTES),
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            period: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// Stamps the beginning and the end of a stage in an interval. Each stage must be recorded in each of them.
    pub fn around(&self, stage: Stage, interval: u32) -> ComputePassTimestampWrites<'_> {
        let first = interval * COUNT + 2 * stage as u32;
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// To be recorded after the stages of so many intervals.
    pub fn resolve(&self, encoder: &mut CommandEncoder, collision_substeps: u32) {
        encoder.resolve_query_set(&self.queries, 0..collision_substeps * COUNT, &self.resolved, 0);
    }

    /// Where the stamps then are, [`BYTES`] for each interval.
    pub fn resolved(&self) -> &Buffer {
        &self.resolved
    }

    /// What the stamps of all intervals mean: sums over them.
    pub fn times(&self, stamps: &[u64]) -> [Duration; Stage::COUNT] {
        Stage::ALL.map(|stage| {
            let at = 2 * stage as usize;
            let collision_substeps = stamps.chunks_exact(COUNT as usize);
            let ticks: u64 = collision_substeps.map(|lap| lap[at + 1].saturating_sub(lap[at])).sum();
            Duration::from_nanos((ticks as f64 * self.period) as u64)
        })
    }
}
