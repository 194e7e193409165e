//! The colliders, bodies and planes of a step.

use super::order::Numbers;
use crate::types::body::RigidBody;
use bevy::prelude::*;

/// The colliders, bodies and planes of a step.
#[derive(Default)]
pub(crate) struct Collected {
    /// Entity of each collider.
    pub entities: Numbers,
    /// The body of each collider; without a body the collider itself.
    pub bodies: Vec<Entity>,
    /// Kind of the body of each collider.
    pub kinds: Vec<RigidBody>,
    /// Number of bodies.
    pub body_count: usize,
    /// Entity of each plane.
    pub planes: Numbers,
}

impl Collected {
    /// The body of a collider, or the plane itself, if it took part.
    pub fn body_of(&self, entity: Entity) -> Option<Entity> {
        match self.entities.number_of(entity) {
            Some(number) => Some(self.bodies[number]),
            None => self.planes.number_of(entity).map(|_| entity),
        }
    }
}
