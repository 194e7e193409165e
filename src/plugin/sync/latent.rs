//! Steps with pending results: which body of the last step each body continues, and what users wrote in the meantime.
//!
//! Bodies are numbered anew in every step, in the order of entities, and each continues from its number in the last
//! step. Results are matched to bodies by entity, so late results cannot reach the wrong body.
//!
//! Writes of users are found by comparing components with a [`Shadow`] of them.

use super::Step;
use super::collected::Collected;
use super::shadow::{Part, Shadow, Written};
use crate::state::{Body, Motion};
use crate::step::gpu::upload::Carried;
use crate::step::remap;
use crate::types::body::{AngularVelocity, LinearVelocity, RigidBody, Sleeping};
use bevy::prelude::*;
use std::collections::{BTreeMap, VecDeque};

/// The steps with pending results.
#[derive(Default)]
pub(crate) struct Latent {
    /// Number of the last collected step.
    now: u64,
    /// Whether bodies stay on the device, so that results of theirs are not read.
    resident: bool,
    /// Number, bodies and planes of each step with pending results, oldest first.
    flights: VecDeque<(u64, Collected)>,
    /// The shadow of each body of the last step, ascending by entity.
    shadows: Vec<(Entity, Shadow)>,
    /// For each body of the last step, the state that it carries over from the step before.
    pub carried: Vec<Option<Carried>>,
    /// For each body of the last step, whether a user woke it.
    pub woken: Vec<bool>,
    /// The step whose results came last, and the poses and velocities of its bodies.
    arrived: (u64, Vec<Motion>),
}

impl Latent {
    /// Determines for a step of `entities` which of them continue from the step before, and what users wrote. `bodies`
    /// has the components of these entities, and maybe of others. Both are ascending. `is_driven` says which of them move
    /// by their `Transform`. `resident` bodies stay on the device.
    pub fn link(
        &mut self,
        entities: &[Entity],
        bodies: &[(Entity, Body)],
        is_driven: impl Fn(Entity) -> bool,
        resident: bool,
    ) {
        self.now += 1;
        self.resident = resident;
        let before = std::mem::take(&mut self.shadows);
        let mut sources = remap::previous_numbers(before.iter().map(|&(entity, _)| entity), entities.iter().copied());
        let mut bodies = bodies.iter();
        self.carried.clear();
        self.woken.clear();
        for &entity in entities {
            let Some((_, body)) = bodies.find(|&&(other, _)| other == entity) else {
                break;
            };
            let seen = body.motion();
            // The component of a body that falls asleep changes only when the results come.
            let says_asleep = !body.params.woken;
            let (shadow, carried, woken) = match sources.next().flatten() {
                Some(source) => {
                    let (_, mut shadow) = before[source as usize];
                    shadow.drive(is_driven(entity));
                    let carried = shadow.carry(source, &seen, resident);
                    let woken = shadow.wake(says_asleep, self.now);
                    shadow.send(&seen, &carried, body.kind, self.now);
                    (shadow, Some(carried), woken)
                }
                None => {
                    let mut shadow = Shadow::new(&seen, body.kind, self.now);
                    let woken = shadow.wake(says_asleep, self.now);
                    (shadow, None, woken)
                }
            };
            self.shadows.push((entity, shadow));
            self.carried.push(carried);
            self.woken.push(woken);
        }
    }

    /// Records that a component of a body was inserted.
    pub fn insert(&mut self, entity: Entity, part: Part) {
        if let Ok(at) = self.shadows.binary_search_by_key(&entity, |&(entity, _)| entity) {
            self.shadows[at].1.insert(part);
        }
    }

    /// Whether a body moves by its `Transform`, which holds its current pose.
    pub fn is_driven(&self, entity: Entity) -> bool {
        let at = self.shadows.binary_search_by_key(&entity, |&(entity, _)| entity);
        at.is_ok_and(|at| self.shadows[at].1.is_driven())
    }

    /// The bodies of the last step.
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        self.shadows.iter().map(|&(entity, _)| entity)
    }

    /// Drops the pending steps. Nothing of them is carried over or published.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.shadows.clear();
        self.carried.clear();
        self.woken.clear();
    }

    /// Drops the pending steps after a failure. The step that was linked last starts from the components.
    pub fn restart(&mut self) {
        self.flights.clear();
        self.carried.clear();
        for (_, shadow) in &mut self.shadows {
            shadow.restart(self.now);
        }
    }

    /// Records that the step that was linked last was submitted.
    pub fn sent(&mut self, collected: Collected) {
        self.flights.push_back((self.now, collected));
    }

    /// Stores the results of the oldest pending step. Returns its bodies and planes.
    pub fn arrived(&mut self, motions: Vec<Motion>) -> Option<Collected> {
        let (step, collected) = self.flights.pop_front()?;
        self.arrived = (step, motions);
        Some(collected)
    }

    /// Calls `write` for each body of the step whose results came last, with the values for its components.
    pub fn write(&mut self, of: &Collected, asleep: &[bool], mut write: impl FnMut(Entity, Written)) {
        let (step, motions) = &self.arrived;
        let mut shadows = self.shadows.iter_mut().peekable();
        for (i, ((&entity, &kind), motion)) in of.entities.iter().zip(&of.kinds).zip(motions).enumerate() {
            while shadows.next_if(|(other, _)| *other < entity).is_some() {}
            if let Some((_, shadow)) = shadows.next_if(|(other, _)| *other == entity) {
                let asleep = asleep.get(i) == Some(&true);
                write(entity, shadow.receive(*step, self.now, kind, motion, asleep));
            }
        }
    }

    /// Updates `bodies` from the state of their components to the state after the last step, including what users wrote
    /// since. `motions` has the state of each body after the last step.
    pub fn catch_up(&self, motions: &[Motion], bodies: &mut BTreeMap<Entity, Motion>) {
        for ((entity, shadow), motion) in self.shadows.iter().zip(motions) {
            if let Some(body) = bodies.get_mut(entity) {
                *body = shadow.carry(0, body, self.resident).apply(motion, body);
            }
        }
    }
}

/// Observes inserted components. Inserting writes the whole component, even with equal values.
pub(crate) fn observe(app: &mut App) {
    app.add_observer(|on: On<Insert, Transform>, step: Option<ResMut<Step>>| note(on.entity, step, Part::Pose))
        .add_observer(|on: On<Insert, LinearVelocity>, step: Option<ResMut<Step>>| note(on.entity, step, Part::Linear))
        .add_observer(|on: On<Insert, AngularVelocity>, step: Option<ResMut<Step>>| {
            note(on.entity, step, Part::Angular)
        })
        .add_observer(|on: On<Insert, Sleeping>, step: Option<ResMut<Step>>| note(on.entity, step, Part::Sleeping));
}

fn note(entity: Entity, step: Option<ResMut<Step>>, part: Part) {
    if let Some(mut step) = step {
        step.latent.insert(entity, part);
    }
}

/// Updates the components of bodies that leave the step but stay in the world. If they return, they continue from this
/// state.
pub(crate) fn release(
    mut step: ResMut<Step>,
    mut bodies: Query<
        (
            &mut Transform,
            Option<&mut LinearVelocity>,
            Option<&mut AngularVelocity>,
        ),
        With<RigidBody>,
    >,
    children: Query<(), With<ChildOf>>,
) {
    if !step.engine.is_latent() {
        return;
    }
    let mut leaving = BTreeMap::new();
    for entity in step.latent.entities() {
        if step.collected.entities.binary_search(&entity).is_ok() {
            continue;
        }
        if let Ok((transform, linear, angular)) = bodies.get(entity) {
            let motion = Motion {
                position: transform.translation,
                rotation: transform.rotation,
                linear_velocity: linear.map_or(Vec3::ZERO, |v| v.0),
                angular_velocity: angular.map_or(Vec3::ZERO, |w| w.0),
            };
            leaving.insert(entity, motion);
        }
    }
    if leaving.is_empty() {
        return;
    }
    step.catch_up(&mut leaving);
    for (entity, motion) in leaving {
        let Ok((mut transform, linear, angular)) = bodies.get_mut(entity) else {
            continue;
        };
        // Under other entities it keeps the last published pose, which is in their coordinates.
        if !children.contains(entity) {
            (transform.translation, transform.rotation) = (motion.position, motion.rotation);
        }
        if let Some(mut linear) = linear {
            linear.0 = motion.linear_velocity;
        }
        if let Some(mut angular) = angular {
            angular.0 = motion.angular_velocity;
        }
    }
}
