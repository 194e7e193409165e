//! [`PartIndex`]: finds the entry of a collider in a list of the colliders of bodies of several.

/// For each collider, its index in such a list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartIndex(Vec<u32>);

/// The index of a collider that is not in the list.
const NONE: u32 = u32::MAX;

impl PartIndex {
    /// Sets the list by the numbers of its colliders.
    pub fn set(&mut self, colliders: impl Iterator<Item = u32>) {
        self.0.clear();
        for (at, collider) in (0..).zip(colliders) {
            let end = collider as usize + 1;
            if self.0.len() < end {
                self.0.resize(end, NONE);
            }
            self.0[collider as usize] = at;
        }
    }

    /// Empties the list.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// The index of a collider.
    pub fn get(&self, collider: u32) -> Option<usize> {
        let at = *self.0.get(collider as usize)?;
        (at != NONE).then_some(at as usize)
    }
}
