//! What is static of the last step. Where this one has the same, only what moves is read again.

use super::children::Child;
use super::collected::Rows;
use crate::state::Bodies;
use crate::state::revision::Revision;
use crate::types::settings::{Culling, Response};
use bevy::prelude::*;

/// So few static bodies and colliders are read in less time than it takes to look for changes.
const FEW_ENTITIES: usize = 64;
/// With more bodies that move for each one that is static, to read all takes no longer.
const MOST_MOVERS: usize = 4;

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
    /// The static colliders.
    pub rows: Rows,
    /// The bodies that are not static, ascending, whether or not the step has them.
    pub movers: Vec<Entity>,
    /// Their colliders on other entities, by their indices among the
    /// [`ChildColliders`](super::children::ChildColliders).
    pub moving_children: Vec<u32>,
    /// The entities of these, ascending.
    parts: Vec<Entity>,
    /// The entities above static colliders and bodies, without repetition.
    pub above: Vec<Entity>,
    /// Numbers of other bodies and colliders, and of other colliders below entities.
    pub counts: [usize; 2],
    rules: ReadRules,
}

impl Kept {
    /// Forgets the last step.
    pub fn forget(&mut self) {
        self.revision = Revision::UNKNOWN;
    }

    /// Whether a step with these rules may have the static colliders of `bodies`.
    pub fn may_hold(&self, bodies: &Bodies, rules: ReadRules) -> bool {
        self.revision.is(bodies.revision) && self.rules == rules
    }

    /// Keeps what a step has read: its static colliders, and which of its `children` are parts of `movers`. All of its
    /// colliders are valid. It has `counts` of bodies, colliders by themselves among them, and of colliders below entities.
    pub fn keep(&mut self, bodies: &mut Bodies, rows: &Rows, children: &[Child], rules: ReadRules, counts: [usize; 2]) {
        let movers = self.movers.len();
        let fixed = counts.iter().sum::<usize>() - movers;
        if fixed <= FEW_ENTITIES || fixed < movers / MOST_MOVERS {
            return;
        }
        bodies.keep_static();
        self.revision = bodies.revision;
        self.rows.begin_moving(rows);
        self.moving_children.clear();
        self.parts.clear();
        for (at, child) in (0..).zip(children) {
            if child.body.is_some_and(|body| self.movers.binary_search(&body).is_ok()) {
                self.moving_children.push(at);
                self.parts.push(child.collider);
            }
        }
        self.parts.sort_unstable();
        self.counts = [counts[0] - self.movers.len(), counts[1] - self.parts.len()];
        self.rules = rules;
    }

    /// Whether this is a body that moves, or a collider of one.
    pub fn moves(&self, entity: Entity) -> bool {
        self.movers.binary_search(&entity).is_ok() || self.parts.binary_search(&entity).is_ok()
    }

    /// Whether this is a static collider, or above one.
    pub fn is_static(&self, entity: Entity) -> bool {
        self.revision.is_known()
            && (self.rows.entities.number_of(entity).is_some() || self.above.binary_search(&entity).is_ok())
    }

    /// Adds a body that moves.
    pub fn add_mover(&mut self, entity: Entity) {
        if let Err(at) = self.movers.binary_search(&entity) {
            self.movers.insert(at, entity);
        }
    }
}
