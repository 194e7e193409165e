//! Saved impulses that come from outside, for example from a file: whether they can be used, and other keys for them.

use super::warm_start::{SavedPair, SavedPoint, WarmStart, sorted};
use crate::state::memory_fault::MemoryFault;

impl WarmStart {
    /// Checks what a step relies on.
    ///
    /// # Errors
    /// The first fault.
    pub(crate) fn check(&self) -> Result<(), MemoryFault> {
        let in_order = |one: &SavedPair, next: &SavedPair| one.keys < next.keys;
        if !self.pairs.is_sorted_by(in_order) || self.pairs.iter().any(|pair| pair.keys[0] >= pair.keys[1]) {
            return Err(MemoryFault::Order("pairs with impulses"));
        }
        for pair in &self.pairs {
            let end = pair.first as usize + pair.count as usize;
            if end > self.points.len() {
                return Err(MemoryFault::Reference("pairs with impulses"));
            }
            let rotations = pair.rotations.iter().all(|rotation| rotation.is_finite());
            let substep = pair.substep.is_finite() && pair.substep > 0.0;
            if !(rotations && substep && pair.separating_direction.is_finite()) {
                return Err(MemoryFault::Number("pairs with impulses"));
            }
        }
        let is_finite = |point: &SavedPoint| {
            let vectors = [point.anchors[0], point.anchors[1], point.normal, point.friction_impulse];
            vectors.iter().all(|vector| vector.is_finite()) && point.normal_impulse.is_finite()
        };
        if self.points.iter().all(is_finite) {
            Ok(())
        } else {
            Err(MemoryFault::Number("impulses"))
        }
    }

    /// Gives colliders other keys. Different colliders keep different keys.
    pub(crate) fn rekey(&mut self, new_key: impl Fn(u64) -> u64) {
        for pair in &mut self.pairs {
            let keys = pair.keys.map(&new_key);
            pair.flipped ^= sorted(keys) != keys;
            pair.keys = sorted(keys);
        }
        self.pairs.sort_unstable_by_key(|pair| (pair.keys, pair.first));
    }
}
