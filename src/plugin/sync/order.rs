//! The order of colliders, bodies and planes in a step. It is also what identifies colliders from step to step.

use crate::plugin::components::StableKey;
use bevy::prelude::*;
use std::ops::Deref;

/// The bit that entities have and stable keys lack, so that bodies with a stable key come first.
const OF_ENTITY: u64 = 1 << 63;

/// An entity with its key in the order of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Keyed {
    pub key: u64,
    pub entity: Entity,
}

impl Keyed {
    /// The key is the stable one if there is one, else that of the entity.
    pub fn new(entity: Entity, stable: Option<StableKey>) -> Self {
        // Two entities that exist at the same time differ in the other bits.
        let key = stable.map_or(entity.to_bits() | OF_ENTITY, |stable| stable.0 & !OF_ENTITY);
        Self { key, entity }
    }

    /// Whether the key is a stable one.
    pub fn is_stable(&self) -> bool {
        self.key & OF_ENTITY == 0
    }

    /// The same for another entity, which takes its place in a mapped world.
    pub fn mapped(self, entity: Entity) -> Self {
        if self.is_stable() {
            Self { entity, ..self }
        } else {
            Self::new(entity, None)
        }
    }
}

/// The entity whose key this is, unless it is a stable one.
pub(crate) fn entity_of(key: u64) -> Option<Entity> {
    (key & OF_ENTITY != 0)
        .then(|| Entity::try_from_bits(key & !OF_ENTITY))
        .flatten()
}

/// What has a place in the order.
pub(crate) trait InOrder {
    fn id(&self) -> Keyed;

    fn id_mut(&mut self) -> &mut Keyed;
}

/// Sorts items by their keys. Of those with the same stable key all but the first get the key of their entity, and are
/// passed to `same`.
pub(crate) fn sort<T: InOrder>(items: &mut [T], mut same: impl FnMut(Keyed)) {
    items.sort_unstable_by_key(InOrder::id);
    let mut is_changed = false;
    for i in (1..items.len()).rev() {
        let id = items[i].id();
        // After those with stable keys come the others.
        if id.is_stable() && items[i - 1].id().key == id.key {
            *items[i].id_mut() = Keyed::new(id.entity, None);
            same(id);
            is_changed = true;
        }
    }
    if is_changed {
        items.sort_unstable_by_key(InOrder::id);
    }
}

/// Entities in the order of their keys, by number.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbers {
    entities: Vec<Entity>,
    keys: Vec<u64>,
    /// The numbers in the order of entities; empty if that is the order of the keys.
    by_entity: Vec<u32>,
}

impl Deref for Numbers {
    type Target = [Entity];
    fn deref(&self) -> &[Entity] {
        &self.entities
    }
}

impl Numbers {
    /// Empties it, and keeps the memory.
    pub fn clear(&mut self) {
        self.entities.clear();
        self.keys.clear();
        self.by_entity.clear();
    }

    /// Adds one. Keys are ascending.
    pub fn push(&mut self, Keyed { key, entity }: Keyed) {
        self.entities.push(entity);
        self.keys.push(key);
    }

    /// To be called after the last one.
    pub fn finish(&mut self) {
        self.by_entity.clear();
        if !self.entities.is_sorted() {
            self.by_entity.extend(0..self.entities.len() as u32);
            self.by_entity
                .sort_unstable_by_key(|&number| self.entities[number as usize]);
        }
    }

    /// The keys, ascending.
    pub fn keys(&self) -> &[u64] {
        &self.keys
    }

    /// The one with this number.
    pub fn keyed(&self, number: usize) -> Keyed {
        Keyed {
            key: self.keys[number],
            entity: self.entities[number],
        }
    }

    /// The number of an entity.
    pub fn number_of(&self, entity: Entity) -> Option<usize> {
        if self.by_entity.is_empty() {
            return self.entities.binary_search(&entity).ok();
        }
        let of = |&number: &u32| self.entities[number as usize];
        let at = self.by_entity.binary_search_by_key(&entity, of).ok()?;
        Some(self.by_entity[at] as usize)
    }
}
