//! The reader for the file format of a [`FaceTable`], which [`codec`](super::codec) describes.
//!
//! A table has tens of thousands of groups, each only a few triangles different from the previous one. The reader keeps
//! one current group in its stored form and changes it in place. Each group is copied once, into memory that was
//! allocated once from the sizes in the header.

use super::codec::{BITS, DIFFERENCE, KNOWN, LIST, affordable};
use super::groups::{Group, GroupStore, bits_len, is_list, pack_list};
use super::{BakeSettings, FaceTable, faces::TableError};
use crate::geometry::direction::DirectionGrid;

impl FaceTable {
    /// Reads the bytes of [`FaceTable::encode`] for a mesh of `triangles` triangles, baked with `settings`.
    ///
    /// Safe for untrusted input: all indices are checked, and memory is at most 64 times the length of the input plus a
    /// constant. The content of the groups is not checked against the mesh.
    ///
    /// # Errors
    ///
    /// If the bytes are not a valid table, or do not match `triangles` or `settings`.
    pub fn decode(bytes: &[u8], triangles: u32, settings: &BakeSettings) -> Result<Self, TableError> {
        let grid = DirectionGrid::new(settings.degrees).ok_or(TableError::Damaged("its settings are out of range"))?;
        let mut reader = Reader { rest: bytes };
        if reader.number()? != u64::from(triangles) {
            return Err(TableError::Damaged("it belongs to a mesh of another size"));
        }
        if reader.number()? != u64::from(grid.step()) {
            return Err(TableError::Damaged("it was baked with another angular step"));
        }
        let groups = reader.number()?;
        let memory = reader.number()?;
        // Each group takes at least one byte.
        if groups > u64::from(grid.len()) || groups > reader.rest.len() as u64 {
            return Err(TableError::Damaged("it has too many groups"));
        }
        if memory > affordable(bytes.len()) {
            return Err(TableError::Damaged("it claims more memory than its length allows"));
        }
        let mut store = GroupStore::with_capacity(groups as usize, memory)
            .ok_or(TableError::Damaged("there is not enough memory for it"))?;
        let mut current = Current::new(triangles);
        let mut directions = Vec::with_capacity(grid.len() as usize);
        let mut left = grid.len();
        while left > 0 {
            let head = reader.number()?;
            let count = head / 4 + 1;
            if count > u64::from(left) {
                return Err(TableError::Damaged("it has too many directions"));
            }
            left -= count as u32;
            let id = if head % 4 == KNOWN {
                let back = reader.number()?;
                let id = (store.len() as u64)
                    .checked_sub(1)
                    .and_then(|last| last.checked_sub(back));
                let id = id.ok_or(TableError::Damaged("a run refers to a group that does not exist yet"))? as u32;
                current.known = Some(id);
                id
            } else {
                match head % 4 {
                    BITS => current.read_bits(&mut reader)?,
                    LIST => current.read_list(&mut reader)?,
                    _ => {
                        const { assert!(DIFFERENCE == 2) };
                        current.fetch(&store);
                        current.read_difference(&mut reader)?;
                    }
                }
                current.known = None;
                current.store(&mut store).ok_or(TableError::Damaged(
                    "its groups do not match the number and size in its header",
                ))?
            };
            directions.extend(std::iter::repeat_n(id, count as usize));
        }
        if !reader.rest.is_empty() {
            return Err(TableError::Damaged("there are bytes after its end"));
        }
        if store.len() as u64 != groups || store.data_bytes() as u64 != memory {
            return Err(TableError::Damaged(
                "its groups do not match the number and size in its header",
            ));
        }
        Ok(Self {
            grid,
            triangles,
            directions,
            store,
        })
    }
}

/// The current group in its stored form: bits, or a list if that is shorter.
struct Current {
    triangles: u32,
    /// The number of a known group that has not been copied here yet. Most are never copied: a back reference to a
    /// large group takes two bytes, and so must not cost a copy.
    known: Option<u32>,
    list: bool,
    /// Valid if `list` is false.
    bits: Vec<u8>,
    /// The number of set bits in `bits`.
    count: usize,
    /// Ascending; valid if `list` is true.
    indices: Vec<u32>,
    /// Scratch memory.
    changes: Vec<u32>,
    previous: Vec<u32>,
    packed: Vec<u8>,
}

impl Current {
    /// The empty group. Memory for bits is allocated only when there are some, because the number of triangles may be
    /// wrong.
    fn new(triangles: u32) -> Self {
        Self {
            triangles,
            known: None,
            list: is_list(0, triangles),
            bits: Vec::new(),
            count: 0,
            indices: Vec::new(),
            changes: Vec::new(),
            previous: Vec::new(),
            packed: Vec::new(),
        }
    }

    /// Copies the known group, if there is one.
    fn fetch(&mut self, store: &GroupStore) {
        let Some(id) = self.known.take() else { return };
        let group = Group::new(store.bytes(id), self.triangles);
        self.list = !group.is_bits();
        if self.list {
            self.indices.clear();
            self.indices.extend(group);
        } else {
            self.count = group.len();
            self.bits.clear();
            self.bits.extend_from_slice(group.bytes());
        }
    }

    fn read_bits(&mut self, reader: &mut Reader) -> Result<(), TableError> {
        let bits = reader.take(bits_len(self.triangles))?;
        let used = self.triangles % 8;
        if used > 0 && bits.last().is_some_and(|last| last >> used != 0) {
            return Err(TableError::Damaged("a bit is set beyond the last triangle"));
        }
        self.bits.clear();
        self.bits.extend_from_slice(bits);
        self.count = bits.iter().map(|b| b.count_ones() as usize).sum();
        self.list = false;
        self.choose_form();
        Ok(())
    }

    fn read_list(&mut self, reader: &mut Reader) -> Result<(), TableError> {
        self.indices.clear();
        let indices = &mut self.indices;
        reader.list(self.triangles, |t| indices.push(t))?;
        self.list = true;
        self.choose_form();
        Ok(())
    }

    fn read_difference(&mut self, reader: &mut Reader) -> Result<(), TableError> {
        if self.list {
            self.changes.clear();
            let changes = &mut self.changes;
            reader.list(self.triangles, |t| changes.push(t))?;
            std::mem::swap(&mut self.indices, &mut self.previous);
            apply(&self.previous, &self.changes, &mut self.indices);
        } else {
            let bits = &mut self.bits[..];
            let mut count = self.count as isize;
            reader.list(self.triangles, |t| {
                let (byte, mask) = (&mut bits[t as usize / 8], 1 << (t % 8));
                *byte ^= mask;
                count += if *byte & mask == 0 { -1 } else { 1 };
            })?;
            self.count = count as usize;
        }
        self.choose_form();
        Ok(())
    }

    /// Converts the group to the form in which it is stored.
    ///
    /// The cost is bounded by the size of the previous group or of the input: bits become a list only if they were read
    /// or stored as bits, and a list becomes bits only if it is not shorter.
    fn choose_form(&mut self) {
        if self.list && !is_list(self.indices.len(), self.triangles) {
            self.bits.clear();
            pack_list(&self.indices, self.triangles, &mut self.bits);
            self.count = self.indices.len();
            self.list = false;
        } else if !self.list && is_list(self.count, self.triangles) {
            self.indices.clear();
            self.indices.extend(Group::new(&self.bits, self.triangles));
            self.list = true;
        }
    }

    /// Stores the group and returns its number; `None` if it exceeds the allocated number or size of groups.
    fn store(&mut self, store: &mut GroupStore) -> Option<u32> {
        if self.list {
            self.packed.clear();
            pack_list(&self.indices, self.triangles, &mut self.packed);
            store.push_within_capacity(&self.packed)
        } else {
            store.push_within_capacity(&self.bits)
        }
    }
}

/// Writes to `out` the symmetric difference of `previous` and `changes`; all lists are ascending. Runs between changes
/// are copied as a whole.
fn apply(previous: &[u32], changes: &[u32], out: &mut Vec<u32>) {
    out.clear();
    let mut rest = previous;
    for &t in changes {
        let (keep, after) = rest.split_at(rest.partition_point(|&p| p < t));
        out.extend_from_slice(keep);
        rest = match after.first() {
            Some(&p) if p == t => &after[1..],
            _ => {
                out.push(t);
                after
            }
        };
    }
    out.extend_from_slice(rest);
}

/// The rest of the input.
struct Reader<'b> {
    rest: &'b [u8],
}

impl<'b> Reader<'b> {
    fn take(&mut self, len: usize) -> Result<&'b [u8], TableError> {
        let (taken, rest) = self
            .rest
            .split_at_checked(len)
            .ok_or(TableError::Damaged("it ends too early"))?;
        self.rest = rest;
        Ok(taken)
    }

    /// Reads a number. Nearly all numbers have one byte.
    #[inline]
    fn number(&mut self) -> Result<u64, TableError> {
        match self.rest {
            [byte @ ..0x80, rest @ ..] => {
                self.rest = rest;
                Ok(u64::from(*byte))
            }
            _ => self.long_number(),
        }
    }

    #[cold]
    fn long_number(&mut self) -> Result<u64, TableError> {
        let mut n = 0;
        for shift in (0..63).step_by(7) {
            let byte = self.take(1)?[0];
            n |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(n);
            }
        }
        Err(TableError::Damaged("a number is too long"))
    }

    /// Reads a list and calls `each` with its triangles, which are ascending and below `triangles`.
    #[inline]
    fn list(&mut self, triangles: u32, mut each: impl FnMut(u32)) -> Result<(), TableError> {
        let len = self.number()?;
        // Each index takes at least one byte, so this bounds the memory as well.
        if len > self.rest.len() as u64 {
            return Err(TableError::Damaged("it ends too early"));
        }
        let mut next = 0;
        for _ in 0..len {
            // A number has at most 63 bits and `next` 32: this cannot overflow.
            let t = self.number()? + next;
            if t >= u64::from(triangles) {
                return Err(TableError::Damaged("a triangle index is out of range"));
            }
            each(t as u32);
            next = t + 1;
        }
        Ok(())
    }
}
