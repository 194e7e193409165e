//! The file format of a [`FaceTable`], and its writer. [`decode`](super::decode) is the reader.
//!
//! As in Aly & Elawady 2010 the groups are stored in the order of the directions, with run-length encoding. A group
//! that occurred earlier is a back reference, so that the reader need not search for equal groups. A new group is
//! written in the shortest of three encodings: as bits, as a list, or as the list of triangles in which it differs from
//! the previous group. That list is short, because one angular step shows or hides only a few triangles.
//!
//! All numbers are LEB128. The header is the number of triangles, the angular step, the number of distinct groups, and
//! the bytes that all groups together take in memory. Each run starts with `(length - 1) * 4 + encoding`, followed by
//! one of:
//!
//! | encoding | content |
//! |---|---|
//! | [`BITS`] | one bit per triangle: `triangles / 8` bytes, rounded up |
//! | [`LIST`] | the number of triangles; the first; for each other, the difference from the one before, less 1 |
//! | [`DIFFERENCE`] | a list as above: the triangles that are in exactly one of this group and the previous one |
//! | [`KNOWN`] | a back reference: the number of new groups since the one meant; 0 is the latest |
//!
//! With differences a short input can describe a large table, so the writer and the reader limit them: see
//! [`affordable`].

use super::FaceTable;
use super::groups::bits_len;

pub(super) const BITS: u64 = 0;
pub(super) const LIST: u64 = 1;
pub(super) const DIFFERENCE: u64 = 2;
pub(super) const KNOWN: u64 = 3;

/// The maximum size in memory, in bytes, of a table whose file form has `input` bytes: 64 per byte, plus 1 MiB.
///
/// The writer falls back to bits or a list where a difference would exceed this. The reader rejects any table that
/// exceeds it, so no input causes an allocation out of proportion to its length.
pub(super) fn affordable(input: usize) -> u64 {
    input as u64 * 64 + (1 << 20)
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

/// Writes to `out` the triangles that are in exactly one of two ascending lists.
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
    /// The table in its file format. Equal tables give equal bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut out = Vec::new();
        write_number(u64::from(self.triangles), &mut out);
        write_number(u64::from(self.grid.step()), &mut out);
        write_number(self.distinct_len() as u64, &mut out);
        write_number(self.store.data_bytes() as u64, &mut out);
        // The number of groups written so far, and their size in memory.
        let (mut next, mut used) = (0, 0);
        let (mut previous, mut group) = (Vec::new(), Vec::new());
        let (mut changes, mut payload, mut list) = (Vec::new(), Vec::new(), Vec::new());
        let mut known = None;
        for (id, count) in self.runs() {
            // Groups are numbered in the order of the directions.
            if id < next {
                write_number(u64::from(count - 1) * 4 + KNOWN, &mut out);
                write_number(u64::from(next - 1 - id), &mut out);
                known = Some(id);
                continue;
            }
            next += 1;
            if let Some(id) = known.take() {
                previous.clear();
                previous.extend(self.distinct(id));
            }
            group.clear();
            group.extend(self.distinct(id));
            let stored = self.store.bytes(id).len();
            difference(&previous, &group, &mut changes);

            payload.clear();
            write_list(&changes, &mut payload);
            let mut encoding = DIFFERENCE;
            // The shortest run header is one byte.
            used += stored as u64;
            let affordable = used <= affordable(out.len() + 1 + payload.len());
            list.clear();
            write_list(&group, &mut list);
            if list.len() < payload.len() || !affordable {
                std::mem::swap(&mut payload, &mut list);
                encoding = LIST;
            }
            let bits = bits_len(self.triangles);
            if bits < payload.len() {
                payload.clear();
                payload.resize(bits, 0);
                for &t in &group {
                    payload[t as usize / 8] |= 1 << (t % 8);
                }
                encoding = BITS;
            }
            write_number(u64::from(count - 1) * 4 + encoding, &mut out);
            out.extend_from_slice(&payload);
            std::mem::swap(&mut previous, &mut group);
        }
        out
    }
}
