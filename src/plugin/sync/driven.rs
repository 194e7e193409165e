//! Kinematic bodies that move by their `Transform`: in each step they go from their last pose to the written one.

use super::oddities::{Oddities, Oddity};
use crate::state::{Bodies, Departure};
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;

/// A body that moves farther than this many of its diameters in one step causes a warning.
const LONG_WAY: f32 = 4.0;

/// The kinematic bodies without velocities. At the end of a step they are where their `Transform`s say.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct DrivenBodies {
    /// The pose of each in the world at the end of the last step, where that is known.
    pub poses: EntityHashMap<(Vec3, Quat)>,
    /// Where those begin that move in this step.
    departures: Vec<(Entity, (Vec3, Quat))>,
    /// Those that have moved very far in one step.
    pub far: EntityHashSet,
}

impl DrivenBodies {
    /// Takes those of the last step, to be replaced by those of this one.
    pub fn take(&mut self) -> Self {
        let far = std::mem::take(&mut self.far);
        let before = std::mem::take(self);
        self.far = far;
        before
    }

    /// Adds a body with its pose in the world; `before` are those of the last step. One that `teleports` does not move
    /// there but is placed.
    pub fn add(&mut self, before: &Self, entity: Entity, pose: (Vec3, Quat), teleports: bool) {
        self.poses.insert(entity, pose);
        if let Some(&start) = before.poses.get(&entity)
            && start != pose
            && !teleports
        {
            self.departures.push((entity, start));
        }
    }

    /// The same without the ways of the last step, which no later step needs.
    pub fn at_rest(&self) -> Self {
        Self {
            poses: self.poses.clone(),
            departures: Vec::new(),
            far: self.far.clone(),
        }
    }

    /// Whether the `Transform` of a body says where it is.
    pub fn contains(&self, entity: Entity) -> bool {
        self.poses.contains_key(&entity)
    }

    /// Forgets bodies that are left out of this step, and notes once each that moves very far in it. `number_of` gives the
    /// number of a body.
    pub fn check(&mut self, bodies: &Bodies, number_of: impl Fn(Entity) -> Option<usize>, oddities: &mut Oddities) {
        self.poses.retain(|&entity, _| number_of(entity).is_some());
        self.far.retain(|entity| self.poses.contains_key(entity));
        for &(entity, (start, _)) in &self.departures {
            let Some(i) = number_of(entity) else { continue };
            let way = bodies.body_motion(i).position.distance(start);
            if way > LONG_WAY * 2.0 * bodies.radius[i] && self.far.insert(entity) {
                oddities.add(entity, Oddity::LongWay(way));
            }
        }
    }

    /// Forgets the poses of bodies that are elsewhere on a device than their components say. These do not move in the next
    /// step, because it is not known from where.
    #[cfg(feature = "gpu")]
    pub fn keep(&mut self, is_there: impl Fn(Entity) -> bool) {
        self.poses.retain(|&entity, _| is_there(entity));
    }

    /// Where bodies begin that move in this step. `number_of` gives the number of a body.
    pub fn departures(&self, number_of: impl Fn(Entity) -> Option<usize>) -> Vec<Departure> {
        let departure = |&(entity, (position, rotation)): &(Entity, (Vec3, Quat))| {
            Some(Departure {
                body: number_of(entity)?,
                position,
                rotation,
            })
        };
        self.departures.iter().filter_map(departure).collect()
    }
}
