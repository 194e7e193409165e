//! What is kept of the last step: its static bodies, and those asleep near which nothing is awake. Where nothing about them has
//! changed, only the others are read again.

use super::children::Child;
use super::collected::Rows;
use super::entity_index_set::EntityIndexSet;
use super::order::Keyed;
use crate::state::Bodies;
use crate::state::revision::Revision;
use crate::types::body::RigidBody;
use crate::types::settings::{Culling, Response};
use bevy::prelude::*;

/// So few bodies at rest are read in less time than it takes to look for changes.
const FEW_ENTITIES: usize = 64;
/// With more bodies that move for each one at rest, to read all takes no longer.
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
    /// All colliders, in the layout with this name.
    pub all_rows: Rows,
    layout: Revision,
    /// Whether the keys of the last step are those of this layout.
    pub has_keys: bool,
    /// The bodies that are not static, ascending, whether or not the step has them.
    pub movers: Vec<Entity>,
    /// Those of them that are not dormant, ascending.
    pub awake: Vec<Entity>,
    /// The dormant ones, in the set with this name.
    dormant: EntityIndexSet,
    dormant_name: Revision,
    /// Whether bodies that move have come, or users have written to dormant ones.
    has_news: bool,
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
        self.layout = Revision::UNKNOWN;
        self.dormant_name = Revision::UNKNOWN;
        self.dormant.clear();
    }

    /// Whether a step with these rules may have the static colliders of `bodies`.
    pub fn may_hold(&self, bodies: &Bodies, rules: ReadRules) -> bool {
        self.revision.is(bodies.revision) && self.rules == rules
    }

    /// Notes which bodies are dormant after the last step.
    pub fn begin(&mut self, bodies: &Bodies) {
        self.has_news = false;
        let set = &bodies.dormant;
        if self.dormant_name.is(set.name) || self.dormant.is_empty() && set.count == 0 {
            return;
        }
        self.dormant.clear();
        self.dormant_name = set.name;
        if self.layout.is(bodies.layout) {
            let flagged = (0..).zip(&set.flags).filter(|(_, flag)| **flag);
            flagged.for_each(|(i, _)| self.dormant.insert(self.all_rows.bodies[i]));
        }
        let dormant = &self.dormant;
        self.awake.clear();
        self.awake
            .extend(self.movers.iter().filter(|&&body| !dormant.contains(body)));
    }

    /// Whether a step with so many bodies may leave dormant ones as they are.
    pub fn may_skip_dormant(&self, body_count: usize) -> bool {
        !self.dormant.is_empty() && !self.has_news && body_count == self.counts[0] + self.movers.len()
    }

    /// Notes that users have written to a body. Returns whether it is static.
    pub fn note_written(&mut self, body: Entity, kind: Option<RigidBody>) -> bool {
        match kind {
            Some(RigidBody::Static) => true,
            Some(_) => {
                self.has_news |= self.dormant.contains(body);
                false
            }
            None => !self.moves(body),
        }
    }

    /// Whether the colliders of `bodies` that are neither static nor dormant are those of the last step.
    pub fn has_same<'a>(&self, bodies: &Bodies, ids: impl ExactSizeIterator<Item = &'a Keyed>) -> bool {
        let own = bodies.movers();
        self.layout.is(bodies.layout)
            && ids.len() == bodies.mover_count()
            && own.zip(ids).all(|(i, id)| self.all_rows.entities.keyed(i) == *id)
    }

    /// Keeps which collider of a step has which number.
    pub fn keep_layout(&mut self, bodies: &mut Bodies, rows: &Rows) {
        bodies.keep_layout();
        self.layout = bodies.layout;
        self.all_rows = rows.clone();
        self.has_keys = false;
    }

    /// Keeps what a step has read: its static colliders, and which of its `children` are parts of `movers`. All of its
    /// colliders are valid. It has `counts` of bodies, colliders by themselves among them, and of colliders below entities;
    /// `asleep` bodies sleep.
    pub fn keep(
        &mut self,
        bodies: &mut Bodies,
        rows: &Rows,
        children: &[Child],
        rules: ReadRules,
        counts: [usize; 2],
        asleep: usize,
    ) {
        let movers = self.movers.len();
        let at_rest = (counts.iter().sum::<usize>() - movers).max(asleep);
        if at_rest <= FEW_ENTITIES || at_rest < movers / MOST_MOVERS {
            return;
        }
        bodies.keep_static();
        self.keep_layout(bodies, rows);
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

    /// Whether this is a static collider, or above one, or a dormant body.
    pub fn is_at_rest(&self, entity: Entity) -> bool {
        self.revision.is_known()
            && (self.dormant.contains(entity)
                || self.rows.entities.number_of(entity).is_some()
                || self.above.binary_search(&entity).is_ok())
    }

    /// Adds a body that moves.
    pub fn add_mover(&mut self, entity: Entity) {
        if let Err(at) = self.movers.binary_search(&entity) {
            self.movers.insert(at, entity);
        }
        self.has_news = true;
    }
}
