//! The order of colliders, bodies and planes in a step. It is also what identifies colliders from step to step.

use super::split::Split;
use crate::plugin::components::StableKey;
use bevy::prelude::*;
use std::ops::Index;
use std::sync::Arc;

/// The bit that entities have and stable keys lack, so that bodies with a stable key come first.
const OF_ENTITY: u64 = 1 << 63;

/// The bits of an entity's index, which ascends in the order of spawning only if they are flipped.
const INDEX: u64 = u32::MAX as u64;

/// An entity with its key in the order of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Keyed {
    pub key: u64,
    pub entity: Entity,
}

impl Keyed {
    /// The key is the stable one if there is one, else the entity's. Later entities have larger keys, so that a spawned
    /// entity leaves the numbers of others as they are.
    pub fn new(entity: Entity, stable: Option<StableKey>) -> Self {
        // Two entities that exist at the same time differ in the other bits.
        let own = (entity.to_bits() ^ INDEX) | OF_ENTITY;
        let key = stable.map_or(own, |stable| stable.0 & !OF_ENTITY);
        Self { key, entity }
    }

    /// Whether the key is a stable one.
    pub fn is_stable(&self) -> bool {
        self.key & OF_ENTITY == 0
    }

    /// The key of the entity that takes this one's place in a mapped world.
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
        .then(|| Entity::try_from_bits((key & !OF_ENTITY) ^ INDEX))
        .flatten()
}

/// What has a place in the order.
pub(crate) trait InOrder {
    fn id(&self) -> Keyed;

    fn id_mut(&mut self) -> &mut Keyed;

    /// Whether it never moves.
    fn is_static(&self) -> bool {
        true
    }
}

/// Puts what is static before what is not, each in the order of keys. Without memory of its own, unlike a stable sort.
pub(crate) fn put_static_first<T: InOrder>(items: &mut [T]) {
    if !items.is_sorted_by_key(|item| !item.is_static()) {
        items.sort_unstable_by_key(|item| (!item.is_static(), item.id()));
    }
}

/// Sorts items by their keys. Among items with the same stable key, all but the first get the key of their entity and
/// are passed to `same`.
pub(crate) fn sort<T: InOrder>(items: &mut [T], mut same: impl FnMut(Keyed)) {
    // Among items with the same key, the first one spawned keeps it.
    let order = |item: &T| (item.id().key, Keyed::new(item.id().entity, None).key);
    items.sort_unstable_by_key(order);
    let mut is_changed = false;
    for i in (1..items.len()).rev() {
        let id = items[i].id();
        // Items with stable keys come first.
        if id.is_stable() && items[i - 1].id().key == id.key {
            *items[i].id_mut() = Keyed::new(id.entity, None);
            same(id);
            is_changed = true;
        }
    }
    if is_changed {
        items.sort_unstable_by_key(order);
    }
}

/// Entities by number: static colliders in the order of their keys, then others in that order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Numbers {
    entities: Split<Entity>,
    keys: Split<u64>,
    /// For each part, the numbers of entities with stable keys, which come first, in the order of entities.
    by_entity: [Arc<Vec<u32>>; 2],
}

impl Numbers {
    /// Empties it, and keeps the memory.
    pub fn clear(&mut self) {
        self.entities.clear();
        self.keys.clear();
    }

    /// Adds one. Keys are ascending in each part.
    pub fn push(&mut self, Keyed { key, entity }: Keyed) {
        self.entities.push(entity);
        self.keys.push(key);
    }

    /// What has been pushed so far is the part that rests.
    pub fn end_fixed(&mut self) {
        self.entities.end_fixed();
        self.keys.end_fixed();
        self.index(0);
    }

    /// Takes the part that rests from another list.
    pub fn begin_moving(&mut self, other: &Self) {
        self.entities.begin_moving(&other.entities);
        self.keys.begin_moving(&other.keys);
        self.by_entity[0] = Arc::clone(&other.by_entity[0]);
    }

    /// Opens the part that moves again, without those from this number on.
    pub fn reopen(&mut self, count: usize) {
        self.entities.reopen(count);
        self.keys.reopen(count);
    }

    /// To be called after the last one.
    pub fn finish(&mut self) {
        self.entities.end_moving();
        self.keys.end_moving();
        self.index(1);
    }

    /// Makes the index of a part.
    fn index(&mut self, part: usize) {
        let own = self.entities.parts()[part];
        let stable = self.keys.parts()[part].partition_point(|key| key & OF_ENTITY == 0);
        let by_entity = &mut self.by_entity[part];
        if stable == 0 {
            if !by_entity.is_empty() {
                *by_entity = Arc::default();
            }
            return;
        }
        if Arc::get_mut(by_entity).is_none() {
            *by_entity = Arc::default();
        }
        let by_entity = Arc::make_mut(by_entity);
        by_entity.clear();
        by_entity.extend(0..stable as u32);
        by_entity.sort_unstable_by_key(|&number| own[number as usize]);
    }

    pub fn len(&self) -> usize {
        self.entities.len()
    }

    pub fn get(&self, number: usize) -> Option<Entity> {
        self.entities.get(number).copied()
    }

    pub fn iter(&self) -> impl Iterator<Item = Entity> + Clone + '_ {
        self.entities.iter().copied()
    }

    /// The keys of both parts, each ascending.
    pub fn keys(&self) -> [&[u64]; 2] {
        self.keys.parts()
    }

    /// Whether one has this key.
    pub fn has_key(&self, key: u64) -> bool {
        self.keys().iter().any(|part| part.binary_search(&key).is_ok())
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
        let own_key = Keyed::new(entity, None).key;
        let find = |part: usize| {
            let (own, by_entity) = (self.entities.parts()[part], &self.by_entity[part]);
            let of = |&number: &u32| own[number as usize];
            match by_entity.binary_search_by_key(&entity, of) {
                Ok(at) => Some(by_entity[at] as usize),
                Err(_) => self.keys.parts()[part].binary_search(&own_key).ok(),
            }
        };
        find(1).map(|number| self.fixed() + number).or_else(|| find(0))
    }

    /// How many are static.
    pub fn fixed(&self) -> usize {
        self.entities.parts()[0].len()
    }
}

impl Index<usize> for Numbers {
    type Output = Entity;

    fn index(&self, number: usize) -> &Entity {
        &self.entities[number]
    }
}
