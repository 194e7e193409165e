//! The colliders, bodies and planes of a step.

use super::order::Numbers;
use super::split::Split;
use crate::types::body::RigidBody;
use bevy::prelude::*;
use std::ops::Deref;

/// The colliders, bodies and planes of a step.
#[derive(Default)]
pub(crate) struct Collected {
    pub rows: Rows,
    /// Entity of each plane.
    pub planes: Numbers,
}

/// The colliders of a step, and their bodies.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// Entity of each collider.
    pub entities: Numbers,
    /// The body of each collider; without a body the collider itself.
    pub bodies: Split<Entity>,
    /// Kind of the body of each collider.
    pub kinds: Split<RigidBody>,
    /// Number of static bodies, and of others.
    pub body_counts: [usize; 2],
}

impl Rows {
    /// Removes all, and keeps the memory.
    pub fn clear(&mut self) {
        self.entities.clear();
        self.bodies.clear();
        self.kinds.clear();
        self.body_counts = [0; 2];
    }

    /// What has been added so far is static.
    pub fn end_fixed(&mut self) {
        self.entities.end_fixed();
        self.bodies.end_fixed();
        self.kinds.end_fixed();
    }

    /// Opens what moves again, without those from this number on.
    pub fn reopen(&mut self, count: usize) {
        self.entities.reopen(count);
        self.bodies.reopen(count);
        self.kinds.reopen(count);
    }

    /// To be called after the last one.
    pub fn finish(&mut self) {
        self.entities.finish();
        self.bodies.end_moving();
        self.kinds.end_moving();
    }

    /// Takes the static ones of other rows.
    pub fn begin_moving(&mut self, other: &Self) {
        self.entities.begin_moving(&other.entities);
        self.bodies.begin_moving(&other.bodies);
        self.kinds.begin_moving(&other.kinds);
        self.body_counts = [other.body_counts[0], 0];
    }
}

impl Deref for Collected {
    type Target = Rows;

    fn deref(&self) -> &Rows {
        &self.rows
    }
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
