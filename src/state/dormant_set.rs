//! Which colliders are dormant.

use super::bodies::Flags;
use super::revision::Revision;

/// Colliders asleep near which nothing is awake. A step does nothing for them.
#[derive(Clone, Debug, Default)]
pub(crate) struct DormantSet {
    /// For each collider; empty if there are none.
    pub flags: Vec<bool>,
    pub count: usize,
    /// Names the set.
    pub name: Revision,
    /// Names the largest set of which it is a part: some of those may have been roused since.
    pub filled: Revision,
    /// What some of them have.
    pub has: Flags,
}

impl DormantSet {
    /// Whether a collider is dormant.
    pub fn has(&self, i: usize) -> bool {
        self.count > 0 && self.flags.get(i) == Some(&true)
    }
}
