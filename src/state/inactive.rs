//! Inactive pairs: nothing about them has changed since the last collision substep, because they sleep or have completed
//! their step. They are not tested again and keep their contact points.

/// In place of the index of a body that no longer exists.
pub(crate) const GONE: u32 = u32::MAX;

/// The bodies that have not changed since the last collision substep. Planes are numbered after the bodies.
#[derive(Default)]
pub(crate) struct InactiveBodies {
    /// For each body, whether nothing about it can have changed.
    pub flags: Vec<bool>,
    /// Whether any body sleeps or has completed its step.
    pub any: bool,
    /// Kinematic bodies that have changed since the last step other than by their velocity: they have another place, shape or
    /// layers. What sleeps on them must wake.
    pub replaced: Vec<u32>,
    /// New index of each body of the last collision substep, or [`GONE`]; empty if all indices are unchanged.
    pub numbers: Vec<u32>,
}

impl InactiveBodies {
    /// Forgets everything: no pair is inactive.
    pub fn clear(&mut self) {
        self.flags.clear();
        self.replaced.clear();
        self.numbers.clear();
        self.any = false;
    }

    /// Whether nothing about a pair can have changed since the last collision substep: neither body can have moved.
    pub fn is_inactive(&self, [a, b]: [u32; 2]) -> bool {
        self.any && self.flags[a as usize] && self.flags[b as usize]
    }

    /// The new indices of a pair of the last collision substep; `None` if a body is gone.
    pub fn renumbered(&self, pair: [u32; 2]) -> Option<[u32; 2]> {
        if self.numbers.is_empty() {
            return Some(pair);
        }
        let pair = pair.map(|i| self.numbers.get(i as usize).copied().unwrap_or(GONE));
        (!pair.contains(&GONE)).then_some(pair)
    }

    /// Bodies that are awake become active.
    pub fn keep_only(&mut self, is_fixed_or_asleep: impl Fn(usize) -> bool) {
        if self.any {
            for (i, flag) in self.flags.iter_mut().enumerate() {
                *flag &= is_fixed_or_asleep(i);
            }
        }
    }

    /// Advances to the next collision substep of the same step, in which bodies keep their indices. What is fixed or has
    /// completed its step becomes inactive.
    pub fn advance(&mut self, has_completed: impl Fn(usize) -> bool, is_fixed: impl Fn(usize) -> bool) {
        self.numbers.clear();
        self.replaced.clear();
        let completed = (0..self.flags.len()).any(|i| has_completed(i) && !is_fixed(i));
        if completed {
            self.any = true;
            for (i, flag) in self.flags.iter_mut().enumerate() {
                *flag |= has_completed(i) || is_fixed(i);
            }
        }
    }
}
