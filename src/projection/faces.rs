//! The table of faces of collision: which triangles can be seen from each direction.

use super::{BakeSettings, Cancelled, Progress};
use crate::geometry::TriMesh;
use thiserror::Error;

/// Why bytes are not a table.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TableError {
    /// The bytes end early or hold impossible values.
    #[error("the face table is damaged: {0}")]
    Damaged(&'static str),
}

/// The deduplicated table in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceTable {}

impl FaceTable {
    /// Draws the mesh from every direction.
    pub fn bake(
        mesh: &TriMesh,
        settings: &BakeSettings,
        pool: &rayon::ThreadPool,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let _ = (mesh, settings, pool, progress);
        todo!()
    }

    /// The run-length form for files.
    pub fn encode(&self) -> Vec<u8> {
        todo!()
    }

    /// Reads [`FaceTable::encode`]'s bytes for a mesh of `triangles` triangles.
    pub fn decode(bytes: &[u8], triangles: u32, settings: &BakeSettings) -> Result<Self, TableError> {
        let _ = (bytes, triangles, settings);
        todo!()
    }
}
