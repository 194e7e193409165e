//! How much of each list is read back.
//!
//! How long a list will be is not known when its copy is recorded. So a step has room for somewhat more than the last
//! steps have used, and not for all that its buffers hold. More results are an overflow like any other: the step is
//! repeated with more room.

use super::buffers::StepCapacity;
use crate::gpu::buffers::{Capacity, grow};
use crate::types::gpu_work::GpuLists;

/// Lengths of the lists that are read back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadbackLengths {
    /// Pairs of bodies whose spheres overlap, and pairs that touch.
    pub pairs: u32,
    /// Pairs of intersecting faces.
    pub hits: u32,
    /// Contacts with planes.
    pub plane_contacts: u32,
    /// Pairs with contact points.
    pub contact_pairs: u32,
    /// Contact points of these pairs.
    pub contact_points: u32,
    /// Points of touching pairs.
    pub touches: u32,
}

impl ReadbackLengths {
    /// For all that buffers hold.
    const ALL: Self = Self {
        pairs: u32::MAX,
        hits: u32::MAX,
        plane_contacts: u32::MAX,
        contact_pairs: u32::MAX,
        contact_points: u32::MAX,
        touches: u32::MAX,
    };

    /// What a step has used.
    pub fn used(lists: &GpuLists) -> Self {
        Self {
            pairs: lists.sphere_pairs.length,
            hits: lists.face_pairs.length,
            plane_contacts: lists.plane_contacts.length,
            contact_pairs: lists.manifolds.length,
            contact_points: lists.contact_points.length,
            touches: lists.touches.length,
        }
    }

    /// What these lists hold.
    pub fn in_buffers(lists: &Capacity, for_contacts: Option<StepCapacity>) -> Self {
        let [contact_pairs, contact_points, touches] =
            for_contacts.map_or([0; 3], |own| [own.contacts.pairs, own.contacts.points, own.touches]);
        Self {
            pairs: lists.pairs,
            hits: lists.hits,
            plane_contacts: lists.plane_contacts,
            contact_pairs,
            contact_points,
            touches,
        }
    }

    /// Whether some list needs more.
    pub fn lacks(&self, needed: Self) -> bool {
        self.with(needed, u32::max) != *self
    }

    /// The smaller of two, list by list.
    pub fn min(self, other: Self) -> Self {
        self.with(other, u32::min)
    }

    fn with(self, other: Self, of_both: impl Fn(u32, u32) -> u32) -> Self {
        Self {
            pairs: of_both(self.pairs, other.pairs),
            hits: of_both(self.hits, other.hits),
            plane_contacts: of_both(self.plane_contacts, other.plane_contacts),
            contact_pairs: of_both(self.contact_pairs, other.contact_pairs),
            contact_points: of_both(self.contact_points, other.contact_points),
            touches: of_both(self.touches, other.touches),
        }
    }
}

/// What the last steps have used.
#[derive(Clone, Copy, Debug)]
pub struct RecentLengths {
    /// The most that a step of this window needed, and of the one before it.
    now: ReadbackLengths,
    before: ReadbackLengths,
    /// Steps in this window.
    steps: u32,
}

/// Steps in a window.
const STEPS: u32 = 16;

impl Default for RecentLengths {
    /// Nothing is known of the first steps.
    fn default() -> Self {
        Self {
            now: ReadbackLengths::default(),
            before: ReadbackLengths::ALL,
            steps: 0,
        }
    }
}

impl RecentLengths {
    /// Adds a step that has used this much.
    pub fn add(&mut self, used: ReadbackLengths) {
        self.raise(used);
        self.steps += 1;
        if self.steps == STEPS {
            *self = Self {
                now: ReadbackLengths::default(),
                before: self.now,
                steps: 0,
            };
        }
    }

    /// A step that is repeated needs this much.
    pub fn raise(&mut self, needed: ReadbackLengths) {
        self.now = self.now.with(needed, u32::max);
    }

    /// The lengths for the next step.
    pub fn for_next(&self) -> ReadbackLengths {
        let most = self.now.with(self.before, u32::max);
        most.with(most, |most, _| grow(0, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pairs: u32) -> ReadbackLengths {
        ReadbackLengths {
            pairs,
            ..ReadbackLengths::default()
        }
    }

    #[test]
    fn room_follows_use() {
        let mut recent = RecentLengths::default();
        for _ in 0..STEPS {
            assert_eq!(recent.for_next(), ReadbackLengths::ALL);
            recent.add(of(100));
        }
        assert_eq!(recent.for_next(), of(0).with(of(100), |_, most| grow(0, most)));
        // More at once.
        recent.raise(of(1000));
        assert_eq!(recent.for_next().pairs, grow(0, 1000));
        // And it lasts for a window at least.
        for _ in 0..STEPS {
            recent.add(of(1));
            assert_eq!(recent.for_next().pairs, grow(0, 1000));
        }
        (0..STEPS).for_each(|_| recent.add(of(1)));
        assert_eq!(recent.for_next().pairs, grow(0, 1));
    }

    #[test]
    fn lists_lack_room_one_by_one() {
        let lengths = ReadbackLengths { hits: 5, ..of(7) };
        assert!(!lengths.lacks(lengths) && !lengths.lacks(of(7)) && !ReadbackLengths::ALL.lacks(lengths));
        assert!(lengths.lacks(of(8)) && lengths.lacks(ReadbackLengths { touches: 1, ..of(0) }));
        assert_eq!(lengths.min(of(6)), of(6));
    }
}
