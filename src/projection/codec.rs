//! The file form of a [`FaceTable`].
//!
//! As in Aly & Elawady 2010 the directions are walked in order, and a group that equals the one before only raises a
//! counter. A new group is written in the shortest of three ways: as bits, as a list, or as the list of triangles in
//! which it differs from the group before, which is short because one step of an angle shows or hides few of them.
//!
//! All numbers are LEB128. The header is the number of triangles and the angular step; each run is
//! `counter * 4 + way`, where the counter starts at 0, followed by the bits (`triangles / 8` bytes, rounded up) or by
//! a length and that many indices, the first as it is, the others as the gap to the one before, less 1.
//!
//! Differences let a short input describe much memory, so their use is rationed: see [`Budget`].

use super::groups::{Interner, bits_len, index_width, is_list, pack_list};
use super::{BakeSettings, FaceTable, faces::TableError};
use crate::geometry::direction::DirectionGrid;

const BITS: u64 = 0;
const LIST: u64 = 1;
const DIFFERENCE: u64 = 2;

/// How much memory the groups read so far may take: 64 bytes per byte of input and one MiB.
///
/// Writer and reader keep the same account. The writer falls back on bits or a list where a difference would exceed the
/// budget, so the reader can refuse whatever exceeds it, and no input makes it allocate out of proportion.
#[derive(Default)]
struct Budget {
    used: u64,
}

impl Budget {
    fn allows(&self, input: usize, group: usize) -> bool {
        self.used + group as u64 <= input as u64 * 64 + (1 << 20)
    }

    fn spend(&mut self, group: usize) {
        self.used += group as u64;
    }
}

/// Bytes of the stored form of `len` triangles.
fn stored_len(len: usize, triangles: u32) -> usize {
    if is_list(len, triangles) {
        len * index_width(triangles)
    } else {
        bits_len(triangles)
    }
}

fn write_number(mut n: u64, out: &mut Vec<u8>) {
    while n >= 0x80 {
        out.push(n as u8 | 0x80);
        n >>= 7;
    }
    out.push(n as u8);
}

fn write_list(list: &[u32], out: &mut Vec<u8>) {
    write_number(list.len() as u64, out);
    let mut next = 0;
    for &t in list {
        write_number(u64::from(t - next), out);
        next = t + 1;
    }
}

/// The triangles that are in one of two ascending lists but not in both.
fn difference(a: &[u32], b: &[u32], out: &mut Vec<u32>) {
    out.clear();
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        match a[i].cmp(&b[j]) {
            std::cmp::Ordering::Less => {
                out.push(a[i]);
                i += 1;
            }
            std::cmp::Ordering::Greater => {
                out.push(b[j]);
                j += 1;
            }
            std::cmp::Ordering::Equal => {
                i += 1;
                j += 1;
            }
        }
    }
    out.extend_from_slice(&a[i..]);
    out.extend_from_slice(&b[j..]);
}

impl FaceTable {
    /// The run-length form for files. Equal tables give equal bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut out = Vec::new();
        write_number(u64::from(self.triangles), &mut out);
        write_number(u64::from(self.grid.step()), &mut out);
        let mut budget = Budget::default();
        let (mut previous, mut group) = (Vec::new(), Vec::new());
        let (mut changes, mut payload, mut list) = (Vec::new(), Vec::new(), Vec::new());
        for (id, count) in self.runs() {
            group.clear();
            group.extend(self.distinct(id));
            let stored = self.store.bytes(id).len();
            difference(&previous, &group, &mut changes);

            payload.clear();
            write_list(&changes, &mut payload);
            let mut way = DIFFERENCE;
            // The shortest head is one byte.
            let affordable = budget.allows(out.len() + 1 + payload.len(), stored);
            list.clear();
            write_list(&group, &mut list);
            if list.len() < payload.len() || !affordable {
                std::mem::swap(&mut payload, &mut list);
                way = LIST;
            }
            let bits = bits_len(self.triangles);
            if bits < payload.len() {
                payload.clear();
                payload.resize(bits, 0);
                for &t in &group {
                    payload[t as usize / 8] |= 1 << (t % 8);
                }
                way = BITS;
            }
            write_number(u64::from(count - 1) * 4 + way, &mut out);
            out.extend_from_slice(&payload);
            budget.spend(stored);
            std::mem::swap(&mut previous, &mut group);
        }
        out
    }

    /// Reads [`FaceTable::encode`]'s bytes for a mesh of `triangles` triangles, baked with `settings`.
    ///
    /// Any bytes are safe to read: every index is checked, and memory is bounded by 64 times the length of the input and
    /// a constant. Whether the groups are right for the mesh cannot be seen from them.
    pub fn decode(bytes: &[u8], triangles: u32, settings: &BakeSettings) -> Result<Self, TableError> {
        let grid = DirectionGrid::new(settings.degrees).ok_or(TableError::Damaged("its settings are out of range"))?;
        let mut reader = Reader { bytes, at: 0 };
        if reader.number()? != u64::from(triangles) {
            return Err(TableError::Damaged("it belongs to a mesh of another size"));
        }
        if reader.number()? != u64::from(grid.step()) {
            return Err(TableError::Damaged("it was baked with another angular step"));
        }
        let mut budget = Budget::default();
        let mut interner = Interner::new();
        let mut runs = Vec::new();
        let (mut group, mut previous, mut changes, mut stored) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut left = grid.len();
        while left > 0 {
            let head = reader.number()?;
            let count = head / 4 + 1;
            if count > u64::from(left) {
                return Err(TableError::Damaged("it has too many directions"));
            }
            left -= count as u32;
            match head % 4 {
                BITS => reader.bits(triangles, &mut group)?,
                LIST => reader.list(triangles, &mut group)?,
                DIFFERENCE => {
                    reader.list(triangles, &mut changes)?;
                    std::mem::swap(&mut group, &mut previous);
                    apply(&previous, &changes, &mut group);
                }
                _ => return Err(TableError::Damaged("a run has an unknown form")),
            }
            let len = stored_len(group.len(), triangles);
            // Bits and lists are at least a quarter as long as what they stand for, so only differences can fail.
            if !budget.allows(reader.at, len) {
                return Err(TableError::Damaged("it describes more than its length can"));
            }
            budget.spend(len);
            stored.clear();
            pack_list(&group, triangles, &mut stored);
            runs.push((interner.intern(&stored), count as u32));
        }
        if reader.at != bytes.len() {
            return Err(TableError::Damaged("bytes are left over"));
        }
        Ok(Self::collect(grid, triangles, runs.into_iter(), interner))
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

struct Reader<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Reader<'b> {
    fn take(&mut self, len: usize) -> Result<&'b [u8], TableError> {
        let taken = self.bytes[self.at..]
            .get(..len)
            .ok_or(TableError::Damaged("it ends early"))?;
        self.at += len;
        Ok(taken)
    }

    fn number(&mut self) -> Result<u64, TableError> {
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

    fn bits(&mut self, triangles: u32, out: &mut Vec<u32>) -> Result<(), TableError> {
        out.clear();
        for (i, &byte) in self.take(bits_len(triangles))?.iter().enumerate() {
            let mut byte = byte;
            while byte != 0 {
                out.push(8 * i as u32 + byte.trailing_zeros());
                byte &= byte - 1;
            }
        }
        if out.last().is_some_and(|&t| t >= triangles) {
            return Err(TableError::Damaged("a bit stands for no triangle"));
        }
        Ok(())
    }

    fn list(&mut self, triangles: u32, out: &mut Vec<u32>) -> Result<(), TableError> {
        out.clear();
        let len = self.number()?;
        // Every index takes a byte at least, so this bounds the memory as well.
        if len > (self.bytes.len() - self.at) as u64 {
            return Err(TableError::Damaged("it ends early"));
        }
        let mut next = 0;
        for _ in 0..len {
            let t = self.number()?.checked_add(next).filter(|&t| t < u64::from(triangles));
            let t = t.ok_or(TableError::Damaged("an index stands for no triangle"))?;
            out.push(t as u32);
            next = t + 1;
        }
        Ok(())
    }
}
