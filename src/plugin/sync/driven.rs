//! Kinematic bodies that move by their `Transform`: in each step they go from their last pose to the written one.

use super::component_warnings::{ComponentWarning, ComponentWarnings};
use crate::plugin::components::DrivenVelocity;
use crate::state::{Bodies, Departure};
use crate::types::body::RigidBody;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;

/// A body that moves farther than this multiple of its diameter in one step causes a warning.
const LONG_WAY: f32 = 4.0;

/// The kinematic bodies without velocities. At the end of a step they are where their `Transform`s say.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct DrivenBodies {
    /// The pose of each body in the world at the end of the last step, where it is known.
    pub poses: EntityHashMap<(Vec3, Quat)>,
    /// Start poses of bodies that move in this step.
    departures: Vec<(Entity, (Vec3, Quat))>,
    /// Bodies that have moved very far in one step.
    pub far: EntityHashSet,
    /// Velocities that this step writes to bodies that moved in the last step but not in this one.
    stopped: Vec<(Entity, [Vec3; 2])>,
    /// Velocities of bodies that move in this step.
    moving: Vec<(Entity, [Vec3; 2])>,
}

impl DrivenVelocity {
    /// The velocities `seen` of its body, without values that the step has written.
    pub(crate) fn without(&self, seen: [Vec3; 2]) -> [Vec3; 2] {
        let written = [self.linear, self.angular];
        [0, 1].map(|i| if seen[i] == written[i] { Vec3::ZERO } else { seen[i] })
    }
}

impl DrivenBodies {
    /// Takes the bodies of the last step. This step fills the list again.
    pub fn take(&mut self) -> Self {
        let far = std::mem::take(&mut self.far);
        let before = std::mem::take(self);
        self.far = far;
        before
    }

    /// Adds a body with its pose in the world; `before` are the bodies of the last step. A body that `teleports` is
    /// placed there without a motion.
    pub fn add(&mut self, before: &Self, entity: Entity, pose: (Vec3, Quat), teleports: bool) {
        self.poses.insert(entity, pose);
        if let Some(&start) = before.poses.get(&entity)
            && start != pose
            && !teleports
        {
            self.departures.push((entity, start));
        }
    }

    /// These bodies without their motion in the last step, which no later step needs.
    pub fn at_rest(&self) -> Self {
        Self {
            poses: self.poses.clone(),
            far: self.far.clone(),
            ..Self::default()
        }
    }

    /// The linear and angular velocity of a body whose components hold `seen` and `driven`. Velocities that the step
    /// has written do not count for a kinematic body.
    pub fn velocities(
        &mut self,
        entity: Entity,
        kind: RigidBody,
        seen: [Vec3; 2],
        driven: Option<&DrivenVelocity>,
    ) -> [Vec3; 2] {
        let Some(driven) = driven else {
            return seen;
        };
        let own = if kind == RigidBody::Kinematic {
            driven.without(seen)
        } else {
            seen
        };
        self.stopped.push((entity, own));
        own
    }

    /// Notes with which velocities bodies move in this step.
    pub fn note_velocities(&mut self, velocities_of: impl Fn(Entity) -> Option<[Vec3; 2]>) {
        let moving = (self.departures.iter()).filter_map(|&(entity, _)| Some((entity, velocities_of(entity)?)));
        self.moving = moving.collect();
    }

    /// Calls `write` with the velocities that the components must hold after this step, and whether the body was moved
    /// by its `Transform`.
    pub fn show(&mut self, mut write: impl FnMut(Entity, [Vec3; 2], bool)) {
        for (entity, velocities) in self.stopped.drain(..) {
            write(entity, velocities, false);
        }
        for (entity, velocities) in self.moving.drain(..) {
            write(entity, velocities, true);
        }
    }

    /// Whether the `Transform` of a body says where it is.
    pub fn contains(&self, entity: Entity) -> bool {
        self.poses.contains_key(&entity)
    }

    /// Forgets bodies that are left out of this step, and notes each body that moves very far in it once. `number_of`
    /// gives the number of a body.
    pub fn check(
        &mut self,
        bodies: &Bodies,
        number_of: impl Fn(Entity) -> Option<usize>,
        warnings: &mut ComponentWarnings,
    ) {
        self.poses.retain(|&entity, _| number_of(entity).is_some());
        self.far.retain(|entity| self.poses.contains_key(entity));
        for &(entity, (start, _)) in &self.departures {
            let Some(i) = number_of(entity) else { continue };
            let way = bodies.body_motion(i).position.distance(start);
            if way > LONG_WAY * 2.0 * bodies.radius[i] && self.far.insert(entity) {
                warnings.add(entity, ComponentWarning::LongWay(way));
            }
        }
    }

    /// Forgets the poses of bodies that are elsewhere on a device than their components say. They do not move in the
    /// next step, because their start is unknown.
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
