//! The file form of a [`FaceTable`]: what it is, and how it is written. [`decode`](super::decode) reads it.
//!
//! As in Aly & Elawady 2010 the directions are walked in order, and a group that equals the one before only raises a
//! counter. A group that was met before is named by its number, so that a reader need not look for equal ones. A new
//! group is written in the shortest of three ways: as bits, as a list, or as the list of triangles in which it differs
//! from the group before, which is short because one step of an angle shows or hides few of them.
//!
//! All numbers are LEB128. The header is the number of triangles, the angular step, the number of distinct groups and
//! the bytes that they take in memory together. Each run is `counter * 4 + way`, where the counter starts at 0, followed
//! by one of
//!
//! | way | content |
//! |---|---|
//! | [`BITS`] | one bit per triangle: `triangles / 8` bytes, rounded up |
//! | [`LIST`] | a length and that many triangles, the first as it is, the others as the gap to the one before, less 1 |
//! | [`DIFFERENCE`] | a list as above: the triangles that are in this group or in the one before, but not in both |
//! | [`KNOWN`] | how many new groups lie between the group meant and here; 0 for the latest |
//!
//! Differences let a short input describe much memory, so their use is rationed: see [`affordable`].

use super::FaceTable;
use super::groups::bits_len;

pub(super) const BITS: u64 = 0;
pub(super) const LIST: u64 = 1;
pub(super) const DIFFERENCE: u64 = 2;
pub(super) const KNOWN: u64 = 3;

/// How many bytes of memory `input` bytes of a file may describe: 64 for each, and one MiB.
///
/// The writer falls back on bits or a list where a difference would exceed this, so that the reader can refuse whatever
/// does, and no input makes it allocate out of proportion.
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
        write_number(self.distinct_len() as u64, &mut out);
        write_number(self.store.data_bytes() as u64, &mut out);
        // Groups written so far, and the bytes of memory that they take.
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
            let mut way = DIFFERENCE;
            // The shortest head is one byte.
            used += stored as u64;
            let affordable = used <= affordable(out.len() + 1 + payload.len());
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
            std::mem::swap(&mut previous, &mut group);
        }
        out
    }
}
