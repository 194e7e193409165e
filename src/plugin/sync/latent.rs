//! Steps whose results come later: which body goes on from where, and what users wrote in the meantime.
//!
//! Bodies are numbered anew every step, in the order of entities. A body goes on from its number in the step before, so
//! that slots, and results that reach the wrong one, do not exist: a step in flight knows its bodies by entity.
//!
//! What users wrote is found by comparing components with a [`Shadow`] of them.

use super::shadow::{Part, Shadow, Written};
use super::{Collected, Step};
use crate::state::{Body, Motion};
use crate::step::gpu::upload::Carried;
use crate::step::remap;
use crate::types::body::{AngularVelocity, LinearVelocity, Sleeping};
use bevy::prelude::*;
use std::collections::{BTreeMap, VecDeque};

/// What is known of the steps in flight.
#[derive(Default)]
pub(crate) struct Latent {
    /// Number of the step that was collected last.
    now: u64,
    /// Whether nobody reads its results.
    resident: bool,
    /// Whose results are to come, oldest first.
    flights: VecDeque<(u64, Collected)>,
    /// One per body of the last step, ascending.
    shadows: Vec<(Entity, Shadow)>,
    /// One per body of the last step.
    pub carried: Vec<Option<Carried>>,
    /// One per body of the last step: whether a user woke it.
    pub woken: Vec<bool>,
    /// The step whose results are at hand, and where its bodies are.
    arrived: (u64, Vec<Motion>),
}

impl Latent {
    /// Finds out, for a step over `entities`, which of them go on from the step before, and what users wrote. `bodies` holds
    /// what the components say of these entities, and maybe of others; both are ascending. Nobody reads results of `resident`
    /// bodies.
    pub fn link(&mut self, entities: &[Entity], bodies: &[(Entity, Body)], resident: bool) {
        self.now += 1;
        self.resident = resident;
        let before = std::mem::take(&mut self.shadows);
        let mut sources = remap::numbers_before(before.iter().map(|&(entity, _)| entity), entities.iter().copied());
        let mut bodies = bodies.iter();
        self.carried.clear();
        self.woken.clear();
        for &entity in entities {
            let Some((_, body)) = bodies.find(|&&(other, _)| other == entity) else {
                break;
            };
            let seen = body.motion();
            // Components of those that fall asleep do not say so before their results are there.
            let says_asleep = !body.handling.woken;
            let (shadow, carried, woken) = match sources.next().flatten() {
                Some(source) => {
                    let (_, mut shadow) = before[source as usize];
                    let carried = shadow.carry(source, &seen, resident);
                    let woken = shadow.wake(says_asleep, self.now);
                    shadow.tell(&seen, &carried, body.kind, self.now);
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

    /// A component of a body was inserted anew.
    pub fn insert(&mut self, entity: Entity, part: Part) {
        if let Ok(at) = self.shadows.binary_search_by_key(&entity, |&(entity, _)| entity) {
            self.shadows[at].1.insert(part);
        }
    }

    /// The bodies of the last step.
    pub fn entities(&self) -> impl Iterator<Item = Entity> + '_ {
        self.shadows.iter().map(|&(entity, _)| entity)
    }

    /// Nothing of what is in flight will be carried over or published.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.shadows.clear();
        self.carried.clear();
        self.woken.clear();
    }

    /// Nothing of what is in flight will come, and the step that was linked last begins where the components say.
    pub fn restart(&mut self) {
        self.flights.clear();
        self.carried.clear();
        for (_, shadow) in &mut self.shadows {
            shadow.restart(self.now);
        }
    }

    /// The step that was linked last is on its way.
    pub fn sent(&mut self, collected: Collected) {
        self.flights.push_back((self.now, collected));
    }

    /// The results of the oldest step in flight are there.
    pub fn arrived(&mut self, motions: Vec<Motion>) -> Option<Collected> {
        let (step, collected) = self.flights.pop_front()?;
        self.arrived = (step, motions);
        Some(collected)
    }

    /// Tells for each body of the step whose results are at hand what to write to its components.
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

    /// Brings `bodies` from what their components say to where they are after the last step, with `motions` for each body
    /// of it, and with what users wrote since.
    pub fn catch_up(&self, motions: &[Motion], bodies: &mut BTreeMap<Entity, Motion>) {
        for ((entity, shadow), motion) in self.shadows.iter().zip(motions) {
            if let Some(body) = bodies.get_mut(entity) {
                *body = shadow.carry(0, body, self.resident).apply(motion, body);
            }
        }
    }
}

/// Makes note of components that are inserted, which changes all of them, whatever they held.
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

/// Brings components of bodies that leave the step, but not the world, to where the bodies are: from there they go on when they
/// return.
pub(crate) fn release(
    mut step: ResMut<Step>,
    mut bodies: Query<(
        &mut Transform,
        Option<&mut LinearVelocity>,
        Option<&mut AngularVelocity>,
    )>,
) {
    if step.engine.latent().is_none() {
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
        (transform.translation, transform.rotation) = (motion.position, motion.rotation);
        if let Some(mut linear) = linear {
            linear.0 = motion.linear_velocity;
        }
        if let Some(mut angular) = angular {
            angular.0 = motion.angular_velocity;
        }
    }
}
