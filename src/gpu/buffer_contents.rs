//! What the host knows to be in buffers that kernels only read, so that it writes only what has changed.

use std::collections::HashMap;
use std::ops::Range;
use wgpu::Buffer;

/// The contents of buffers that only the host writes, by buffer.
///
/// It keeps its buffers alive: clear it when they are replaced.
#[derive(Debug, Default)]
pub struct BufferContents(HashMap<Buffer, Vec<u8>>);

/// Bytes that are compared at once.
const BLOCK: usize = 256;

/// Changed blocks with at most this many bytes between them are written together, because each write has a cost of its
/// own.
const GAP: usize = 8 << 10;

impl BufferContents {
    /// Notes that a buffer starts with these bytes, and returns the ranges that must be written.
    pub fn change(&mut self, buffer: &Buffer, bytes: &[u8]) -> Vec<Range<usize>> {
        let known = self.0.entry(buffer.clone()).or_default();
        let changed = changed_ranges(known, bytes);
        for range in &changed {
            if range.end > known.len() {
                known.resize(range.end, 0);
            }
            known[range.clone()].copy_from_slice(&bytes[range.clone()]);
        }
        changed
    }

    /// Nothing is known any more.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// The ranges in which `new` differs from the start of `old`, or goes beyond its end. They ascend, and begin and end at
/// multiples of four if the length of `new` is one.
fn changed_ranges(old: &[u8], new: &[u8]) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (number, block) in new.chunks(BLOCK).enumerate() {
        let range = number * BLOCK..number * BLOCK + block.len();
        if old.get(range.clone()) == Some(block) {
            continue;
        }
        match ranges.last_mut() {
            Some(last) if range.start - last.end <= GAP => last.end = range.end,
            _ => ranges.push(range),
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After writing the ranges, the old bytes start with the new ones.
    fn written(old: &[u8], new: &[u8]) -> usize {
        let mut buffer = old.to_vec();
        buffer.resize(old.len().max(new.len()), 99);
        let ranges = changed_ranges(old, new);
        for range in &ranges {
            buffer[range.clone()].copy_from_slice(&new[range.clone()]);
        }
        assert_eq!(&buffer[..new.len()], new);
        assert!(ranges.windows(2).all(|pair| pair[0].end + GAP < pair[1].start));
        ranges.iter().map(Range::len).sum()
    }

    #[test]
    fn only_what_changed_is_written() {
        let old: Vec<u8> = (0..100_000u32).map(|i| i as u8).collect();
        assert_eq!(written(&old, &old), 0);
        assert_eq!(written(&old, &old[..500]), 0, "the rest stays");
        assert_eq!(written(&[], &old), old.len());
        assert_eq!(
            written(&old[..99_000], &old),
            100_000 - 99_000 / BLOCK * BLOCK,
            "from the last whole block on"
        );
        let mut new = old.clone();
        new[50_000] ^= 1;
        assert_eq!(written(&old, &new), BLOCK);
        new[50_000 + GAP] ^= 1;
        assert!((GAP..GAP + 2 * BLOCK + 1).contains(&written(&old, &new)), "one write");
        new[99_999] ^= 1;
        assert!((GAP..GAP + 3 * BLOCK + 1).contains(&written(&old, &new)), "and another");
        assert_eq!(written(&old, &[]), 0);
    }
}
