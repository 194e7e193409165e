//! Storage of groups: distinct sets of triangles, each as bits or as a list, whichever is smaller.

use crate::geometry::cluster::CLUSTER;
use std::collections::HashMap;
use std::hash::{BuildHasher, RandomState};

/// A set of triangles: the faces of collision for a direction.
#[derive(Clone, Copy, Debug)]
pub struct Group<'t> {
    /// One bit per triangle if the length is [`bits_len`]; otherwise an ascending list of indices of [`index_width`]
    /// bytes.
    bytes: &'t [u8],
    triangles: u32,
}

/// The size in bytes of a set stored as bits.
pub(super) fn bits_len(triangles: u32) -> usize {
    triangles.div_ceil(8) as usize
}

/// The number of bytes that can hold any index below `triangles`.
pub(super) fn index_width(triangles: u32) -> usize {
    match triangles {
        0..=0x100 => 1,
        0x101..=0x1_0000 => 2,
        _ => 4,
    }
}

/// Whether a set of `len` triangles is stored as a list. It is a list only if that is shorter than the bits, so the
/// length in bytes tells the two forms apart.
pub(super) fn is_list(len: usize, triangles: u32) -> bool {
    len.saturating_mul(index_width(triangles)) < bits_len(triangles)
}

fn read_index(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |index, &b| index << 8 | u32::from(b))
}

impl<'t> Group<'t> {
    pub(super) fn new(bytes: &'t [u8], triangles: u32) -> Self {
        Self { bytes, triangles }
    }

    /// The stored form.
    pub(super) fn bytes(&self) -> &'t [u8] {
        self.bytes
    }

    pub(super) fn is_bits(&self) -> bool {
        self.bytes.len() == bits_len(self.triangles)
    }

    /// The number of triangles in the set.
    pub fn len(&self) -> usize {
        if self.is_bits() {
            self.bytes.iter().map(|b| b.count_ones() as usize).sum()
        } else {
            self.bytes.len() / index_width(self.triangles)
        }
    }

    /// Whether the set is empty.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// Whether triangle `t` is in the set.
    pub fn contains(&self, t: u32) -> bool {
        if t >= self.triangles {
            false
        } else if self.is_bits() {
            self.bytes[t as usize / 8] >> (t % 8) & 1 == 1
        } else {
            let width = index_width(self.triangles);
            let (mut low, mut high) = (0, self.bytes.len() / width);
            while low < high {
                let middle = (low + high) / 2;
                match read_index(&self.bytes[middle * width..][..width]).cmp(&t) {
                    std::cmp::Ordering::Less => low = middle + 1,
                    std::cmp::Ordering::Equal => return true,
                    std::cmp::Ordering::Greater => high = middle,
                }
            }
            false
        }
    }

    /// The set as one bit per triangle, eight to a byte, with the lowest triangle in the lowest bit. The triangles of a
    /// baked mesh are in cluster order, so byte `c` is the lane mask of cluster `c`.
    ///
    /// Uses `scratch` only if the set is stored as a list.
    pub fn lane_masks<'a>(self, scratch: &'a mut Vec<u8>) -> &'a [u8]
    where
        't: 'a,
    {
        const { assert!(CLUSTER == 8, "a byte has eight bits") };
        if self.is_bits() {
            return self.bytes;
        }
        scratch.clear();
        scratch.resize(bits_len(self.triangles), 0);
        for t in self {
            scratch[t as usize / CLUSTER] |= 1 << (t as usize % CLUSTER);
        }
        scratch
    }

    /// The triangles in ascending order.
    pub fn iter(&self) -> GroupIter<'t> {
        GroupIter {
            rest: self.bytes,
            width: if self.is_bits() { 0 } else { index_width(self.triangles) },
            word: 0,
            base: 0,
        }
    }
}

impl<'t> IntoIterator for Group<'t> {
    type Item = u32;
    type IntoIter = GroupIter<'t>;
    fn into_iter(self) -> GroupIter<'t> {
        self.iter()
    }
}

impl PartialEq for Group<'_> {
    /// Whether both sets contain the same triangles. The groups may belong to different tables.
    fn eq(&self, other: &Self) -> bool {
        if self.triangles == other.triangles {
            self.bytes == other.bytes
        } else {
            self.iter().eq(other.iter())
        }
    }
}

/// Iterates over the triangles of a [`Group`] in ascending order.
#[derive(Clone, Debug)]
pub struct GroupIter<'t> {
    rest: &'t [u8],
    /// Bytes per index, or 0 for bits.
    width: usize,
    word: u64,
    /// One past the last triangle of `word`.
    base: u32,
}

impl Iterator for GroupIter<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.width > 0 {
            let (index, rest) = self.rest.split_at_checked(self.width)?;
            self.rest = rest;
            return Some(read_index(index));
        }
        while self.word == 0 {
            if let Some((word, rest)) = self.rest.split_first_chunk::<8>() {
                self.word = u64::from_le_bytes(*word);
                self.rest = rest;
            } else if self.rest.is_empty() {
                return None;
            } else {
                let mut word = [0; 8];
                word[..self.rest.len()].copy_from_slice(self.rest);
                self.word = u64::from_le_bytes(word);
                self.rest = &[];
            }
            self.base += 64;
        }
        let bit = self.word.trailing_zeros();
        self.word &= self.word - 1;
        Some(self.base - 64 + bit)
    }
}

/// Appends the stored form of a set given as bits. Bits from `triangles` on must be 0.
pub(super) fn pack_bits(words: &[u64], triangles: u32, out: &mut Vec<u8>) {
    let len = words.iter().map(|w| w.count_ones() as usize).sum();
    if is_list(len, triangles) {
        let width = index_width(triangles);
        for (i, &word) in words.iter().enumerate() {
            let mut word = word;
            while word != 0 {
                let t = 64 * i as u32 + word.trailing_zeros();
                out.extend_from_slice(&t.to_le_bytes()[..width]);
                word &= word - 1;
            }
        }
    } else {
        let end = out.len() + bits_len(triangles);
        out.extend(words.iter().flat_map(|w| w.to_le_bytes()));
        out.truncate(end);
    }
}

/// Appends the stored form of a set given as an ascending list.
pub(super) fn pack_list(list: &[u32], triangles: u32, out: &mut Vec<u8>) {
    if is_list(list.len(), triangles) {
        match index_width(triangles) {
            1 => out.extend(list.iter().map(|&t| t as u8)),
            2 => out.extend(list.iter().flat_map(|&t| (t as u16).to_le_bytes())),
            _ => out.extend(list.iter().flat_map(|t| t.to_le_bytes())),
        }
    } else {
        let start = out.len();
        out.resize(start + bits_len(triangles), 0);
        for &t in list {
            out[start + t as usize / 8] |= 1 << (t % 8);
        }
    }
}

/// Distinct groups, numbered in the order in which they were added.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct GroupStore {
    /// The end of each group in `data`.
    ends: Vec<u64>,
    data: Vec<u8>,
}

impl GroupStore {
    /// An empty store with exactly this capacity, in groups and in bytes; `None` if the allocation fails.
    pub fn with_capacity(groups: usize, bytes: u64) -> Option<Self> {
        let mut store = Self::default();
        store.ends.try_reserve_exact(groups).ok()?;
        store.data.try_reserve_exact(usize::try_from(bytes).ok()?).ok()?;
        Some(store)
    }

    /// Adds a group without a search for an equal one, and returns its number; `None` if the capacity is exhausted.
    pub fn push_within_capacity(&mut self, bytes: &[u8]) -> Option<u32> {
        if self.ends.len() == self.ends.capacity() || bytes.len() > self.data.capacity() - self.data.len() {
            return None;
        }
        self.data.extend_from_slice(bytes);
        self.ends.push(self.data.len() as u64);
        Some(self.ends.len() as u32 - 1)
    }

    /// The size of all groups together, in bytes.
    pub fn data_bytes(&self) -> usize {
        self.data.len()
    }

    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// The stored form of group `id`.
    pub fn bytes(&self, id: u32) -> &[u8] {
        let id = id as usize;
        let start = if id == 0 { 0 } else { self.ends[id - 1] };
        &self.data[start as usize..self.ends[id] as usize]
    }

    pub fn memory_bytes(&self) -> usize {
        self.ends.capacity() * size_of::<u64>() + self.data.capacity()
    }
}

/// Builds a [`GroupStore`] without duplicates.
pub(super) struct Interner {
    store: GroupStore,
    hasher: RandomState,
    /// The group added last for each hash.
    last: HashMap<u64, u32>,
    /// For each group, the previous group with the same hash, or `u32::MAX`.
    before: Vec<u32>,
}

impl Interner {
    pub fn new() -> Self {
        Self {
            store: GroupStore::default(),
            hasher: RandomState::new(),
            last: HashMap::new(),
            before: Vec::new(),
        }
    }

    /// The number of the group with this stored form; adds it if it is new.
    pub fn intern(&mut self, bytes: &[u8]) -> u32 {
        let hash = self.hasher.hash_one(bytes);
        let mut candidate = self.last.get(&hash).copied();
        while let Some(id) = candidate {
            if self.store.bytes(id) == bytes {
                return id;
            }
            let before = self.before[id as usize];
            candidate = (before != u32::MAX).then_some(before);
        }
        let id = self.store.len() as u32;
        self.before.push(self.last.insert(hash, id).unwrap_or(u32::MAX));
        self.store.data.extend_from_slice(bytes);
        self.store.ends.push(self.store.data.len() as u64);
        id
    }

    pub fn finish(self) -> GroupStore {
        let mut store = self.store;
        store.ends.shrink_to_fit();
        store.data.shrink_to_fit();
        store
    }
}
