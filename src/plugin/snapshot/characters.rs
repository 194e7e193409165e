//! The characters of a [`Snapshot`](super::Snapshot).

use super::plain::{Bits, PlainFault, entity};
use crate::plugin::character::{Anchor, Character, CharacterGround, GroundContact};
#[cfg(feature = "interpolation")]
use crate::plugin::interpolation;
use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a step writes of a [`Character`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CharacterState {
    /// The translation of its `Transform`.
    translation: Vec3,
    velocity: Vec3,
    ground: CharacterGround,
}

/// The states of all characters.
pub(super) fn take(world: &mut World) -> BTreeMap<Entity, CharacterState> {
    let mut characters = world.query::<(Entity, &Transform, &Character, &CharacterGround)>();
    (characters.iter(world))
        .map(|(entity, transform, character, &ground)| {
            let state = CharacterState {
                translation: transform.translation,
                velocity: character.velocity,
                ground,
            };
            (entity, state)
        })
        .collect()
}

/// Restores all characters. Characters without a saved state keep theirs, but leave their ground, which may be
/// elsewhere now. Returns the entities that no longer exist.
pub(super) fn restore(states: &BTreeMap<Entity, CharacterState>, world: &mut World) -> Vec<Entity> {
    let mut others = world.query::<(Entity, &mut CharacterGround)>();
    for (entity, mut ground) in others.iter_mut(world) {
        if !states.contains_key(&entity) {
            ground.set_if_neq(CharacterGround::default());
        }
    }
    let mut gone = Vec::new();
    for (&entity, state) in states {
        match world.get_entity_mut(entity) {
            Ok(entity) => state.restore(entity),
            Err(_) => gone.push(entity),
        }
    }
    gone
}

impl CharacterState {
    fn restore(&self, mut entity: EntityWorldMut) {
        let Some(mut character) = entity.get_mut::<Character>() else {
            return;
        };
        character.velocity = self.velocity;
        #[cfg(feature = "interpolation")]
        interpolation::show_exact(&mut entity);
        if let Some(mut transform) = entity.get_mut::<Transform>() {
            transform.translation = self.translation;
        }
        if let Some(mut ground) = entity.get_mut::<CharacterGround>() {
            *ground = self.ground;
        }
    }
}

impl MapEntities for CharacterState {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        if let Some(contact) = &mut self.ground.0 {
            contact.map_entities(mapper);
        }
    }
}

/// What is written of a character.
#[derive(Serialize, Deserialize)]
pub(super) struct PlainCharacter {
    character: Bits,
    translation: Vec3,
    velocity: Vec3,
    ground: Option<PlainGround>,
}

#[derive(Serialize, Deserialize)]
struct PlainGround {
    collider: Bits,
    body: Bits,
    face: Option<u32>,
    point: Vec3,
    normal: Vec3,
    velocity: Vec3,
    angular_velocity: Vec3,
    place: Vec3,
    anchor: Anchor,
}

impl PlainCharacter {
    pub(super) fn new(character: Entity, state: CharacterState) -> Self {
        Self {
            character: character.to_bits(),
            translation: state.translation,
            velocity: state.velocity,
            ground: state.ground.0.map(PlainGround::from),
        }
    }

    pub(super) fn state(self) -> Result<(Entity, CharacterState), PlainFault> {
        let character = entity(self.character)?;
        let ground = self.ground.map(GroundContact::try_from).transpose()?;
        let is_finite = ground.is_none_or(|contact| {
            let vectors = [contact.point, contact.velocity, contact.angular_velocity, contact.place];
            vectors.iter().all(|vector| vector.is_finite())
                && contact.normal.is_normalized()
                && contact.anchor.point.is_finite()
                && contact.anchor.rotation.is_normalized()
        });
        if !is_finite {
            return Err(PlainFault::Ground(character));
        }
        let state = CharacterState {
            translation: self.translation,
            velocity: self.velocity,
            ground: CharacterGround(ground),
        };
        Ok((character, state))
    }
}

impl From<GroundContact> for PlainGround {
    fn from(contact: GroundContact) -> Self {
        Self {
            collider: contact.collider.to_bits(),
            body: contact.body.to_bits(),
            face: contact.face,
            point: contact.point,
            normal: contact.normal,
            velocity: contact.velocity,
            angular_velocity: contact.angular_velocity,
            place: contact.place,
            anchor: contact.anchor,
        }
    }
}

impl TryFrom<PlainGround> for GroundContact {
    type Error = PlainFault;

    fn try_from(plain: PlainGround) -> Result<Self, PlainFault> {
        Ok(Self {
            collider: entity(plain.collider)?,
            body: entity(plain.body)?,
            face: plain.face,
            point: plain.point,
            normal: plain.normal,
            velocity: plain.velocity,
            angular_velocity: plain.angular_velocity,
            place: plain.place,
            anchor: plain.anchor,
        })
    }
}
