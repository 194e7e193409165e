//! [`Snapshot`]: saves and restores the state of a simulation.

use crate::manifolds::Manifolds;
use crate::plugin::components::MeshCollider;
use crate::plugin::sync::driven::DrivenBodies;
use crate::plugin::sync::hierarchy::{NestedBodies, world_above};
use crate::plugin::sync::{Step, Touching};
use crate::state::Motion;
use crate::step::StepMemory;
#[cfg(feature = "gpu")]
use crate::step::gpu::memory::DeviceMemory;
use crate::types::body::{AngularVelocity, LinearVelocity, RigidBody, Sleeping};
use bevy::prelude::*;
use std::collections::BTreeMap;

/// The state of the simulation after a step: poses and velocities of all bodies, reported collisions, sleep states, and
/// the solver's memory.
///
/// Steps after [`Snapshot::restore`] repeat those after [`Snapshot::take`] to the bit on the same machine if everything
/// that users set is unchanged: components like [`RigidBody`] and resources like
/// [`Gravity`](crate::plugin::settings::Gravity). A snapshot contains neither these nor the clock. On a GPU with
/// results that come later, the first steps with contacts after `restore` may have other numbers of collision substeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    bodies: BTreeMap<Entity, Motion>,
    touching: Vec<Touching>,
    /// Bodies under other entities.
    nested: NestedBodies,
    /// Kinematic bodies that move by their `Transform`.
    driven: DrivenBodies,
    /// The solver's memory from step to step.
    memory: StepMemory,
    manifolds: Manifolds,
    /// Bodies asleep, ascending.
    asleep: Vec<Entity>,
    /// The memory of a GPU.
    #[cfg(feature = "gpu")]
    device: DeviceMemory,
}

impl Snapshot {
    /// The state after the last step. It waits for pending results of a GPU: with
    /// [`Readback::Latent`](crate::plugin::settings::Readback::Latent) the snapshot is ahead of the components.
    pub fn take(world: &mut World) -> Self {
        let mut bodies: BTreeMap<Entity, Motion> = world
            .query_filtered::<(
                Entity,
                &Transform,
                Option<&LinearVelocity>,
                Option<&AngularVelocity>,
            ), Or<(With<MeshCollider>, With<RigidBody>)>>()
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
        for (&entity, motion) in &mut bodies {
            if let Some(pose) = step.nested.pose(entity) {
                (motion.position, motion.rotation) = pose;
            }
        }
        step.catch_up(&mut bodies);
        let snapshot = Self {
            bodies,
            touching: step.touching.clone(),
            nested: step.nested.clone(),
            driven: step.driven.clone(),
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

    /// Restores the state of all bodies. Pending results of later steps are dropped. Bodies that were spawned since
    /// then keep their state. Returns the bodies that no longer exist.
    pub fn restore(&self, world: &mut World) -> Vec<Entity> {
        let mut gone = Vec::new();
        for (&entity, motion) in &self.bodies {
            let Ok(mut body) = world.get_entity_mut(entity) else {
                gone.push(entity);
                continue;
            };
            if !body.contains::<ChildOf>()
                && let Some(mut transform) = body.get_mut::<Transform>()
            {
                (transform.translation, transform.rotation) = (motion.position, motion.rotation);
            }
            if let Some(mut linear) = body.get_mut::<LinearVelocity>() {
                linear.0 = motion.linear_velocity;
            }
            if let Some(mut angular) = body.get_mut::<AngularVelocity>() {
                angular.0 = motion.angular_velocity;
            }
            if let Some(mut sleeping) = body.get_mut::<Sleeping>() {
                // A component that disagrees with the solver would wake the body.
                sleeping.0 = self.asleep.binary_search(&entity).is_ok();
            }
        }
        self.restore_nested(world);
        if let Some(mut step) = world.get_resource_mut::<Step>() {
            #[cfg(feature = "gpu")]
            step.remember(&self.device);
            #[cfg(not(feature = "gpu"))]
            step.forget();
            step.driven.clone_from(&self.driven);
            step.touching.clone_from(&self.touching);
            step.state.memory.clone_from(&self.memory);
            step.state.results.manifolds.copy_from(&self.manifolds);
        }
        gone
    }

    /// Restores the poses of bodies under other entities, which are in place already.
    fn restore_nested(&self, world: &mut World) {
        let mut nested = self.nested.clone();
        for entity in nested.top_down(world) {
            let Some(motion) = self.bodies.get(&entity) else {
                continue;
            };
            let parent_of = |entity| world.get::<ChildOf>(entity).map(ChildOf::parent);
            let above = world_above(entity, parent_of, |entity| world.get::<Transform>(entity).copied());
            if let Some(mut transform) = world.get_mut::<Transform>(entity) {
                *transform = nested.write(entity, &transform, above, (motion.position, motion.rotation));
            }
        }
        if let Some(mut step) = world.get_resource_mut::<Step>() {
            step.nested = nested;
        }
    }

    /// The bodies with pose and velocities, in the order of entities.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = (Entity, &Motion)> {
        self.bodies.iter().map(|(&entity, motion)| (entity, motion))
    }
}
