//! Messages and events: collisions that start or end, and bodies that are rejected.

use crate::state::fault::BodyFault;
use bevy::prelude::*;

/// Two bodies, or a body and a plane, began to touch in this step.
///
/// As a message it is written once per pair, with `entity1 < entity2`. As an event it is triggered for each of the two
/// that has [`CollisionEventsEnabled`](crate::plugin::components::CollisionEventsEnabled), with that entity as
/// `entity1`.
///
/// If the two separate and touch again before [`CollisionEnd`] was sent, neither is sent.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionStart {
    /// One of the two entities.
    #[event_target]
    pub entity1: Entity,
    /// The other entity.
    pub entity2: Entity,
}

/// Two bodies, or a body and a plane, have not touched for the time of
/// [`EventHysteresis`](crate::plugin::settings::EventHysteresis). Sent at once if one of them was despawned or
/// rejected.
///
/// Written and triggered like [`CollisionStart`].
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionEnd {
    /// One of the two entities.
    #[event_target]
    pub entity1: Entity,
    /// The other entity.
    pub entity2: Entity,
}

/// A body or plane was left out of the step because its components are invalid. Written once. The body takes part again
/// as soon as its components are valid.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct BodyRejected {
    /// The body or plane.
    pub entity: Entity,
    /// The reason, and what to do.
    pub fault: BodyFault,
}
