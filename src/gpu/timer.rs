//! How long each stage took on the device, where it can tell.

use super::device::Gpu;
use super::readback::{map, staging};
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
    staging: Buffer,
}

const COUNT: u32 = 2 * Stage::ALL.len() as u32;
const BYTES: u64 = 8 * COUNT as u64;

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
            staging: staging(gpu, BYTES),
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
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, BYTES);
    }

    /// The times of the step that ran last.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read(&self, gpu: &Gpu) -> Result<[Duration; 5], String> {
        let nanoseconds = f64::from(gpu.queue.get_timestamp_period());
        map(gpu, &self.staging, BYTES, |bytes| {
            let stamps: Vec<u64> = bytemuck::pod_collect_to_vec(bytes);
            Stage::ALL.map(|stage| {
                let [start, end] = [0, 1].map(|k| stamps[2 * stage as usize + k]);
                Duration::from_nanos((end.saturating_sub(start) as f64 * nanoseconds) as u64)
            })
        })
    }
}
