//! Bodies that steps no longer move, but that stay in the world. Their components lag behind the device, and no later
//! result reaches them, so they are brought up to date.

use super::hierarchy::{NestedBodies, parent_in, sort_top_down, world_above};
use super::latent::Row;
use super::{Candidate, Step};
use crate::state::Motion;
use crate::types::body::{AngularVelocity, LinearVelocity, RigidBody};
use bevy::prelude::*;
use std::collections::BTreeMap;

/// Updates the components of bodies that leave, and their data in the next step. If they return, they continue from
/// this state.
pub(crate) fn release(
    mut step: ResMut<Step>,
    mut transforms: Query<&mut Transform>,
    mut bodies: Query<(
        Option<&RigidBody>,
        Option<&mut LinearVelocity>,
        Option<&mut AngularVelocity>,
    )>,
    parents: Query<&ChildOf>,
) {
    let step = &mut *step;
    let last_nested = std::mem::take(&mut step.last_nested);
    if !step.engine.is_latent() {
        return;
    }
    let above = |entity, transforms: &Query<&mut Transform>| {
        let transform_of = |entity| transforms.get(entity).ok().copied();
        world_above(entity, parent_in(&parents), transform_of)
    };
    let mut nested = NestedBodies::default();
    let mut leaving = BTreeMap::new();
    for (body, was_joined) in step.latent.bodies() {
        let entity = body.entity;
        if !step.is_left_by(body, was_joined) {
            continue;
        }
        let (Ok(transform), Ok((kind, linear, angular))) = (transforms.get(entity), bodies.get(entity)) else {
            continue;
        };
        // What has never been a body does not move.
        if kind.is_none() && body.kind == RigidBody::Static {
            continue;
        }
        let (position, rotation) = if parents.contains(entity) {
            // The state that the last step read or wrote, unless users wrote it since.
            let above = above(entity, &transforms);
            let posed = nested.read(&last_nested, entity, body.kind, transform, above);
            (posed.position, posed.rotation)
        } else {
            (transform.translation, transform.rotation)
        };
        let motion = Motion {
            position,
            rotation,
            linear_velocity: linear.map_or(Vec3::ZERO, |v| v.0),
            angular_velocity: angular.map_or(Vec3::ZERO, |w| w.0),
        };
        leaving.insert(entity, motion);
    }
    if leaving.is_empty() {
        return;
    }
    let seen = leaving.clone();
    step.catch_up(&mut leaving);
    let mut places: Vec<_> = leaving.iter().map(|(&entity, motion)| (entity, *motion)).collect();
    sort_top_down(&mut places, |&(entity, _)| entity, parent_in(&parents));
    for (entity, motion) in places {
        let pose = (motion.position, motion.rotation);
        let is_nested = parents.contains(entity);
        let above = is_nested.then(|| above(entity, &transforms));
        if let Ok(mut transform) = transforms.get_mut(entity) {
            if let Some(above) = above {
                let is_read = step.nested.pose(entity).is_some();
                let nested = if is_read { &mut step.nested } else { &mut nested };
                *transform = nested.write(entity, &transform, above, pose);
            } else {
                (transform.translation, transform.rotation) = pose;
            }
        }
        let Ok((_, linear, angular)) = bodies.get_mut(entity) else {
            continue;
        };
        if let Some(mut linear) = linear {
            linear.0 = motion.linear_velocity;
        }
        if let Some(mut angular) = angular {
            angular.0 = motion.angular_velocity;
        }
    }
    let is_body = |entity| bodies.get(entity).is_ok_and(|(kind, ..)| kind.is_some());
    let mut refills = leaving.keys().any(|&entity| step.number_of(entity).is_some());
    if leaving.keys().any(|&entity| !is_body(entity)) {
        // Colliders below what is a body no more are where its components said that it is.
        for Candidate { id, body, .. } in &mut step.candidates {
            let up = std::iter::successors(Some(id.entity), |&entity| parent_in(&parents)(entity));
            let mut above = up.take_while(|&entity| !is_body(entity)).skip(1);
            if let Some(root) = above.find(|entity| leaving.contains_key(entity)) {
                let [from, to] = [&seen[&root], &leaving[&root]];
                let turn = to.rotation * from.rotation.inverse();
                body.position = to.position + turn * (body.position - from.position);
                body.rotation = turn * body.rotation;
                refills = true;
            }
        }
    }
    if refills {
        step.refill(|entity| leaving.get(&entity).copied());
    }
    step.latent.leave(|entity| leaving.contains_key(&entity));
}

impl Step {
    /// Whether the next step neither moves a body of the last one nor gets its pose from the device. `was_joined` says
    /// whether its colliders were placed in it.
    fn is_left_by(&self, body: &Row, was_joined: bool) -> bool {
        let Some(number) = self.number_of(body.entity) else {
            return true;
        };
        match self.assembly(body.entity) {
            // Colliders of a static body are placed by its components.
            Some(assembly) => assembly.compound.is_none() && (was_joined || body.kind != RigidBody::Static),
            None => was_joined && self.collected.kinds[number] == RigidBody::Static,
        }
    }
}
