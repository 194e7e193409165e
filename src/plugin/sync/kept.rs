//! The colliders and bodies of the last step. Where this one has the same, only those that move are read again.

use super::collected::Rows;
use super::order::Keyed;
use crate::state::Bodies;
use crate::state::revision::Revision;
use crate::types::body::RigidBody;
use crate::types::settings::{Culling, Response};
use bevy::prelude::*;
use std::sync::Arc;

/// So few bodies and colliders are read in less time than it takes to look for changes.
const FEW: usize = 64;

/// The settings on which what is read of a body depends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ReadRules {
    pub culling: Culling,
    pub response: Response,
    pub has_hooks: bool,
}

/// What is kept of the last step.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    /// The state of the static colliders; unknown if all are to be read again.
    revision: Revision,
    rows: Arc<Rows>,
    /// The bodies that move, each its own collider: their numbers, ascending.
    movers: Vec<u32>,
    /// The entities above others, without repetition.
    pub above: Vec<Entity>,
    /// Numbers of entities with colliders or bodies, and of colliders below others.
    counts: [usize; 2],
    rules: ReadRules,
}

impl Kept {
    /// Forgets the last step.
    pub fn forget(&mut self) {
        self.revision = Revision::UNKNOWN;
    }

    /// Whether a step with these bodies, rules and numbers of entities may have the same colliders.
    pub fn may_hold(&self, bodies: &Bodies, rules: ReadRules, counts: [usize; 2]) -> bool {
        counts[0] > FEW && self.revision.is(bodies.revision) && (self.rules, self.counts) == (rules, counts)
    }

    /// Keeps what a step has read. Its `bodies` that move are their own colliders, and all of its colliders are valid.
    pub fn keep(&mut self, bodies: &mut Bodies, rows: &Arc<Rows>, rules: ReadRules, counts: [usize; 2]) {
        if counts[0] <= FEW {
            return;
        }
        bodies.keep_static();
        self.revision = bodies.revision;
        self.rows = Arc::clone(rows);
        self.movers.clear();
        self.movers.extend(bodies.movers().map(|i| i as u32));
        (self.rules, self.counts) = (rules, counts);
    }

    /// The colliders.
    pub fn rows(&self) -> &Arc<Rows> {
        &self.rows
    }

    /// The numbers of the bodies that move, ascending.
    pub fn movers(&self) -> &[u32] {
        &self.movers
    }

    /// The collider with this number.
    pub fn keyed(&self, number: u32) -> Keyed {
        self.rows.entities.keyed(number as usize)
    }

    /// Whether this is a collider that moves.
    pub fn moves(&self, entity: Entity) -> bool {
        let number = self.rows.entities.number_of(entity);
        number.is_some_and(|number| self.rows.kinds[number] != RigidBody::Static)
    }
}
