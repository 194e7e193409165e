//! Warnings about components without effect. Each is logged once; the body or plane takes part in the step.

use super::order::Keyed;
use crate::types::hooks::ActiveCollisionHooks;
use bevy::prelude::*;
use std::mem::discriminant;
use thiserror::Error;

/// Number of steps after which a body without a collider causes a warning: a second by default. Scenes and assets may
/// load in several parts.
pub(crate) const PATIENCE: u32 = 64;

/// A component whose value has no effect or another one.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub(crate) enum ComponentWarning {
    #[error("its {0} is {1}, and counts as 0: set 0 or more")]
    CountsAsZero(&'static str, f32),
    #[error("its {0} is {1}, and counts as no limit: set 0 or more, or remove it")]
    NoLimit(&'static str, f32),
    #[error("its Restitution is {0}, and counts as 1: more would create energy")]
    TooBouncy(f32),
    #[error(
        "it is a RigidBody without a collider, and neither moves nor collides: add a MeshCollider (or, with the \
         feature bevy_mesh, a MeshColliderFrom), or remove its RigidBody"
    )]
    NoCollider,
    #[error(
        "it has both a RigidBody and a PlaneCollider, and the step does not move it: planes only follow their Transform. \
         Remove its RigidBody, or give it a MeshCollider instead of the plane"
    )]
    PlaneDoesNotMove,
    #[error("it has ActiveCollisionHooks, but the app has no hooks: add a CollisionHooksPlugin")]
    NoHooks,
    #[error(
        "it is kinematic, and its Transform was moved by {0} m in one step: it pushes what is on its way. To place it \
         without that, insert Teleport too"
    )]
    LongWay(f32),
    #[error(
        "its StableKey {0} is that of another one too, and counts for one of them only: give each collider and plane a key \
         of its own. A collider without a key has that of its body"
    )]
    SameKey(u64),
}

impl ComponentWarning {
    /// Whether both are the same warning, regardless of the value.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::CountsAsZero(this, _), Self::CountsAsZero(that, _))
            | (Self::NoLimit(this, _), Self::NoLimit(that, _)) => this == that,
            _ => discriminant(self) == discriminant(other),
        }
    }
}

/// The warnings of the last step. All lists are ascending by entity.
#[derive(Default)]
pub(crate) struct ComponentWarnings {
    /// The warnings of the last step, which are logged already.
    known: Vec<(Entity, ComponentWarning)>,
    /// Scratch: warnings of this step.
    found: Vec<(Entity, ComponentWarning)>,
    /// Bodies without a collider, and for how many steps.
    bare: Vec<(Entity, u32)>,
}

impl ComponentWarnings {
    /// Records a warning of this step.
    pub fn add(&mut self, entity: Entity, warning: ComponentWarning) {
        self.found.push((entity, warning));
    }

    /// Records that a collider or plane has the stable key of another one.
    pub fn add_same_key(&mut self, Keyed { key, entity }: Keyed) {
        self.add(entity, ComponentWarning::SameKey(key));
    }

    /// Records active hooks where the app has none.
    pub fn check_hooks(&mut self, entity: Entity, hooks: Option<&ActiveCollisionHooks>, has_hooks: bool) {
        if !has_hooks && hooks.is_some_and(|&hooks| hooks != ActiveCollisionHooks::NONE) {
            self.add(entity, ComponentWarning::NoHooks);
        }
    }

    /// Records a negative coefficient or rate.
    pub fn check(&mut self, entity: Entity, name: &'static str, value: Option<f32>) {
        if let Some(value) = value.filter(|&value| value < 0.0) {
            self.add(entity, ComponentWarning::CountsAsZero(name, value));
        }
    }

    /// Records a negative speed limit.
    pub fn check_limit(&mut self, entity: Entity, name: &'static str, value: Option<f32>) {
        if let Some(value) = value.filter(|&value| value < 0.0) {
            self.add(entity, ComponentWarning::NoLimit(name, value));
        }
    }

    /// Records a restitution that is not between 0 and 1.
    pub fn check_restitution(&mut self, entity: Entity, value: Option<f32>) {
        self.check(entity, "Restitution", value);
        if let Some(value) = value.filter(|&value| value > 1.0 && value.is_finite()) {
            self.add(entity, ComponentWarning::TooBouncy(value));
        }
    }

    /// Counts the steps for which these bodies have been without a collider.
    pub fn count_bare(&mut self, bodies: impl Iterator<Item = Entity>) {
        let before = std::mem::take(&mut self.bare);
        self.bare.extend(bodies.map(|entity| {
            let known = before.binary_search_by_key(&entity, |&(entity, _)| entity);
            (entity, known.map_or(1, |at| before[at].1.saturating_add(1)))
        }));
        self.bare.sort_unstable();
        for &(entity, steps) in &self.bare {
            if steps > PATIENCE {
                self.found.push((entity, ComponentWarning::NoCollider));
            }
        }
    }

    /// Whether the last step had none.
    pub fn were_none(&self) -> bool {
        self.known.is_empty() && self.bare.is_empty()
    }

    /// Forgets the warnings of this step, which is read again.
    pub fn restart(&mut self) {
        self.found.clear();
    }

    /// Ends a step: calls `report` with each warning that was not there in the last step.
    pub fn report(&mut self, mut report: impl FnMut(Entity, ComponentWarning)) {
        let Self { known, found, .. } = self;
        // A stable sort, so that the warnings of a body keep their order.
        found.sort_by_key(|&(entity, _)| entity);
        for &(entity, warning) in found.iter() {
            let first = known.partition_point(|&(other, _)| other < entity);
            let mut before = known[first..].iter().take_while(|&&(other, _)| other == entity);
            if !before.any(|(_, before)| before.is_like(&warning)) {
                report(entity, warning);
            }
        }
        std::mem::swap(known, found);
        found.clear();
    }
}
