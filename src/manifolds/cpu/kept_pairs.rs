//! What all pairs of a step keep, by their bodies.

use super::kept::Kept;
use std::cmp::Reverse;

/// What each pair of the last call keeps.
#[derive(Default)]
pub struct KeptPairs {
    /// Ascending by bodies.
    pairs: Vec<KeptPair>,
    /// Pairs that will be asked for again later, ascending by bodies.
    waiting: Vec<KeptPair>,
    /// Scratch: pairs of the call before that are still pairs.
    before: Vec<KeptPair>,
    /// Memory of pairs that are gone. New pairs take that with the least number, so that the same memory is used again
    /// and again and soon has its final size.
    free: Vec<KeptPair>,
    /// Number of all pairs, including free ones.
    count: u32,
}

/// A pair with what it keeps.
pub struct KeptPair {
    bodies: [u32; 2],
    number: u32,
    pub kept: Box<Kept>,
}

impl KeptPairs {
    /// What these pairs keep, one for each, in their order. Pairs are ascending. What other pairs keep is dropped,
    /// unless they are to wait.
    pub fn of(
        &mut self,
        pairs: impl Iterator<Item = [u32; 2]> + Clone,
        waits: impl Fn([u32; 2]) -> bool,
    ) -> &mut [KeptPair] {
        if !self.waiting.is_empty() {
            self.pairs.append(&mut self.waiting);
            self.pairs.sort_unstable_by_key(|pair| pair.bodies);
        }
        let mut now = pairs.clone().peekable();
        for mut old in self.pairs.drain(..) {
            while now.next_if(|&bodies| bodies < old.bodies).is_some() {}
            let is_left = now.next_if_eq(&old.bodies).is_some();
            let list = if is_left {
                &mut self.before
            } else if waits(old.bodies) {
                &mut self.waiting
            } else {
                old.kept.forget();
                &mut self.free
            };
            list.push(old);
        }
        self.free.sort_unstable_by_key(|free| Reverse(free.number));
        let mut before = self.before.drain(..).peekable();
        for bodies in pairs {
            let same = before.next_if(|old| old.bodies == bodies);
            let or_free = same.or_else(|| {
                let mut free = self.free.pop()?;
                free.bodies = bodies;
                Some(free)
            });
            self.pairs.push(or_free.unwrap_or_else(|| {
                self.count += 1;
                KeptPair {
                    bodies,
                    number: self.count,
                    kept: Box::default(),
                }
            }));
        }
        &mut self.pairs
    }

    /// What the pair of these bodies keeps.
    pub fn get(&self, bodies: [u32; 2]) -> Option<&Kept> {
        [&self.pairs, &self.waiting].into_iter().find_map(|pairs| {
            let i = pairs.binary_search_by_key(&bodies, |pair| pair.bodies).ok()?;
            Some(&*pairs[i].kept)
        })
    }

    /// Returns the memory of pairs that are gone.
    pub fn shrink(&mut self) {
        self.free = Vec::new();
    }

    /// Whether any pair is so large that it is worth more than one thread.
    pub fn has_large_pair(&self) -> bool {
        self.pairs.iter().any(|pair| pair.kept.is_large())
    }

    /// Gives pairs their new bodies. Pairs without new bodies are dropped.
    pub fn renumber(&mut self, renumbered: impl Fn([u32; 2]) -> Option<[u32; 2]>) {
        self.pairs.append(&mut self.waiting);
        self.pairs.sort_unstable_by_key(|pair| pair.bodies);
        let mut left = 0;
        for i in 0..self.pairs.len() {
            if let Some(bodies) = renumbered(self.pairs[i].bodies) {
                self.pairs[i].bodies = bodies;
                self.pairs.swap(left, i);
                left += 1;
            }
        }
        self.free.extend(self.pairs.drain(left..).map(|mut pair| {
            pair.kept.forget();
            pair
        }));
    }
}
