//! Which colliders are dormant.

use super::bodies::Flags;
use super::revision::Revision;

/// Colliders asleep near which nothing is awake. A step does nothing for them.
#[derive(Clone, Debug, Default)]
pub(crate) struct DormantSet {
    /// Whether each collider is dormant; empty if none is.
    pub flags: Vec<bool>,
    pub count: usize,
    /// Names the set.
    pub name: Revision,
    /// Names the set when bodies last became dormant. Some may have been roused since.
    pub filled: Revision,
    /// Properties that at least one dormant collider has.
    pub has: Flags,
}

impl DormantSet {
    /// Whether a collider is dormant.
    pub fn has(&self, i: usize) -> bool {
        self.count > 0 && self.flags.get(i) == Some(&true)
    }

    /// The dormant colliders, ascending.
    pub fn members(&self) -> impl Iterator<Item = u32> + '_ {
        let flagged = (0..).zip(&self.flags).filter(|(_, flag)| **flag);
        flagged.map(|(i, _)| i)
    }
}
