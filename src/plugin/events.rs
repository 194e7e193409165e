//! Messages and events: collisions that start or end, and bodies that are rejected.

use crate::state::fault::BodyFault;
use bevy::ecs::entity::MapEntities;
use bevy::ecs::reflect::ReflectMapEntities;
use bevy::prelude::*;

/// Two colliders, or a collider and a plane, began to touch in this step.
///
/// As a message it is written once per pair, with the smaller one, in the order of
/// [`Collisions`](crate::plugin::collisions::Collisions), as `collider1`. As an event it is triggered for each of the
/// two colliders and their bodies with [`CollisionEventsEnabled`](crate::plugin::components::CollisionEventsEnabled);
/// `collider1` and `body1` then belong to that entity.
///
/// If the two separate and touch again before [`CollisionEnd`] was sent, neither is sent.
///
/// Steps run in `FixedPostUpdate`. A system in `FixedLast` reads the messages of the step just done, a system in
/// `Update` the messages of all steps of the frame, and a system in `FixedUpdate` the messages of the step before.
/// Events are triggered at the end of the step.
#[derive(Message, EntityEvent, MapEntities, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Message, Event, MapEntities, Debug, PartialEq)]
pub struct CollisionStart {
    /// The collider or body for which the event is triggered; in messages `collider1`.
    #[event_target]
    #[entities]
    pub target: Entity,
    /// One of the two colliders.
    #[entities]
    pub collider1: Entity,
    /// The other collider, or the plane.
    #[entities]
    pub collider2: Entity,
    /// The body of `collider1`; without a body the collider itself.
    #[entities]
    pub body1: Entity,
    /// The body of `collider2`.
    #[entities]
    pub body2: Entity,
}

impl CollisionStart {
    /// The end of this collision.
    pub(crate) fn into_end(self) -> CollisionEnd {
        let Self {
            target,
            collider1,
            collider2,
            body1,
            body2,
        } = self;
        CollisionEnd {
            target,
            collider1,
            collider2,
            body1,
            body2,
        }
    }
}

/// Two colliders, or a collider and a plane, have not touched for the time of
/// [`EventHysteresis`](crate::plugin::settings::EventHysteresis). Sent at once if one of them was despawned, disabled
/// or rejected, or became part of another body.
///
/// Written and triggered like [`CollisionStart`].
#[derive(Message, EntityEvent, MapEntities, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Message, Event, MapEntities, Debug, PartialEq)]
pub struct CollisionEnd {
    /// The collider or body for which the event is triggered; in messages `collider1`.
    #[event_target]
    #[entities]
    pub target: Entity,
    /// One of the two colliders.
    #[entities]
    pub collider1: Entity,
    /// The other collider, or the plane.
    #[entities]
    pub collider2: Entity,
    /// The body of `collider1`; without a body the collider itself.
    #[entities]
    pub body1: Entity,
    /// The body of `collider2`.
    #[entities]
    pub body2: Entity,
}

/// A collider, body or plane was left out of the step because its components are invalid. Written once. It takes part
/// again as soon as its components are valid.
#[derive(Message, MapEntities, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Message, MapEntities, Debug, PartialEq)]
pub struct BodyRejected {
    /// The collider, body or plane.
    #[entities]
    pub entity: Entity,
    /// The reason, and what to do.
    pub fault: BodyFault,
}
