//! What users wrote that does not do what it says. It is told once in the log, and the body or plane goes on.

use bevy::prelude::*;
use std::mem::discriminant;
use thiserror::Error;

/// Steps for which a body may be without collider before it is told: a second by default. Scenes and assets come in parts.
pub(crate) const PATIENCE: u32 = 64;

/// What a component does instead of what it says.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub(crate) enum Oddity {
    #[error("its {0} is {1}, and counts as 0: set 0 or more")]
    CountsAsZero(&'static str, f32),
    #[error("its {0} is {1}, and counts as no limit: set 0 or more, or remove it")]
    NoLimit(&'static str, f32),
    #[error("its Restitution is {0}, and counts as 1: more would make energy out of nothing")]
    TooBouncy(f32),
    #[error(
        "it is a RigidBody without a collider, and neither moves nor meets anything: add a MeshCollider (or, with the feature \
         bevy_mesh, a MeshColliderFrom), or remove its RigidBody"
    )]
    NoCollider,
    #[error(
        "it has both a RigidBody and a PlaneCollider, and does not move: planes are fixed in the world. Remove its RigidBody, or \
         give it a MeshCollider instead of the plane"
    )]
    PlaneDoesNotMove,
}

impl Oddity {
    /// Whether it is the same, whatever its number.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::CountsAsZero(this, _), Self::CountsAsZero(that, _))
            | (Self::NoLimit(this, _), Self::NoLimit(that, _)) => this == that,
            _ => discriminant(self) == discriminant(other),
        }
    }
}

/// What was odd in the last step.
#[derive(Default)]
pub(crate) struct Oddities {
    /// Ascending by entity, as are those that follow.
    told: Vec<(Entity, Oddity)>,
    /// Scratch: those of this step.
    found: Vec<(Entity, Oddity)>,
    /// Bodies without collider, and for how many steps.
    bare: Vec<(Entity, u32)>,
}

impl Oddities {
    /// Notes one of this step.
    pub fn add(&mut self, entity: Entity, oddity: Oddity) {
        self.found.push((entity, oddity));
    }

    /// Notes a coefficient or rate that may not be negative.
    pub fn check(&mut self, entity: Entity, name: &'static str, value: Option<f32>) {
        if let Some(value) = value.filter(|&value| value < 0.0) {
            self.add(entity, Oddity::CountsAsZero(name, value));
        }
    }

    /// Notes a speed limit that is none.
    pub fn check_limit(&mut self, entity: Entity, name: &'static str, value: Option<f32>) {
        if let Some(value) = value.filter(|&value| value < 0.0) {
            self.add(entity, Oddity::NoLimit(name, value));
        }
    }

    /// Notes a restitution that is not between 0 and 1.
    pub fn check_restitution(&mut self, entity: Entity, value: Option<f32>) {
        self.check(entity, "Restitution", value);
        if let Some(value) = value.filter(|&value| value > 1.0 && value.is_finite()) {
            self.add(entity, Oddity::TooBouncy(value));
        }
    }

    /// Counts how long these bodies have been without a collider.
    pub fn count_bare(&mut self, bodies: impl Iterator<Item = Entity>) {
        let before = std::mem::take(&mut self.bare);
        self.bare.extend(bodies.map(|entity| {
            let known = before.binary_search_by_key(&entity, |&(entity, _)| entity);
            (entity, known.map_or(1, |at| before[at].1.saturating_add(1)))
        }));
        self.bare.sort_unstable();
        for &(entity, steps) in &self.bare {
            if steps > PATIENCE {
                self.found.push((entity, Oddity::NoCollider));
            }
        }
    }

    /// Ends a step: calls `tell` with what was not there in the last one.
    pub fn tell(&mut self, mut tell: impl FnMut(Entity, Oddity)) {
        let Self { told, found, .. } = self;
        // Stable, so that a body's are told in the order they were found.
        found.sort_by_key(|&(entity, _)| entity);
        for &(entity, oddity) in found.iter() {
            let first = told.partition_point(|&(other, _)| other < entity);
            let mut known = told[first..].iter().take_while(|&&(other, _)| other == entity);
            if !known.any(|(_, known)| known.is_like(&oddity)) {
                tell(entity, oddity);
            }
        }
        std::mem::swap(told, found);
        found.clear();
    }
}
