//! The JSON of what a step asked of a GPU.

use bevy_faceoff::types::gpu_work::GpuWork;
use serde::Serialize;
use std::collections::BTreeMap;

/// The fields of [`GpuWork`].
#[derive(Serialize)]
pub struct WorkRecord {
    /// All but those that wgpu adds.
    pub dispatches: u32,
    indirect: u32,
    validations: u32,
    passes: u32,
    copies: u32,
    submissions: u32,
    pub uploaded_bytes: u64,
    pub read_back_bytes: u64,
    pub memory_bytes: u64,
    batches: u32,
    lists: BTreeMap<&'static str, List>,
}

#[derive(Serialize)]
struct List {
    length: u32,
    capacity: u32,
}

impl WorkRecord {
    /// Dispatches with those that wgpu adds.
    pub fn all_dispatches(&self) -> u64 {
        u64::from(self.dispatches + self.validations)
    }
}

impl From<&GpuWork> for WorkRecord {
    fn from(work: &GpuWork) -> Self {
        let lists = work.lists.iter().map(|(name, list)| {
            let (length, capacity) = (list.length, list.capacity);
            (name, List { length, capacity })
        });
        Self {
            dispatches: work.dispatches,
            indirect: work.indirect,
            validations: work.validations,
            passes: work.passes,
            copies: work.copies,
            submissions: work.submissions,
            uploaded_bytes: work.uploaded_bytes,
            read_back_bytes: work.read_back_bytes,
            memory_bytes: work.memory_bytes,
            batches: work.batches,
            lists: lists.collect(),
        }
    }
}
