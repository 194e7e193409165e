//! The state of a simulation, to go back to.

use crate::manifolds::Manifolds;
use crate::plugin::components::MeshCollider;
use crate::plugin::sync::{Step, Touching};
use crate::state::Motion;
use crate::step::StepMemory;
#[cfg(feature = "gpu")]
use crate::step::gpu::contacts::memory::DeviceMemory;
use crate::types::body::{AngularVelocity, LinearVelocity, Sleeping};
use bevy::prelude::*;
use std::collections::BTreeMap;

/// Where all bodies were and how they moved after some step, and which of them were told to touch.
///
/// With what users decide, components like [`RigidBody`](crate::types::body::RigidBody) or resources like
/// [`Gravity`](crate::plugin::settings::Gravity), unchanged, steps after [`Snapshot::restore`] repeat those after
/// [`Snapshot::take`] to the bit on the same machine. What users decide is not part of it, nor is the clock. On a GPU whose
/// results come later, steps with contacts may have other numbers of detection intervals while these come again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    bodies: BTreeMap<Entity, Motion>,
    touching: Vec<Touching>,
    /// What the solver keeps from step to step.
    memory: StepMemory,
    manifolds: Manifolds,
    /// Those that slept, ascending.
    asleep: Vec<Entity>,
    /// What a GPU keeps.
    #[cfg(feature = "gpu")]
    device: DeviceMemory,
}

impl Snapshot {
    /// The state after the last step. If results of steps on a GPU are on their way this waits for them: with
    /// [`Reading::Latent`](crate::plugin::settings::Reading::Latent) the snapshot is ahead of the components.
    pub fn take(world: &mut World) -> Self {
        let mut bodies: BTreeMap<Entity, Motion> = world
            .query_filtered::<(
                Entity,
                &Transform,
                Option<&LinearVelocity>,
                Option<&AngularVelocity>,
            ), With<MeshCollider>>()
            .iter(world)
            .map(|(entity, transform, linear, angular)| {
                let motion = Motion {
                    position: transform.translation,
                    rotation: transform.rotation,
                    linear_velocity: linear.map_or(Vec3::ZERO, |v| v.0),
                    angular_velocity: angular.map_or(Vec3::ZERO, |w| w.0),
                };
                (entity, motion)
            })
            .collect();
        let Some(mut step) = world.get_resource_mut::<Step>() else {
            return Self::default();
        };
        step.catch_up(&mut bodies);
        let snapshot = Self {
            bodies,
            touching: step.touching.clone(),
            memory: step.state.memory.clone(),
            manifolds: step.state.results.manifolds.clone(),
            asleep: Vec::new(),
            #[cfg(feature = "gpu")]
            device: step.device_memory(),
        };
        let mut sleepers = world.query::<(Entity, &Sleeping)>();
        let mut asleep: Vec<_> = (sleepers.iter(world))
            .filter_map(|(entity, sleeping)| sleeping.0.then_some(entity))
            .collect();
        asleep.sort_unstable();
        Self { asleep, ..snapshot }
    }

    /// Puts all bodies where they were. What is on its way of later steps is dropped. Bodies that were spawned since stay
    /// as they are; those that are gone are returned.
    pub fn restore(&self, world: &mut World) -> Vec<Entity> {
        let mut gone = Vec::new();
        for (&entity, motion) in &self.bodies {
            let Ok(mut body) = world.get_entity_mut(entity) else {
                gone.push(entity);
                continue;
            };
            if let Some(mut transform) = body.get_mut::<Transform>() {
                (transform.translation, transform.rotation) = (motion.position, motion.rotation);
            }
            if let Some(mut linear) = body.get_mut::<LinearVelocity>() {
                linear.0 = motion.linear_velocity;
            }
            if let Some(mut angular) = body.get_mut::<AngularVelocity>() {
                angular.0 = motion.angular_velocity;
            }
            if let Some(mut sleeping) = body.get_mut::<Sleeping>() {
                // One that says otherwise than the memory is taken as woken.
                sleeping.0 = self.asleep.binary_search(&entity).is_ok();
            }
        }
        if let Some(mut step) = world.get_resource_mut::<Step>() {
            #[cfg(feature = "gpu")]
            step.remember(&self.device);
            #[cfg(not(feature = "gpu"))]
            step.forget();
            step.touching.clone_from(&self.touching);
            step.state.memory.clone_from(&self.memory);
            step.state.results.manifolds.copy(&self.manifolds);
        }
        gone
    }

    /// The bodies, in the order of entities.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = (Entity, &Motion)> {
        self.bodies.iter().map(|(&entity, motion)| (entity, motion))
    }
}
