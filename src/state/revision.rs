//! Names of states of the static colliders, so that a step does nothing for what has not changed.

use std::num::NonZeroU64;

/// Names a state of all static colliders. Where two are [the same](Revision::is), no static collider has come, gone,
/// moved or changed, and every collider has kept its number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Revision(Option<NonZeroU64>);

impl Revision {
    /// Nothing is known: static colliders may have changed.
    pub const UNKNOWN: Self = Self(None);

    /// The name of a new state.
    pub fn new() -> Self {
        use std::sync::atomic::{AtomicU64, Ordering};
        static LAST: AtomicU64 = AtomicU64::new(0);
        Self(NonZeroU64::new(LAST.fetch_add(1, Ordering::Relaxed) + 1))
    }

    /// Whether both name one state.
    pub fn is(self, other: Self) -> bool {
        self.0.is_some() && self.0 == other.0
    }

    /// Whether it names a state.
    pub fn is_known(self) -> bool {
        self.0.is_some()
    }
}

/// Two memories of steps are equal whatever the name of their state.
impl PartialEq for Revision {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
