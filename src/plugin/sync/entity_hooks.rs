//! Translates between the stages' hooks, which see numbers, and the hooks of an app, which see entities.

use super::collected::{Collected, Rows};
use crate::step::hooks::{NoHooks, PairContacts, StepHooks};
use bevy::prelude::*;

/// Decisions about entities.
pub(crate) trait EntityHooks: Send {
    fn filter_pair(&mut self, colliders: [Entity; 2]) -> bool;

    fn modify_contacts(&mut self, colliders: [Entity; 2], bodies: [Entity; 2], contacts: &mut PairContacts) -> bool;
}

impl EntityHooks for NoHooks {
    fn filter_pair(&mut self, _: [Entity; 2]) -> bool {
        true
    }

    fn modify_contacts(&mut self, _: [Entity; 2], _: [Entity; 2], _: &mut PairContacts) -> bool {
        true
    }
}

/// Hooks for the numbers of a step.
pub(super) struct Numbered<'a> {
    pub hooks: &'a mut dyn EntityHooks,
    pub collected: &'a Collected,
}

impl Numbered<'_> {
    /// A collider and its body, or a plane twice.
    fn entities(&self, number: u32) -> [Entity; 2] {
        let Collected { rows, planes } = self.collected;
        let Rows { entities, bodies, .. } = rows;
        let i = number as usize;
        match i.checked_sub(entities.len()) {
            Some(plane) => [planes[plane]; 2],
            None => [entities[i], bodies[i]],
        }
    }
}

impl StepHooks for Numbered<'_> {
    fn filter_pair(&mut self, pair: [u32; 2]) -> bool {
        let colliders = pair.map(|i| self.entities(i)[0]);
        self.hooks.filter_pair(colliders)
    }

    fn modify_contacts(&mut self, contacts: &mut PairContacts) -> bool {
        let [[collider1, body1], [collider2, body2]] = contacts.pair.map(|i| self.entities(i));
        self.hooks
            .modify_contacts([collider1, collider2], [body1, body2], contacts)
    }
}
