//! The table of faces of collision: which triangles can be seen from each direction.
//!
//! Directions are those of a [`DirectionGrid`]; what is seen is defined in [`raster`](super::raster). Neighbouring
//! directions often see the same triangles, and so do directions far apart, so in memory every distinct group is kept
//! once and each direction holds a group's number. Files keep the run-length form of Aly & Elawady 2010.

pub use super::groups::{Group, GroupIter};

use super::groups::{GroupStore, Interner, index_width};
use crate::geometry::direction::DirectionGrid;
use glam::Vec3;
use thiserror::Error;

/// Why bytes are not a table.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TableError {
    /// The bytes end early or hold impossible values.
    #[error("the face table is damaged: {0}")]
    Damaged(&'static str),
}

/// The deduplicated table in memory.
///
/// Made by [`FaceTable::bake`] or [`FaceTable::decode`]; triangles are indices into
/// [`TriMesh::triangles`](crate::geometry::TriMesh::triangles).
#[derive(Clone, Debug, PartialEq)]
pub struct FaceTable {
    pub(super) grid: DirectionGrid,
    pub(super) triangles: u32,
    /// For each direction of the grid the number of its group.
    pub(super) directions: Vec<u32>,
    pub(super) store: GroupStore,
}

/// Sizes of a table, for people who choose settings.
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
    /// Triangles per direction on average.
    pub mean_visible: f64,
    /// Triangles in the largest group.
    pub max_visible: usize,
    /// Bytes if every direction had its own list of indices, and a 4-byte offset to it.
    pub raw_bytes: u64,
    /// Bytes if every run had its own list of indices and a 4-byte counter, as in Aly & Elawady 2010.
    pub run_length_bytes: u64,
    /// Bytes of [`FaceTable::encode`].
    pub encoded_bytes: u64,
    /// Bytes of this table in memory.
    pub memory_bytes: u64,
}

impl FaceTable {
    /// Collects the groups of a grid's directions, in order.
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

    /// The faces of collision seen against `direction`, in the mesh's own axes; any length but zero.
    ///
    /// The zero vector and NaN get some direction's group. Two bodies whose centres coincide have no direction: use
    /// all triangles there.
    pub fn group(&self, direction: Vec3) -> Group<'_> {
        self.distinct(self.group_id(direction))
    }

    /// The number of [`FaceTable::group`]'s result, for [`FaceTable::distinct`].
    pub fn group_id(&self, direction: Vec3) -> u32 {
        self.directions[self.grid.index_of(direction) as usize]
    }

    /// The group for the angles `a_step` and `b_step`, in steps through the full turn and modulo it: the table as
    /// Aly & Elawady 2010 address it, 360 x 360 at one degree.
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

    /// How many triangles the mesh has.
    pub fn triangles(&self) -> u32 {
        self.triangles
    }

    /// For each direction of [`FaceTable::grid`] the number of its group, below [`FaceTable::distinct_len`].
    pub fn directions(&self) -> &[u32] {
        &self.directions
    }

    /// How many distinct groups there are.
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

    /// Bytes that this table occupies in memory.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.directions.capacity() * size_of::<u32>() + self.store.memory_bytes()
    }

    /// Runs of equal groups in the order of the directions: group number and length.
    pub(super) fn runs(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.directions
            .chunk_by(|a, b| a == b)
            .map(|run| (run[0], run.len() as u32))
    }

    /// Counts and sizes. Encodes the table to know the size in a file, so it takes a while.
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
