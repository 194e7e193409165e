//! The list of rejected bodies.

use crate::plugin::sync::{Step, named};
use bevy::prelude::*;

/// How many are named.
const MOST: usize = 4;

/// Rejected colliders, bodies and planes, in the order in which the panel has seen them.
#[derive(Default)]
pub(super) struct Rejected(Vec<Entity>);

impl Rejected {
    /// The text about entities that are rejected now, newest first. Empty if there are none.
    pub fn text(&mut self, step: Option<&Step>, names: &Query<&Name>) -> String {
        let faults = step.map_or(&[][..], |step| &step.faults);
        let fault_of = |entity: Entity| {
            let at = faults.binary_search_by_key(&entity, |&(entity, _)| entity).ok()?;
            Some(faults[at].1)
        };
        self.0.retain(|&entity| fault_of(entity).is_some());
        for &(entity, _) in faults {
            if !self.0.contains(&entity) {
                self.0.push(entity);
            }
        }
        if faults.is_empty() {
            return String::new();
        }
        let mut text = format!("{} rejected", faults.len());
        for &entity in self.0.iter().rev().take(MOST) {
            if let Some(fault) = fault_of(entity) {
                text += &format!("\n{}: {fault}", named(entity, names.get(entity).ok()));
            }
        }
        if faults.len() > MOST {
            text += &format!("\nand {} more; the log has all", faults.len() - MOST);
        }
        text
    }
}
