//! A set of entities that exist at the same time, as one bit for each.

use bevy::prelude::*;

/// Entities by their indices. Two that have one index one after the other count as one.
#[derive(Debug, Default)]
pub(crate) struct EntityIndexSet {
    bits: Vec<u64>,
    count: usize,
}

impl EntityIndexSet {
    pub fn clear(&mut self) {
        self.bits.clear();
        self.count = 0;
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub fn len(&self) -> usize {
        self.count
    }

    pub fn insert(&mut self, entity: Entity) {
        let [at, bit] = place(entity);
        if self.bits.len() <= at {
            self.bits.resize(at + 1, 0);
        }
        self.count += usize::from(self.bits[at] >> bit & 1 == 0);
        self.bits[at] |= 1 << bit;
    }

    pub fn contains(&self, entity: Entity) -> bool {
        let [at, bit] = place(entity);
        self.bits.get(at).is_some_and(|word| word >> bit & 1 == 1)
    }
}

fn place(entity: Entity) -> [usize; 2] {
    let index = entity.index_u32() as usize;
    [index / 64, index % 64]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entities_are_in_the_set_that_were_inserted() {
        let entity = |index| Entity::from_raw_u32(index).unwrap();
        let mut set = EntityIndexSet::default();
        assert!(set.is_empty() && !set.contains(entity(70)));
        [3, 70, 70, 1000]
            .into_iter()
            .for_each(|index| set.insert(entity(index)));
        let found: Vec<u32> = (0..2000).filter(|&index| set.contains(entity(index))).collect();
        assert_eq!((found, set.count), (vec![3, 70, 1000], 3));
        set.clear();
        assert!(set.is_empty() && !set.contains(entity(3)));
    }
}
