//! What is written of a [`Snapshot`]: lists of plain numbers, with entities as their bits.

use super::Snapshot;
use super::characters::PlainCharacter;
use crate::manifolds::Manifolds;
use crate::plugin::components::DrivenVelocity;
use crate::plugin::sync::Touching;
use crate::plugin::sync::driven::DrivenBodies;
use crate::plugin::sync::hierarchy::{Nested, NestedBodies, Posed};
use crate::plugin::sync::order::Keyed;
use crate::state::Motion;
use crate::state::memory_fault::MemoryFault;
use crate::step::StepMemory;
use crate::types::body::RigidBody;
use bevy::math::DAffine3;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Grows with every change of what is written.
const FORMAT: u32 = 7;

/// The bits of an [`Entity`].
pub(super) type Bits = u64;

/// A pose: position and rotation.
type Pose = (Vec3, Quat);

#[derive(Serialize, Deserialize)]
pub(super) struct Plain {
    format: u32,
    bodies: Vec<(Bits, Motion)>,
    asleep: Vec<Bits>,
    touching: Vec<PlainTouching>,
    nested: Vec<PlainNested>,
    /// Kinematic bodies that move by their `Transform`.
    driven: Vec<(Bits, Pose)>,
    driven_far: Vec<Bits>,
    /// The velocities of driven bodies that moved in the last step.
    driven_velocities: Vec<(Bits, DrivenVelocity)>,
    characters: Vec<PlainCharacter>,
    memory: StepMemory,
    manifolds: Manifolds,
}

#[derive(Serialize, Deserialize)]
struct PlainTouching {
    colliders: [Bits; 2],
    keys: [u64; 2],
    bodies: [Bits; 2],
    left: f32,
}

#[derive(Serialize, Deserialize)]
struct PlainNested {
    body: Bits,
    kind: RigidBody,
    translation: Vec3,
    rotation: Quat,
    scale: Vec3,
    above: DAffine3,
    posed: Posed,
}

/// Why a snapshot cannot be read.
#[derive(Debug, Error)]
pub(super) enum PlainFault {
    #[error("the snapshot has format {0}, but this version of bevy_faceoff reads format {FORMAT}: take it again")]
    Format(u32),
    #[error("the snapshot is damaged: {0} is not an entity")]
    Entity(Bits),
    #[error("the snapshot is damaged: the pose of the kinematic body {0} is not finite")]
    Driven(Entity),
    #[error("the snapshot is damaged: the ground of the character {0} has numbers that are not valid")]
    Ground(Entity),
    #[error("the snapshot is damaged: {0}")]
    Memory(#[from] MemoryFault),
}

impl From<Snapshot> for Plain {
    fn from(mut snapshot: Snapshot) -> Self {
        snapshot.leave_device();
        let Snapshot {
            bodies,
            touching,
            nested,
            driven,
            driven_velocities,
            characters,
            memory,
            manifolds,
            asleep,
            ..
        } = snapshot;
        let bits = |entity: Entity| entity.to_bits();
        let mut nested: Vec<_> = (nested.0.into_iter())
            .map(|(body, nested)| PlainNested::new(body, nested))
            .collect();
        nested.sort_unstable_by_key(|nested| nested.body);
        let mut poses: Vec<_> = (driven.poses.into_iter())
            .map(|(body, pose)| (bits(body), pose))
            .collect();
        poses.sort_unstable_by_key(|&(body, _)| body);
        let mut driven_far: Vec<_> = driven.far.into_iter().map(bits).collect();
        driven_far.sort_unstable();
        let driven_velocities = (driven_velocities.into_iter())
            .map(|(body, velocities)| (bits(body), velocities))
            .collect();
        Self {
            format: FORMAT,
            bodies: (bodies.into_iter())
                .map(|(body, motion)| (bits(body), motion))
                .collect(),
            asleep: asleep.into_iter().map(bits).collect(),
            touching: touching.iter().map(PlainTouching::from).collect(),
            nested,
            driven: poses,
            driven_far,
            driven_velocities,
            characters: (characters.into_iter())
                .map(|(character, state)| PlainCharacter::new(character, state))
                .collect(),
            memory,
            manifolds,
        }
    }
}

impl TryFrom<Plain> for Snapshot {
    type Error = PlainFault;

    /// Checks everything that later steps rely on. Poses and velocities of bodies are checked by the step, like those
    /// of any body.
    fn try_from(plain: Plain) -> Result<Self, PlainFault> {
        let Plain {
            format,
            bodies,
            asleep,
            touching,
            nested,
            driven,
            driven_far,
            driven_velocities,
            characters,
            memory,
            manifolds,
        } = plain;
        if format != FORMAT {
            return Err(PlainFault::Format(format));
        }
        memory.check(&manifolds)?;
        let mut snapshot = Self {
            memory,
            manifolds,
            ..default()
        };
        for (body, motion) in bodies {
            snapshot.bodies.insert(entity(body)?, motion);
        }
        snapshot.asleep = asleep.into_iter().map(entity).collect::<Result<_, _>>()?;
        snapshot.touching = (touching.into_iter())
            .map(Touching::try_from)
            .collect::<Result<_, _>>()?;
        let nested = nested
            .into_iter()
            .map(|nested| Ok((entity(nested.body)?, nested.into())));
        snapshot.nested = NestedBodies(nested.collect::<Result<_, PlainFault>>()?);
        let mut bodies = DrivenBodies::default();
        for (body, (position, rotation)) in driven {
            let body = entity(body)?;
            if !position.is_finite() || !rotation.is_finite() || rotation.length_squared() == 0.0 {
                return Err(PlainFault::Driven(body));
            }
            bodies.poses.insert(body, (position, rotation));
        }
        for body in driven_far {
            bodies.far.insert(entity(body)?);
        }
        for (body, velocities) in driven_velocities {
            snapshot.driven_velocities.insert(entity(body)?, velocities);
        }
        snapshot.driven = bodies;
        snapshot.characters = (characters.into_iter())
            .map(PlainCharacter::state)
            .collect::<Result<_, _>>()?;
        snapshot.sort();
        Ok(snapshot)
    }
}

pub(super) fn entity(bits: Bits) -> Result<Entity, PlainFault> {
    Entity::try_from_bits(bits).ok_or(PlainFault::Entity(bits))
}

impl From<&Touching> for PlainTouching {
    fn from(touching: &Touching) -> Self {
        Self {
            colliders: touching.colliders().map(Entity::to_bits),
            keys: touching.pair.map(|id| id.key),
            bodies: touching.bodies.map(Entity::to_bits),
            left: touching.left,
        }
    }
}

impl TryFrom<PlainTouching> for Touching {
    type Error = PlainFault;

    fn try_from(plain: PlainTouching) -> Result<Self, PlainFault> {
        let [a, b] = plain.colliders;
        let [key_a, key_b] = plain.keys;
        let keyed = |key, bits| {
            Ok::<_, PlainFault>(Keyed {
                key,
                entity: entity(bits)?,
            })
        };
        Ok(Self {
            pair: [keyed(key_a, a)?, keyed(key_b, b)?],
            bodies: [entity(plain.bodies[0])?, entity(plain.bodies[1])?],
            left: plain.left,
        })
    }
}

impl PlainNested {
    fn new(body: Entity, nested: Nested) -> Self {
        let Transform {
            translation,
            rotation,
            scale,
        } = nested.transform;
        Self {
            body: body.to_bits(),
            kind: nested.kind,
            translation,
            rotation,
            scale,
            above: nested.above,
            posed: nested.posed,
        }
    }
}

impl From<PlainNested> for Nested {
    fn from(plain: PlainNested) -> Self {
        Self {
            kind: plain.kind,
            transform: Transform {
                translation: plain.translation,
                rotation: plain.rotation,
                scale: plain.scale,
            },
            above: plain.above,
            posed: plain.posed,
        }
    }
}
