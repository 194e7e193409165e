//! The time that each stage takes on the device, if it has time stamps.

use super::device::Gpu;
use crate::types::solver_settings::MAX_COLLISION_SUBSTEPS;
use crate::types::stage::Stage;
use std::time::Duration;
use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Features, QuerySet,
    QuerySetDescriptor, QueryType,
};

/// Two time stamps per stage and collision substep.
pub struct Timer {
    queries: QuerySet,
    resolved: Buffer,
    /// Nanoseconds per tick.
    period: f64,
}

/// Time stamps per collision substep.
const COUNT: u32 = 2 * Stage::ALL.len() as u32;
/// Size of a collision substep's time stamps, bytes.
pub const BYTES: u32 = 8 * COUNT;

impl Timer {
    /// `None` if the device has no time stamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        gpu.device.features().contains(Features::TIMESTAMP_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&QuerySetDescriptor {
                label: Some("stage times"),
                ty: QueryType::Timestamp,
                count: MAX_COLLISION_SUBSTEPS * COUNT,
            }),
            resolved: gpu.device.create_buffer(&BufferDescriptor {
                label: Some("stage times"),
                size: u64::from(MAX_COLLISION_SUBSTEPS * BYTES),
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            period: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// Writes time stamps at the beginning and at the end of a stage. Every stage must be recorded in every collision
    /// substep.
    pub fn around(&self, stage: Stage, collision_substep: u32) -> ComputePassTimestampWrites<'_> {
        let first = collision_substep * COUNT + 2 * stage as u32;
        ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// Writes the time stamp at the beginning of a stage that has two passes.
    pub fn start(&self, stage: Stage, collision_substep: u32) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            end_of_pass_write_index: None,
            ..self.around(stage, collision_substep)
        }
    }

    /// Writes the time stamp at the end of a stage that has two passes.
    pub fn end(&self, stage: Stage, collision_substep: u32) -> ComputePassTimestampWrites<'_> {
        ComputePassTimestampWrites {
            beginning_of_pass_write_index: None,
            ..self.around(stage, collision_substep)
        }
    }

    /// Resolves the time stamps. Record it after the stages of all collision substeps.
    pub fn resolve(&self, encoder: &mut CommandEncoder, collision_substeps: u32) {
        encoder.resolve_query_set(&self.queries, 0..collision_substeps * COUNT, &self.resolved, 0);
    }

    /// The buffer of resolved time stamps: [`BYTES`] per collision substep.
    pub fn resolved(&self) -> &Buffer {
        &self.resolved
    }

    /// The time of each stage, summed over the collision substeps.
    pub fn times(&self, stamps: &[u64]) -> [Duration; Stage::COUNT] {
        Stage::ALL.map(|stage| {
            let at = 2 * stage as usize;
            let collision_substeps = stamps.chunks_exact(COUNT as usize);
            let ticks: u64 = collision_substeps
                .map(|stamps| stamps[at + 1].saturating_sub(stamps[at]))
                .sum();
            Duration::from_nanos((ticks as f64 * self.period) as u64)
        })
    }
}
