//! The colliders, bodies and planes of a step.

use super::order::Numbers;
use crate::types::body::RigidBody;
use bevy::prelude::*;
use std::ops::Deref;
use std::sync::Arc;

/// The colliders, bodies and planes of a step.
#[derive(Default)]
pub(crate) struct Collected {
    /// The colliders. Steps with the same ones share the list.
    pub rows: Arc<Rows>,
    /// Entity of each plane.
    pub planes: Numbers,
}

/// The colliders of a step, and their bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// Entity of each collider.
    pub entities: Numbers,
    /// The body of each collider; without a body the collider itself.
    pub bodies: Vec<Entity>,
    /// Kind of the body of each collider.
    pub kinds: Vec<RigidBody>,
    /// Number of bodies.
    pub body_count: usize,
}

impl Deref for Collected {
    type Target = Rows;

    fn deref(&self) -> &Rows {
        &self.rows
    }
}

impl Collected {
    /// An empty list of colliders, to be filled, with the memory of these unless another step has them too.
    pub fn new_rows(&mut self) -> &mut Rows {
        if Arc::get_mut(&mut self.rows).is_none() {
            self.rows = Arc::default();
        }
        let rows = Arc::make_mut(&mut self.rows);
        rows.entities.clear();
        rows.bodies.clear();
        rows.kinds.clear();
        rows.body_count = 0;
        rows
    }

    /// The body of a collider, or the plane itself, if it took part.
    pub fn body_of(&self, entity: Entity) -> Option<Entity> {
        match self.entities.number_of(entity) {
            Some(number) => Some(self.bodies[number]),
            None => self.planes.number_of(entity).map(|_| entity),
        }
    }
}
