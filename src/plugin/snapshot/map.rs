//! A [`Snapshot`] whose bodies have other entities.

use super::Snapshot;
use crate::plugin::sync::driven::DrivenBodies;
use crate::plugin::sync::order::{Keyed, entity_of};
use bevy::ecs::entity::{EntityHashMap, EntityMapper, MapEntities};

impl MapEntities for Snapshot {
    /// Replaces the entities of bodies, colliders, planes and characters.
    ///
    /// If all of them have a [`StableKey`](crate::plugin::components::StableKey), steps continue to the bit. Colliders
    /// without one may come in another order, which gives other bits, and wake if they sleep.
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.leave_device();
        let bodies = std::mem::take(&mut self.bodies);
        self.bodies = (bodies.into_iter())
            .map(|(body, motion)| (mapper.get_mapped(body), motion))
            .collect();
        for body in &mut self.asleep {
            body.map_entities(mapper);
        }
        for touching in &mut self.touching {
            touching.pair = touching.pair.map(|id| id.mapped(mapper.get_mapped(id.entity)));
            touching.bodies.map_entities(mapper);
        }
        let nested = std::mem::take(&mut self.nested.0);
        self.nested.0 = (nested.into_iter())
            .map(|(body, nested)| (mapper.get_mapped(body), nested))
            .collect();
        let driven = std::mem::take(&mut self.driven);
        let mut mapped = DrivenBodies::default();
        mapped.poses = (driven.poses.into_iter())
            .map(|(body, pose)| (mapper.get_mapped(body), pose))
            .collect();
        mapped.far = driven.far.into_iter().map(|body| mapper.get_mapped(body)).collect();
        self.driven = mapped;
        let driven_velocities = std::mem::take(&mut self.driven_velocities);
        self.driven_velocities = (driven_velocities.into_iter())
            .map(|(body, velocity)| (mapper.get_mapped(body), velocity))
            .collect();
        let characters = std::mem::take(&mut self.characters);
        self.characters = (characters.into_iter())
            .map(|(character, mut state)| {
                state.map_entities(mapper);
                (mapper.get_mapped(character), state)
            })
            .collect();
        let mut keys = EntityHashMap::default();
        for entity in self.memory.keys().iter().copied().filter_map(entity_of) {
            keys.insert(entity, Keyed::new(mapper.get_mapped(entity), None).key);
        }
        let new_key = |key: u64| entity_of(key).and_then(|entity| keys.get(&entity)).copied();
        self.memory
            .rekey(&mut self.manifolds, |key| new_key(key).unwrap_or(key));
        self.sort();
    }
}
