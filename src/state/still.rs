//! Pairs of bodies about which nothing has changed since the last collision substep, because they sleep: they need no test,
//! and keep the contact points they had.

/// The number of a body that is gone.
pub(crate) const GONE: u32 = u32::MAX;

/// Which bodies have not changed since the last collision substep. Half-spaces are numbered after the bodies.
#[derive(Default)]
pub(crate) struct StillBodies {
    /// For each body: nothing about it can have changed.
    pub still: Vec<bool>,
    /// Some body sleeps.
    pub has_sleepers: bool,
    /// The number now of each body of the last interval, or [`GONE`]; empty if all have the number they had.
    pub numbers: Vec<u32>,
}

impl StillBodies {
    /// Nothing is known: no pair is still.
    pub fn clear(&mut self) {
        self.still.clear();
        self.numbers.clear();
        self.has_sleepers = false;
    }

    /// Whether nothing about a pair can have changed since the last interval: both sleep, or one does and the other is
    /// fixed.
    pub fn is_still(&self, [a, b]: [u32; 2]) -> bool {
        self.has_sleepers && self.still[a as usize] && self.still[b as usize]
    }

    /// The numbers that a pair of the last interval has now, if it is still there.
    pub fn renumbered(&self, pair: [u32; 2]) -> Option<[u32; 2]> {
        if self.numbers.is_empty() {
            return Some(pair);
        }
        let pair = pair.map(|i| self.numbers.get(i as usize).copied().unwrap_or(GONE));
        (!pair.contains(&GONE)).then_some(pair)
    }

    /// Goes on to the next interval of the same step, in which bodies keep their numbers. Those that woke meanwhile are not still
    /// any more.
    pub fn keep_only(&mut self, is_fixed_or_asleep: impl Fn(usize) -> bool) {
        self.numbers.clear();
        if self.has_sleepers {
            for (i, still) in self.still.iter_mut().enumerate() {
                *still &= is_fixed_or_asleep(i);
            }
        }
    }
}
