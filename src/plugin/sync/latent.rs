//! Steps with pending results: which body of the last step each body continues, and what users wrote in the meantime.
//!
//! Bodies are numbered anew in every step, in the order of entities. Each continues from its row in the motions of the
//! last step, where compounds follow the colliders. Results are matched to bodies by entity, so late results cannot
//! reach the wrong body.
//!
//! Writes of users are found by comparing components with a [`Shadow`] of them.

use super::Step;
use super::collected::Collected;
use super::shadow::{Shadow, StateComponent, Written};
use crate::solver::apply_impulses_of;
use crate::state::{Bodies, Motion};
use crate::step::gpu::upload::Carried;
use crate::types::body::{AngularVelocity, LinearVelocity, RigidBody, Sleeping};
use bevy::prelude::*;
use std::collections::{BTreeMap, VecDeque};

/// A body of a step.
#[derive(Clone, Copy)]
pub(crate) struct Row {
    pub entity: Entity,
    pub kind: RigidBody,
    /// Row of the body in the motions of the step.
    pub row: u32,
    /// The number of its first collider.
    pub collider: u32,
}

/// What the components of a body say.
pub(crate) struct ComponentState {
    pub motion: Motion,
    pub asleep: bool,
    /// Whether the body moves by its `Transform`.
    pub driven: bool,
}

/// A pending step.
struct Flight {
    number: u64,
    collected: Collected,
    /// Ascending by entity.
    bodies: Vec<Row>,
}

/// The steps with pending results.
#[derive(Default)]
pub(crate) struct Latent {
    /// Number of the last collected step.
    now: u64,
    /// Whether bodies stay on the device, so that their results are not read.
    resident: bool,
    /// The steps with pending results, oldest first.
    flights: VecDeque<Flight>,
    /// The colliders of the last step, ascending.
    colliders: Vec<Entity>,
    /// The bodies of the last step with their shadows, ascending by entity.
    shadows: Vec<(Row, Shadow)>,
    /// For each row of the last step, the state that the body carries over from the step before.
    pub carried: Vec<Option<Carried>>,
    /// For each row of the last step, whether a user woke the body.
    pub woken: Vec<bool>,
    /// The step whose results came last, with its bodies and the motions of all rows.
    arrived: (u64, Vec<Row>, Vec<Motion>),
}

impl Latent {
    /// Determines which `bodies` of a step, ascending by entity, continue from the step before, and what users wrote.
    /// `colliders` are ascending too, and followed by `compounds` rows. `resident` bodies stay on the device.
    pub fn link(
        &mut self,
        colliders: impl Iterator<Item = Entity>,
        compounds: usize,
        bodies: impl Iterator<Item = (Row, ComponentState)>,
        resident: bool,
    ) {
        self.now += 1;
        self.resident = resident;
        let before = std::mem::take(&mut self.shadows);
        self.colliders.clear();
        self.colliders.extend(colliders);
        let count = self.colliders.len() + compounds;
        self.carried.clear();
        self.carried.resize(count, None);
        self.woken.clear();
        self.woken.resize(count, false);
        let mut last = before.iter().peekable();
        for (body, of_body) in bodies {
            let seen = &of_body.motion;
            while last.next_if(|(other, _)| other.entity < body.entity).is_some() {}
            let row = body.row as usize;
            let shadow = match last.next_if(|(other, _)| other.entity == body.entity) {
                Some(&(source, mut shadow)) => {
                    shadow.drive(of_body.driven);
                    let carried = shadow.carry(source.row, seen, resident);
                    // The component of a body that falls asleep changes only when the results come.
                    self.woken[row] = shadow.wake(of_body.asleep, self.now);
                    shadow.send(seen, &carried, body.kind, self.now);
                    self.carried[row] = Some(carried);
                    shadow
                }
                None => {
                    let mut shadow = Shadow::new(seen, body.kind, self.now);
                    shadow.drive(of_body.driven);
                    self.woken[row] = shadow.wake(of_body.asleep, self.now);
                    shadow
                }
            };
            self.shadows.push((body, shadow));
        }
    }

    /// Applies external impulses to velocities, also to those that carry over. If the rotation carries over, the host
    /// does not know it, and the device applies the angular impulse.
    pub fn apply_impulses(&mut self, bodies: &mut Bodies) {
        for i in 0..bodies.len() {
            let mut row = self.carried.get_mut(bodies.motion_row(i)).and_then(Option::as_mut);
            let knows_rotation = row.as_ref().is_none_or(|row| !row.rotation);
            if let Some([linear, angular]) = apply_impulses_of(bodies, i, knows_rotation)
                && let Some(row) = &mut row
            {
                row.linear.add(linear);
                row.angular.add(angular);
            }
        }
    }

    /// Records that a component of a body was inserted.
    pub fn insert(&mut self, entity: Entity, component: StateComponent) {
        if let Ok(at) = self.shadows.binary_search_by_key(&entity, |(body, _)| body.entity) {
            self.shadows[at].1.insert(component);
        }
    }

    /// Whether the components of a body hold its state after the last step.
    pub fn shows(&self, entity: Entity) -> bool {
        let at = self.shadows.binary_search_by_key(&entity, |(body, _)| body.entity);
        at.map_or(true, |at| self.shadows[at].1.is_known())
    }

    /// Whether a body was in the last step.
    pub fn contains(&self, entity: Entity) -> bool {
        let at = self.shadows.binary_search_by_key(&entity, |(body, _)| body.entity);
        at.is_ok()
    }

    /// The bodies of the last step, and whether their colliders were placed in them.
    pub fn bodies(&self) -> impl Iterator<Item = (&Row, bool)> {
        let is_compound = |body: &Row| body.row as usize >= self.colliders.len();
        self.shadows.iter().map(move |(body, _)| (body, is_compound(body)))
    }

    /// Forgets bodies: if they are in the next step, it receives their whole state from the components.
    pub fn leave(&mut self, leaves: impl Fn(Entity) -> bool) {
        self.shadows.retain(|(body, _)| !leaves(body.entity));
    }

    /// The colliders of the last step, in the order of its rows.
    pub fn colliders(&self) -> impl Iterator<Item = Entity> + '_ {
        self.colliders.iter().copied()
    }

    /// Drops the pending steps. Nothing of them is carried over or published.
    pub fn forget(&mut self) {
        self.flights.clear();
        self.colliders.clear();
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
        self.flights.push_back(Flight {
            number: self.now,
            collected,
            bodies: self.shadows.iter().map(|(body, _)| *body).collect(),
        });
    }

    /// Stores the results of the oldest pending step. Returns its bodies and planes.
    pub fn arrived(&mut self, motions: Vec<Motion>) -> Option<Collected> {
        let flight = self.flights.pop_front()?;
        self.arrived = (flight.number, flight.bodies, motions);
        Some(flight.collected)
    }

    /// Calls `write` for each body of the step whose results came last, with the values for its components.
    /// `asleep` has an entry for each collider.
    pub fn write(&mut self, asleep: &[bool], mut write: impl FnMut(Entity, Written)) {
        let (step, bodies, motions) = &self.arrived;
        let mut shadows = self.shadows.iter_mut().peekable();
        for &Row {
            entity,
            kind,
            row,
            collider,
        } in bodies
        {
            while shadows.next_if(|(other, _)| other.entity < entity).is_some() {}
            let shadow = shadows.next_if(|(other, _)| other.entity == entity);
            if let Some(((_, shadow), motion)) = shadow.zip(motions.get(row as usize)) {
                let asleep = asleep.get(collider as usize) == Some(&true);
                write(entity, shadow.receive(*step, self.now, kind, motion, asleep));
            }
        }
    }

    /// Updates `bodies` from the state of their components to the state after the last step, including what users wrote
    /// since. `motions` has the state of each row after the last step.
    pub fn catch_up(&self, motions: &[Motion], bodies: &mut BTreeMap<Entity, Motion>) {
        for (row, shadow) in &self.shadows {
            if let Some((body, motion)) = bodies.get_mut(&row.entity).zip(motions.get(row.row as usize)) {
                *body = shadow.carry(0, body, self.resident).apply(motion, body);
            }
        }
    }
}

/// Observes inserted components. Inserting writes the whole component, even with equal values.
pub(crate) fn observe(app: &mut App) {
    app.add_observer(|on: On<Insert, Transform>, step: Option<ResMut<Step>>| {
        note(on.entity, step, StateComponent::Pose)
    })
    .add_observer(|on: On<Insert, LinearVelocity>, step: Option<ResMut<Step>>| {
        note(on.entity, step, StateComponent::Linear)
    })
    .add_observer(|on: On<Insert, AngularVelocity>, step: Option<ResMut<Step>>| {
        note(on.entity, step, StateComponent::Angular)
    })
    .add_observer(|on: On<Insert, Sleeping>, step: Option<ResMut<Step>>| {
        note(on.entity, step, StateComponent::Sleeping)
    });
}

fn note(entity: Entity, step: Option<ResMut<Step>>, component: StateComponent) {
    if let Some(mut step) = step {
        step.latent.insert(entity, component);
    }
}
