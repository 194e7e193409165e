//! How long each stage took on the device, where it can tell.

use super::device::Gpu;
use crate::stages::Stage;
use std::time::Duration;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Features, QuerySet,
    QuerySetDescriptor, QueryType,
};

/// Two time stamps a stage.
pub struct Timer {
    queries: QuerySet,
    resolved: Buffer,
    /// Nanoseconds a tick.
    period: f64,
}

/// Stamps of a step.
pub const COUNT: u32 = 2 * Stage::ALL.len() as u32;
/// Bytes that they take.
pub const BYTES: u64 = 8 * COUNT as u64;

impl Timer {
    /// `None` if the device has no time stamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(Features::TIMESTAMP_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&QuerySetDescriptor {
                label: Some("stage times"),
                ty: QueryType::Timestamp,
                count: COUNT,
            }),
            resolved: gpu.device.create_buffer(&BufferDescriptor {
                label: Some("stage times"),
                size: BYTES,
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            period: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// Stamps the beginning and the end of a stage.
    pub fn around(&self, stage: Stage) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * stage as u32),
            end_of_pass_write_index: Some(2 * stage as u32 + 1),
        }
    }

    /// To be recorded after the stages.
    pub fn resolve(&self, encoder: &mut CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..COUNT, &self.resolved, 0);
    }

    /// Where the stamps then are, as many as [`COUNT`].
    pub fn resolved(&self) -> &Buffer {
        &self.resolved
    }

    /// What the stamps mean.
    pub fn times(&self, stamps: &[u64]) -> [Duration; Stage::COUNT] {
        Stage::ALL.map(|stage| {
            let [start, end] = [0, 1].map(|k| stamps[2 * stage as usize + k]);
            Duration::from_nanos((end.saturating_sub(start) as f64 * self.period) as u64)
        })
    }
}
