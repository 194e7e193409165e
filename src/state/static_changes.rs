//! Which static colliders have changed, where the others have not.

use super::revision::Revision;

/// With more changed ones than this, all are searched by one structure again.
#[cfg(feature = "bevy")]
const MAX_LOOSE: usize = 512;

/// Changes of a few static colliders.
#[derive(Clone, Debug, Default)]
pub(crate) struct StaticChanges {
    /// The state before the present one, and the colliders that have changed since then.
    before: Revision,
    changed: Vec<u32>,
    /// An earlier state, and all colliders that have changed since then, ascending.
    pub base: Revision,
    pub loose: Vec<u32>,
}

impl StaticChanges {
    /// Begins with the present state, in which nothing has changed.
    #[cfg(feature = "bevy")]
    pub fn begin(&mut self, now: Revision) {
        self.changed.clear();
        self.loose.clear();
        (self.before, self.base) = (Revision::UNKNOWN, now);
    }

    /// Notes that these colliders have changed since the state `before`, and that the present one is `now`.
    #[cfg(feature = "bevy")]
    pub fn add(&mut self, changed: &[u32], before: Revision, now: Revision) {
        self.changed.clear();
        self.changed.extend_from_slice(changed);
        self.changed.sort_unstable();
        self.changed.dedup();
        self.before = before;
        self.loose.extend_from_slice(changed);
        self.loose.sort_unstable();
        self.loose.dedup();
        if self.loose.len() > MAX_LOOSE {
            self.loose.clear();
            self.base = now;
        }
    }

    /// Whether a collider has changed since the base.
    pub fn is_loose(&self, i: u32) -> bool {
        self.loose.binary_search(&i).is_ok()
    }

    /// The colliders that have changed between the states `known` and `now`, if that is known.
    pub fn since(&self, known: Revision, now: Revision) -> Option<&[u32]> {
        if known.is(now) {
            Some(&[])
        } else {
            known.is(self.before).then_some(&self.changed)
        }
    }
}

#[cfg(test)]
#[cfg(feature = "bevy")]
mod tests {
    use super::*;

    #[test]
    fn changes_are_known_since_the_state_before() {
        let states = [(); 4].map(|()| Revision::new());
        let mut own = StaticChanges::default();
        own.begin(states[0]);
        own.add(&[7, 3, 7], states[0], states[1]);
        own.add(&[5], states[1], states[2]);
        let since = |known: Revision| own.since(known, states[2]);
        assert_eq!(since(states[2]), Some(&[][..]));
        assert_eq!(since(states[1]), Some(&[5][..]));
        assert_eq!(since(states[0]), None);
        assert_eq!((&own.loose[..], own.base.is(states[0])), (&[3, 5, 7][..], true));
        let many: Vec<u32> = (0..=MAX_LOOSE as u32).collect();
        own.add(&many, states[2], states[3]);
        assert!(own.loose.is_empty() && own.base.is(states[3]));
    }
}
