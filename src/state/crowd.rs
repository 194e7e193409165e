//! Crowds: bodies that overlap so many others that a step leaves some of their pairs out.

/// The bodies whose pairs a step left out in part, to stay within its [`StepLimits`](crate::types::limits::StepLimits).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crowd {
    /// Number of these bodies; the largest number in any collision substep.
    pub bodies: usize,
    /// The index of one of them.
    pub example: u32,
}

impl Crowd {
    /// The crowd of all bodies in `crowded`, which names some of them several times.
    pub(crate) fn of(mut crowded: Vec<u32>) -> Self {
        crowded.sort_unstable();
        crowded.dedup();
        Self {
            bodies: crowded.len(),
            example: crowded.first().copied().unwrap_or_default(),
        }
    }

    /// The larger one of the two.
    pub(crate) fn or(self, other: Self) -> Self {
        if other.bodies > self.bodies { other } else { self }
    }
}
