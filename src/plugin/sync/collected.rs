//! The colliders, bodies and planes of a step.

use crate::types::body::RigidBody;
use bevy::prelude::*;

/// The colliders, bodies and planes of a step.
#[derive(Default)]
pub(crate) struct Collected {
    /// Entity of each collider, ascending.
    pub entities: Vec<Entity>,
    /// The body of each collider; without a body the collider itself.
    pub bodies: Vec<Entity>,
    /// Kind of the body of each collider.
    pub kinds: Vec<RigidBody>,
    /// Number of bodies.
    pub body_count: usize,
    /// Entity of each plane, ascending.
    pub planes: Vec<Entity>,
}

impl Collected {
    /// The body of a collider, or the plane itself, if it took part.
    pub fn body_of(&self, entity: Entity) -> Option<Entity> {
        match self.entities.binary_search(&entity) {
            Ok(at) => Some(self.bodies[at]),
            Err(_) => self.planes.binary_search(&entity).is_ok().then_some(entity),
        }
    }
}
