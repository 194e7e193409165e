//! What is told when it happens.

use crate::state::fault::BodyFault;
use bevy::prelude::*;

/// Two bodies, or a body and a plane, began to touch in this step. Not written again if the two touch again before their
/// [`CollisionEnd`] was written.
///
/// Written once per pair as a message, `entity1 < entity2`. Triggered as an event for each of the two that has
/// [`CollisionEventsEnabled`](crate::plugin::components::CollisionEventsEnabled), with that one as `entity1`.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionStart {
    /// One of the two.
    #[event_target]
    pub entity1: Entity,
    /// The other.
    pub entity2: Entity,
}

/// Two bodies, or a body and a plane, no longer touch, and have not for as long as
/// [`EventHysteresis`](crate::plugin::settings::EventHysteresis) says; told at once if one of them was despawned or rejected.
///
/// Written and triggered like [`CollisionStart`].
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionEnd {
    /// One of the two.
    #[event_target]
    pub entity1: Entity,
    /// The other.
    pub entity2: Entity,
}

/// A body or plane was left out of the step because its components cannot be used. Written once; the body comes back by itself
/// when its components are mended.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct BodyRejected {
    /// The body or plane.
    pub entity: Entity,
    /// What is wrong with it and what to do.
    pub fault: BodyFault,
}
