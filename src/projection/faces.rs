//! The face table: the triangles that are visible from each direction.
//!
//! The directions are those of a [`DirectionGrid`], and [`raster`](super::raster) defines which triangles are visible.
//! The visible triangles of a direction are a *group*. Many directions have the same group, so in memory each distinct
//! group is stored once, and each direction holds the number of its group. Files use the run-length encoding of Aly &
//! Elawady 2010.

pub use super::groups::{Group, GroupIter};

use super::groups::{GroupStore, Interner, index_width};
use crate::geometry::direction::DirectionGrid;
use glam::Vec3;
use thiserror::Error;

/// Why a face table cannot be read.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TableError {
    /// The bytes end too early or hold invalid values.
    #[error("the face table is damaged: {0}")]
    Damaged(&'static str),
}

/// The face table of a mesh: for each direction the triangles that are visible from there, without duplicate groups.
///
/// [`FaceTable::bake`] or [`FaceTable::decode`] makes one. Triangles are indices into
/// [`TriMesh::triangles`](crate::geometry::TriMesh::triangles).
#[derive(Clone, Debug, PartialEq)]
pub struct FaceTable {
    pub(super) grid: DirectionGrid,
    pub(super) triangles: u32,
    /// For each direction of the grid, the number of its group.
    pub(super) directions: Vec<u32>,
    pub(super) store: GroupStore,
}

/// Counts and sizes of a face table, to help choose bake settings.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct TableStats {
    /// Distinct directions.
    pub directions: usize,
    /// Distinct groups.
    pub groups: usize,
    /// Runs of equal groups, in the order of the directions.
    pub runs: usize,
    /// Triangles in the smallest group.
    pub min_visible: usize,
    /// The mean number of triangles per direction.
    pub mean_visible: f64,
    /// Triangles in the largest group.
    pub max_visible: usize,
    /// Size in bytes if each direction had its own list of indices and a 4-byte offset to it.
    pub raw_bytes: u64,
    /// Size in bytes if each run had its own list of indices and a 4-byte counter, as in Aly & Elawady 2010.
    pub run_length_bytes: u64,
    /// Size in bytes of [`FaceTable::encode`].
    pub encoded_bytes: u64,
    /// Size in bytes of this table in memory.
    pub memory_bytes: u64,
}

impl FaceTable {
    /// Builds the table from the runs of groups, in the order of the grid's directions.
    pub(super) fn collect(
        grid: DirectionGrid,
        triangles: u32,
        runs: impl Iterator<Item = (u32, u32)>,
        interner: Interner,
    ) -> Self {
        let mut directions = Vec::new();
        for (group, count) in runs {
            directions.extend(std::iter::repeat_n(group, count as usize));
        }
        directions.shrink_to_fit();
        Self {
            grid,
            triangles,
            directions,
            store: interner.finish(),
        }
    }

    /// The triangles visible from far out in `direction`, which is given in the mesh's own axes with any non-zero
    /// length.
    ///
    /// The zero vector and NaN give the group of an unspecified direction. If the centres of two bodies coincide there
    /// is no direction; use all triangles instead.
    pub fn group(&self, direction: Vec3) -> Group<'_> {
        self.distinct(self.group_id(direction))
    }

    /// The number of [`FaceTable::group`]'s result, for [`FaceTable::distinct`].
    pub fn group_id(&self, direction: Vec3) -> u32 {
        self.directions[self.grid.index_of(direction) as usize]
    }

    /// The group at the angles `a_step` and `b_step`, in steps and modulo a full turn. Aly & Elawady 2010 address the
    /// table like this, as 360 x 360 entries at one degree.
    pub fn at(&self, a_step: u32, b_step: u32) -> Group<'_> {
        self.of_direction(self.grid.index_at(a_step, b_step))
    }

    /// The group of the grid's direction `index`.
    ///
    /// # Panics
    ///
    /// If the grid has no such direction.
    pub fn of_direction(&self, index: u32) -> Group<'_> {
        self.distinct(self.directions[index as usize])
    }

    /// The directions of the table.
    pub fn grid(&self) -> DirectionGrid {
        self.grid
    }

    /// The number of triangles of the mesh.
    pub fn triangles(&self) -> u32 {
        self.triangles
    }

    /// For each direction of [`FaceTable::grid`], the number of its group, below [`FaceTable::distinct_len`].
    pub fn directions(&self) -> &[u32] {
        &self.directions
    }

    /// The number of distinct groups.
    pub fn distinct_len(&self) -> usize {
        self.store.len()
    }

    /// The distinct group with number `id`.
    ///
    /// # Panics
    ///
    /// If there is no such group.
    pub fn distinct(&self, id: u32) -> Group<'_> {
        Group::new(self.store.bytes(id), self.triangles)
    }

    /// The size of this table in memory, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.directions.capacity() * size_of::<u32>() + self.store.memory_bytes()
    }

    /// The runs of equal groups, in the order of the directions: group number and length.
    pub(super) fn runs(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.directions
            .chunk_by(|a, b| a == b)
            .map(|run| (run[0], run.len() as u32))
    }

    /// Counts and sizes. This encodes the whole table to measure its size in a file.
    pub fn stats(&self) -> TableStats {
        let lens: Vec<usize> = (0..self.distinct_len())
            .map(|id| self.distinct(id as u32).len())
            .collect();
        let len = |id: u32| lens[id as usize];
        let list = |id: u32| (4 + len(id) * index_width(self.triangles)) as u64;
        let visible: usize = self.directions.iter().map(|&id| len(id)).sum();
        TableStats {
            directions: self.directions.len(),
            groups: self.distinct_len(),
            runs: self.runs().count(),
            min_visible: lens.iter().copied().min().unwrap_or(0),
            mean_visible: visible as f64 / self.directions.len() as f64,
            max_visible: lens.iter().copied().max().unwrap_or(0),
            raw_bytes: self.directions.iter().map(|&id| list(id)).sum(),
            run_length_bytes: self.runs().map(|(id, _)| list(id)).sum(),
            encoded_bytes: self.encode().len() as u64,
            memory_bytes: self.memory_bytes() as u64,
        }
    }
}
