//! Inactive pairs: nothing about them has changed since the last collision substep, because their bodies sleep or have
//! completed their step. Such pairs are not tested again and keep their contact points.

/// In place of the index of a body that no longer exists.
pub(crate) const GONE: u32 = u32::MAX;

/// The bodies that have not changed since the last collision substep. Planes are numbered after the bodies.
#[derive(Default)]
pub(crate) struct InactiveBodies {
    /// For each body, whether nothing about it can have changed.
    pub flags: Vec<bool>,
    /// Whether any body sleeps or has completed its step.
    pub any: bool,
    /// Kinematic bodies whose pose, shape or layers have changed since the last step other than by their velocity.
    /// Bodies that sleep on them must wake.
    pub replaced: Vec<u32>,
    /// New index of each body of the last collision substep from `same` on, or [`GONE`]; empty if all indices are
    /// unchanged.
    numbers: Vec<u32>,
    /// The first bodies, whose indices are unchanged.
    same: usize,
    /// Whether static bodies or planes may be active.
    has_active_static: bool,
}

impl InactiveBodies {
    /// Forgets everything: no pair is inactive.
    pub fn clear(&mut self) {
        self.flags.clear();
        self.replaced.clear();
        self.numbers.clear();
        self.any = false;
    }

    /// Prepares for a step of `count` bodies and planes. The first `same` ones have the numbers of the last step. They
    /// remain inactive unless they are among the `movers`. The others are not inactive yet.
    pub fn begin(&mut self, count: usize, same: usize, movers: impl Iterator<Item = usize>, has_active_static: bool) {
        self.numbers.clear();
        self.replaced.clear();
        self.any = false;
        self.flags.clear();
        self.flags.resize(same, true);
        self.flags.resize(count, false);
        movers.take_while(|&i| i < same).for_each(|i| self.flags[i] = false);
        self.has_active_static = has_active_static;
    }

    /// Sets whether planes, which are numbered from `first_plane` on, are unchanged since the last step.
    pub fn set_planes(&mut self, first_plane: usize, are_same: bool) {
        self.flags[first_plane..].fill(are_same);
        self.has_active_static |= !are_same;
    }

    /// Sets the new indices of the bodies of the last collision substep from index `same` on; none if all are
    /// unchanged.
    pub fn set_numbers(&mut self, same: usize, numbers: Vec<u32>) {
        (self.same, self.numbers) = (same, numbers);
    }

    /// Whether all indices are unchanged.
    pub fn has_same_numbers(&self) -> bool {
        self.numbers.is_empty()
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
        let pair = pair.map(|i| match (i as usize).checked_sub(self.same) {
            None => i,
            Some(at) => self.numbers.get(at).copied().unwrap_or(GONE),
        });
        (!pair.contains(&GONE)).then_some(pair)
    }

    /// Makes `movers` that are awake active. `movers` are all bodies that are not static.
    pub fn keep_only(&mut self, movers: impl Iterator<Item = usize>, is_asleep: impl Fn(usize) -> bool) {
        if self.any {
            movers.for_each(|i| self.flags[i] &= is_asleep(i));
        }
    }

    /// Advances to the next collision substep of the same step, in which bodies keep their indices. What is fixed or
    /// has completed its step becomes inactive. `movers` are all bodies that are not static.
    pub fn advance(
        &mut self,
        movers: impl Iterator<Item = usize>,
        has_completed: impl Fn(usize) -> bool,
        is_static: impl Fn(usize) -> bool,
    ) {
        self.numbers.clear();
        self.replaced.clear();
        let mut completed = false;
        for i in movers.filter(|&i| has_completed(i)) {
            completed = true;
            self.flags[i] = true;
        }
        if completed {
            self.any = true;
            if std::mem::take(&mut self.has_active_static) {
                let flags = self.flags.iter_mut().enumerate();
                flags.for_each(|(i, flag)| *flag |= is_static(i));
            }
        }
    }
}
