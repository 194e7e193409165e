//! What all pairs of a step keep, by their bodies.

use super::kept::Kept;
use crate::manifolds::MarginPair;

/// What each pair of the last call keeps.
#[derive(Default)]
pub struct KeptPairs {
    /// Ascending by bodies.
    pairs: Vec<KeptPair>,
    /// The pairs of the call before.
    before: Vec<KeptPair>,
    /// Memory of pairs that are gone.
    #[allow(clippy::vec_box)]
    free: Vec<Box<Kept>>,
}

/// A pair with what it keeps.
pub struct KeptPair {
    bodies: [u32; 2],
    pub kept: Box<Kept>,
}

impl KeptPairs {
    /// What these pairs keep, one for each, in their order. Pairs are ascending. What other pairs keep is dropped.
    pub fn of(&mut self, pairs: &[MarginPair]) -> &mut [KeptPair] {
        std::mem::swap(&mut self.pairs, &mut self.before);
        let mut before = self.before.drain(..).peekable();
        for pair in pairs {
            while let Some(gone) = before.next_if(|old| old.bodies < pair.bodies) {
                self.free.push(gone.kept);
            }
            let same = before.next_if(|old| old.bodies == pair.bodies);
            let kept = same.map(|old| old.kept).or_else(|| {
                let mut free = self.free.pop()?;
                free.forget();
                Some(free)
            });
            self.pairs.push(KeptPair {
                bodies: pair.bodies,
                kept: kept.unwrap_or_default(),
            });
        }
        self.free.extend(before.map(|gone| gone.kept));
        &mut self.pairs
    }

    /// Gives pairs their new bodies. Those for which there are none are dropped.
    pub fn renumber(&mut self, renumbered: impl Fn([u32; 2]) -> Option<[u32; 2]>) {
        let free = &mut self.free;
        let mut left = 0;
        for i in 0..self.pairs.len() {
            if let Some(bodies) = renumbered(self.pairs[i].bodies) {
                self.pairs[i].bodies = bodies;
                self.pairs.swap(left, i);
                left += 1;
            }
        }
        free.extend(self.pairs.drain(left..).map(|gone| gone.kept));
    }
}
