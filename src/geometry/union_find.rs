//! Union-find: sets of numbers, joined pair by pair.

/// Disjoint sets of the numbers from 0. The smallest member of a set is its root, so the root does not depend on the
/// order in which sets were joined.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnionFind {
    parents: Vec<u32>,
}

impl UnionFind {
    /// `count` sets of one number each.
    pub fn new(count: usize) -> Self {
        let mut sets = Self::default();
        sets.reset(count);
        sets
    }

    /// Makes `count` sets of one number each, and reuses the memory.
    pub fn reset(&mut self, count: usize) {
        self.parents.clear();
        self.parents.extend(0..count as u32);
    }

    /// Makes sets of one number each of these `members`, which are below `count`. No others may be asked for.
    pub fn reset_members(&mut self, count: usize, members: impl Iterator<Item = usize>) {
        self.parents.resize(count, 0);
        members.for_each(|i| self.parents[i] = i as u32);
    }

    /// Joins the sets of two numbers.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// The root of the set of `i`.
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            // Halves the path for the next search.
            let grandparent = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }
}
