//! Makes lists shorter that have become too long, so that a crowd of an hour ago takes no memory and no bytes to read.

use super::buffers::StepCapacity;
use super::contact_programs::START as CONTACT_START;
use crate::gpu::buffers::{Capacity, grow};
use crate::manifolds::gpu::ContactCapacity;

/// The largest use of each list in the last steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct PeakUsage {
    steps: u32,
    most: Capacity,
    most_for_contacts: Option<StepCapacity>,
}

/// After this many steps lists may become shorter. New buffers cost a few milliseconds.
const STEPS: u32 = 256;

/// A list becomes shorter if no step has used more than one in this many of its elements.
const UNUSED: u32 = 4;

impl PeakUsage {
    /// Adds the use of a step.
    pub fn add(&mut self, used: Capacity, for_contacts: Option<StepCapacity>) {
        self.steps += 1;
        self.most = self.most.max(used);
        self.most_for_contacts = match (self.most_for_contacts, for_contacts) {
            (Some(most), Some(used)) => Some(most.max(used)),
            (most, used) => most.or(used),
        };
    }

    /// Whether there were enough steps to tell.
    pub fn is_full(&self) -> bool {
        self.steps >= STEPS
    }

    /// The capacity that lists should have instead of this one, if some are too long.
    pub fn shrunk(
        &self,
        capacity: Capacity,
        for_contacts: Option<StepCapacity>,
        least: Capacity,
    ) -> Option<(Capacity, Option<StepCapacity>)> {
        let Self {
            most,
            most_for_contacts,
            ..
        } = *self;
        let lists = Capacity {
            bodies: shorter(capacity.bodies, most.bodies, least.bodies),
            compounds: shorter(capacity.compounds, most.compounds, least.compounds),
            parts: shorter(capacity.parts, most.parts, least.parts),
            planes: if most.planes.saturating_mul(UNUSED) < capacity.planes {
                most.planes
            } else {
                capacity.planes
            },
            pairs: shorter(capacity.pairs, most.pairs, least.pairs),
            hits: shorter(capacity.hits, most.hits, least.hits),
            plane_contacts: shorter(capacity.plane_contacts, most.plane_contacts, least.plane_contacts),
            pieces: shorter(capacity.pieces, most.pieces, least.pieces),
            // The arena has given its places to meshes.
            meshes: capacity.meshes,
            words: capacity.words,
        };
        // Steps without contacts say nothing about the lists of contacts.
        let of_contacts = match (for_contacts, most_for_contacts) {
            (Some(has), Some(most)) => Some(StepCapacity {
                // The lists of the step set a least number of bodies.
                bodies: if (lists.bodies, lists.planes) == (capacity.bodies, capacity.planes) {
                    has.bodies
                } else {
                    most.bodies
                },
                ..shorter_for_contacts(has, most)
            }),
            (capacity, _) => capacity,
        };
        let is_shorter = lists != capacity || of_contacts != for_contacts;
        is_shorter.then_some((lists, of_contacts))
    }
}

fn shorter_for_contacts(capacity: StepCapacity, most: StepCapacity) -> StepCapacity {
    let (has, used, least) = (capacity.contacts, most.contacts, CONTACT_START.contacts);
    // Not as soon as one batch less would do.
    let fewer_batches = used.batches <= has.batches / 2;
    let batches = if fewer_batches { used.batches } else { has.batches };
    let used = ContactCapacity {
        batches: has.batches,
        ..used
    }
    .in_batches(batches);
    let of_batch = |has: u32, used: u32, least: u32| {
        if fewer_batches {
            grow(0, used).max(least)
        } else {
            shorter(has, used, least)
        }
    };
    StepCapacity {
        contacts: ContactCapacity {
            batches,
            // `margin_pairs` and `slots` follow from the lists of the step.
            margin_pairs: has.margin_pairs,
            slots: has.slots,
            near_triangles: of_batch(has.near_triangles, used.near_triangles, least.near_triangles),
            pieces: of_batch(has.pieces, used.pieces, least.pieces),
            features: of_batch(has.features, used.features, least.features),
            segments: of_batch(has.segments, used.segments, least.segments),
            staged_points: shorter(has.staged_points, used.staged_points, least.staged_points),
            pairs: shorter(has.pairs, used.pairs, least.pairs),
            points: shorter(has.points, used.points, least.points),
        },
        touches: shorter(capacity.touches, most.touches, CONTACT_START.touches),
        solves: most.solves,
        ..capacity
    }
}

/// The new length of a list of length `has`, of which `used` was used.
fn shorter(has: u32, used: u32, least: u32) -> u32 {
    let wanted = grow(0, used).max(least);
    if used.saturating_mul(UNUSED) < has && wanted < has {
        wanted
    } else {
        has
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pairs: u32) -> Capacity {
        Capacity {
            pairs,
            ..Capacity::default()
        }
    }

    #[test]
    fn lists_become_shorter_when_a_window_used_little_of_them() {
        let mut peak_usage = PeakUsage::default();
        for _ in 1..STEPS {
            peak_usage.add(of(100), None);
            assert!(!peak_usage.is_full());
        }
        peak_usage.add(of(200), None);
        assert!(peak_usage.is_full());
        let (lists, _) = peak_usage
            .shrunk(of(10_000), None, of(50))
            .expect("a fiftieth was used");
        assert_eq!(lists, of(grow(0, 200)));
        // A step that used more is remembered.
        peak_usage.add(of(9000), None);
        assert_eq!(peak_usage.shrunk(of(10_000), None, of(50)), None);
    }

    /// The lists of batches become shorter, or the batches fewer.
    #[test]
    fn batches_become_fewer_when_half_of_them_would_do() {
        let of = |batches, near_triangles, other_lists| StepCapacity {
            contacts: ContactCapacity {
                batches,
                near_triangles,
                ..other_lists
            },
            ..CONTACT_START
        };
        let has = |batches, near_triangles| of(batches, near_triangles, CONTACT_START.contacts);
        let shrunk = |batches, near_triangles| {
            let used = of(batches, near_triangles, ContactCapacity::default());
            shorter_for_contacts(has(6, 1 << 20), used)
        };
        assert_eq!(shrunk(4, 1 << 19), has(6, 1 << 20));
        assert_eq!(shrunk(4, 1 << 17), has(6, grow(0, 1 << 17)));
        assert_eq!(shrunk(3, 1 << 19), has(3, grow(0, 1 << 20)));
        assert_eq!(shrunk(1, 0), has(1, CONTACT_START.contacts.near_triangles));
    }

    /// A small world with contacts, whose lists are as short as they can be, keeps its buffers.
    #[test]
    fn the_shortest_lists_stay() {
        let least = Capacity {
            bodies: 255,
            pairs: 1024,
            ..Capacity::default()
        };
        let for_contacts = StepCapacity {
            solves: true,
            ..CONTACT_START
        };
        let for_contacts = for_contacts.covering(&least);
        let mut peak_usage = PeakUsage::default();
        let used = StepCapacity {
            bodies: 3,
            contacts: ContactCapacity::default(),
            touches: 0,
            solves: true,
            has_fast_bodies: false,
        };
        peak_usage.add(Capacity { bodies: 3, ..of(2) }, Some(used));
        assert_eq!(peak_usage.shrunk(least, Some(for_contacts), least), None);
        // After a crowd both become shorter, and then stay.
        let crowd = Capacity { bodies: 5000, ..least };
        let (lists, contacts) = peak_usage
            .shrunk(crowd, Some(for_contacts.covering(&crowd)), least)
            .expect("3 of 5000 bodies");
        let contacts = contacts.map(|contacts| contacts.covering(&lists));
        assert_eq!((lists.bodies, contacts.map(|own| own.bodies)), (255, Some(255)));
        assert_eq!(peak_usage.shrunk(lists, contacts, least), None);
    }

    #[test]
    fn lists_that_are_used_stay() {
        for (has, used, least) in [
            (1000, 250, 0),
            (1000, 1000, 0),
            (1000, 10, 1000),
            (60, 0, 60),
            (0, 0, 0),
        ] {
            assert_eq!(shorter(has, used, least), has, "{has} {used} {least}");
        }
        assert_eq!(shorter(1000, 10, 500), 500);
        assert_eq!(shorter(60, 0, 0), 0);
        assert_eq!(shorter(u32::MAX, 1 << 28, 0), grow(0, 1 << 28));
    }
}
