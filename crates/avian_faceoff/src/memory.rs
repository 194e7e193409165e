//! What is kept of a pair from step to step.

use crate::pose::Pose;
use avian3d::prelude::{NarrowPhaseSystems, PhysicsSchedule};
use bevy::prelude::*;
use bevy_faceoff::queries::PairMemory;
use dashmap::DashMap;

/// The memory of each pair of exact meshes near each other. Avian hands its narrow phase no memory of its own, and only
/// resources that are not changed: so each part of this map has a lock.
///
/// A memory changes the time that contacts take, never where they are.
#[derive(Resource, Default)]
pub struct PairMemories {
    pairs: DashMap<[Entity; 2], Kept>,
    /// Number of the step.
    step: u64,
}

struct Kept {
    memory: PairMemory,
    /// Where the first collider was in that step.
    first: Pose,
    /// The step that used it last.
    step: u64,
}

impl PairMemories {
    /// Lends the memory of a pair whose first collider is at `first`, and tells where that was in the last step; at
    /// `first`, if that is not known. No lock is held while `find` runs.
    pub(crate) fn lend(&self, pair: [Entity; 2], first: Pose, find: impl FnOnce(&mut PairMemory, &Pose)) {
        let (mut memory, last) = self
            .pairs
            .remove(&pair)
            .map_or_else(|| (PairMemory::default(), first), |(_, kept)| (kept.memory, kept.first));
        find(&mut memory, &last);
        let step = self.step;
        self.pairs.insert(pair, Kept { memory, first, step });
    }
}

pub(crate) fn plugin(app: &mut App) {
    app.init_resource::<PairMemories>()
        .add_systems(PhysicsSchedule, forget.in_set(NarrowPhaseSystems::Last));
}

/// Drops what this step has not used: pairs that are far apart, gone, or asleep.
fn forget(mut memories: ResMut<PairMemories>) {
    let now = memories.step;
    memories.pairs.retain(|_, kept| kept.step == now);
    memories.step += 1;
}

#[cfg(test)]
mod tests {
    use super::*;
    use avian3d::math::{Quaternion, Scalar, Vector};

    fn at(x: i8) -> Pose {
        Pose {
            position: Vector::X * Scalar::from(x),
            rotation: Quaternion::IDENTITY,
        }
    }

    #[test]
    fn a_pair_knows_where_it_was() {
        let mut world = World::new();
        let pair = [0; 2].map(|_| world.spawn_empty().id());
        let memories = PairMemories::default();
        memories.lend(pair, at(1), |_, last| assert_eq!(last.position, at(1).position));
        memories.lend(pair, at(2), |_, last| assert_eq!(last.position, at(1).position));
    }

    #[test]
    fn pairs_that_a_step_does_not_use_are_forgotten() {
        let mut world = World::new();
        world.init_resource::<PairMemories>();
        let [a, b, c] = [0; 3].map(|_| world.spawn_empty().id());
        let use_pairs = |world: &World, pairs: &[[Entity; 2]]| {
            for pair in pairs {
                world.resource::<PairMemories>().lend(*pair, at(0), |_, _| {});
            }
        };
        let mut forget = IntoSystem::into_system(forget);
        forget.initialize(&mut world);
        use_pairs(&world, &[[a, b], [b, c]]);
        forget.run((), &mut world).expect("it has its resource");
        assert_eq!(world.resource::<PairMemories>().pairs.len(), 2);
        use_pairs(&world, &[[b, c]]);
        forget.run((), &mut world).expect("it has its resource");
        let memories = world.resource::<PairMemories>();
        assert_eq!(memories.pairs.len(), 1);
        assert!(memories.pairs.contains_key(&[b, c]));
    }
}
