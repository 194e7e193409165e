//! Reading the file form of a [`FaceTable`], which [`codec`](super::codec) describes.
//!
//! A table has tens of thousands of groups, each a few triangles away from the one before. So there is one group at hand,
//! changes are made to it in place and in the form in which it is stored, and it is copied once, into memory that was
//! allocated once: the header says how much there will be.

use super::codec::{BITS, DIFFERENCE, KNOWN, LIST, affordable};
use super::groups::{Group, GroupStore, bits_len, is_list, pack_list};
use super::{BakeSettings, FaceTable, faces::TableError};
use crate::geometry::direction::DirectionGrid;

impl FaceTable {
    /// Reads [`FaceTable::encode`]'s bytes for a mesh of `triangles` triangles, baked with `settings`.
    ///
    /// Any bytes are safe to read: every index is checked, and memory is bounded by 64 times the length of the input and
    /// a constant. Whether the groups are right for the mesh cannot be seen from them.
    ///
    /// # Errors
    ///
    /// If the bytes are not a table, or that of another mesh or other settings.
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
        // Every group takes a byte at least.
        if groups > u64::from(grid.len()) || groups > reader.rest.len() as u64 {
            return Err(TableError::Damaged("it has too many groups"));
        }
        if memory > affordable(bytes.len()) {
            return Err(TableError::Damaged("it describes more than its length can"));
        }
        let mut store = GroupStore::with_capacity(groups as usize, memory)
            .ok_or(TableError::Damaged("there is no memory for it"))?;
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
                let id = id.ok_or(TableError::Damaged("a run names a group that is not there yet"))? as u32;
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
                    "its groups are not as many and as long as announced",
                ))?
            };
            directions.extend(std::iter::repeat_n(id, count as usize));
        }
        if !reader.rest.is_empty() {
            return Err(TableError::Damaged("bytes are left over"));
        }
        if store.len() as u64 != groups || store.data_bytes() as u64 != memory {
            return Err(TableError::Damaged(
                "its groups are not as many and as long as announced",
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

/// The group at hand, in the form in which it is stored: bits, or a list if that is shorter.
struct Current {
    triangles: u32,
    /// The number of the group, if it is still to be fetched. Most never are: a run that names a large group has two
    /// bytes, which must not make us copy it.
    known: Option<u32>,
    list: bool,
    /// Only of use if `list` is false.
    bits: Vec<u8>,
    /// How many triangles `bits` has.
    count: usize,
    /// Ascending; only of use if `list` is true.
    indices: Vec<u32>,
    /// Reused memory.
    changes: Vec<u32>,
    previous: Vec<u32>,
    packed: Vec<u8>,
}

impl Current {
    /// The empty group. Memory for bits is taken when there are some: the number of triangles may be a lie.
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

    /// Copies the known group, if it is one.
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
            return Err(TableError::Damaged("a bit stands for no triangle"));
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

    /// Goes over to the other form where that is the one to be stored. This takes no more memory or time than the group
    /// that was there, or what was read, justifies: bits become a list only if they were read or stored as bits, and a
    /// list becomes bits only if it is not shorter.
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

    /// Adds the group under a new number; `None` if it is one more, or longer, than what was allocated.
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

/// `previous` with the membership of `changes` turned over; all ascending. Stretches between changes are copied whole.
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

/// What is left to read.
struct Reader<'b> {
    rest: &'b [u8],
}

impl<'b> Reader<'b> {
    fn take(&mut self, len: usize) -> Result<&'b [u8], TableError> {
        let (taken, rest) = self
            .rest
            .split_at_checked(len)
            .ok_or(TableError::Damaged("it ends early"))?;
        self.rest = rest;
        Ok(taken)
    }

    /// Nearly all numbers have one byte.
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

    /// Calls `each` with the triangles of a list, ascending and below `triangles`.
    #[inline]
    fn list(&mut self, triangles: u32, mut each: impl FnMut(u32)) -> Result<(), TableError> {
        let len = self.number()?;
        // Every index takes a byte at least, so this bounds the memory as well.
        if len > self.rest.len() as u64 {
            return Err(TableError::Damaged("it ends early"));
        }
        let mut next = 0;
        for _ in 0..len {
            // A number has at most 63 bits and `next` 32: this cannot overflow.
            let t = self.number()? + next;
            if t >= u64::from(triangles) {
                return Err(TableError::Damaged("an index stands for no triangle"));
            }
            each(t as u32);
            next = t + 1;
        }
        Ok(())
    }
}
