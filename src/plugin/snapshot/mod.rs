//! [`Snapshot`]: saves and restores the state of a simulation.

mod characters;
mod map;
mod plain;

use crate::manifolds::Manifolds;
use crate::plugin::components::{DrivenVelocity, MeshCollider};
#[cfg(feature = "interpolation")]
use crate::plugin::interpolation;
use crate::plugin::sync::driven::DrivenBodies;
use crate::plugin::sync::hierarchy::{NestedBodies, world_above};
use crate::plugin::sync::publish::PoseOfStep;
use crate::plugin::sync::{Step, Touching};
use crate::state::Motion;
use crate::step::StepMemory;
#[cfg(feature = "gpu")]
use crate::step::gpu::memory::DeviceMemory;
use crate::types::body::{AngularVelocity, LinearVelocity, RigidBody, Sleeping};
use bevy::prelude::*;
use characters::CharacterState;
use plain::Plain;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The state of the simulation after a step: poses and velocities of all bodies and characters, reported collisions,
/// sleep states, and the solver's memory.
///
/// The [guide](crate::guide::choose_settings#the-same-bits) tells what gives the same bits, also on two machines.
///
/// Steps after [`Snapshot::restore`] repeat those after [`Snapshot::take`] to the bit on the same machine if everything
/// that users set is unchanged: components like [`RigidBody`] and resources like
/// [`Gravity`](crate::plugin::settings::Gravity). A snapshot contains neither these nor the clock. On a GPU with
/// results that come later, the first steps with contacts after `restore` may have other numbers of collision substeps.
///
/// # Saved games, and other worlds
///
/// A snapshot is plain data: it can be written and read with serde. RON and binary formats keep all bits; JSON does
/// not, because serde_json rounds. Damaged data, or data of another format, is an error when it is read, never a panic
/// later. The memory of a GPU is written in the CPU's format: it is valid on any GPU, but the first step on a GPU after
/// reading may differ in the last bits from a step without a snapshot.
///
/// A snapshot holds no bodies, only their states. To save a game, write a scene of the bodies (a `DynamicWorld`), and
/// beside it the snapshot. Bodies of a scene get new entities when it is loaded: let [`MapEntities`] replace those of
/// the snapshot, with the map that `DynamicWorld::write_to_world` filled. Steps continue to the bit if every collider
/// and plane has a [`StableKey`](crate::plugin::components::StableKey), and the scene contains it.
///
/// ```
/// use bevy::ecs::entity::{EntityHashMap, MapEntities};
/// use bevy::prelude::*;
/// use bevy_faceoff::prelude::*;
///
/// /// Text that [`load`] reads.
/// fn save(world: &mut World) -> Result<String> {
///     Ok(ron::to_string(&Snapshot::take(world))?)
/// }
///
/// /// Call it when the scene is in the `world`, and before the next step.
/// fn load(text: &str, world: &mut World, mut entities: EntityHashMap<Entity>) -> Result {
///     let mut snapshot: Snapshot = ron::from_str(text)?;
///     snapshot.map_entities(&mut entities);
///     for body in snapshot.restore(world) {
///         warn!("{body} is in the saved game, but not in the scene");
///     }
///     Ok(())
/// }
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, FaceoffHeadlessPlugins::default()));
/// # app.finish();
/// # let text = save(app.world_mut()).unwrap();
/// # load(&text, app.world_mut(), default()).unwrap();
/// ```
///
/// [`MapEntities`]: bevy::ecs::entity::MapEntities
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "Plain", try_from = "Plain")]
pub struct Snapshot {
    bodies: BTreeMap<Entity, Motion>,
    touching: Vec<Touching>,
    /// Bodies under other entities.
    nested: NestedBodies,
    /// Kinematic bodies that move by their `Transform`.
    driven: DrivenBodies,
    driven_velocities: BTreeMap<Entity, DrivenVelocity>,
    characters: BTreeMap<Entity, CharacterState>,
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
    /// The state after the last step. Waits for pending results of a GPU: with
    /// [`Readback::Latent`](crate::plugin::settings::Readback::Latent) the snapshot is ahead of the components.
    ///
    /// If bodies are interpolated, call it in fixed time, for example in `FixedLast`, because in `Update` it would get
    /// the drawn poses.
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
        let driven_velocities = (world.query::<(Entity, &DrivenVelocity)>().iter(world))
            .map(|(entity, &driven)| (entity, driven))
            .collect();
        let characters = characters::take(world);
        let Some(mut step) = world.get_resource_mut::<Step>() else {
            return Self::default();
        };
        for (&entity, motion) in &mut bodies {
            if let Some(pose) = step.nested.pose(entity) {
                (motion.position, motion.rotation) = pose;
            }
        }
        step.catch_up(&mut bodies);
        let mut snapshot = Self {
            bodies,
            touching: step.touching.all(),
            nested: step.nested.clone(),
            driven: step.driven.at_rest(),
            driven_velocities,
            characters,
            ..default()
        };
        snapshot.take_memory(&mut step);
        let mut sleepers = world.query::<(Entity, &Sleeping)>();
        let mut asleep: Vec<_> = (sleepers.iter(world))
            .filter_map(|(entity, sleeping)| sleeping.0.then_some(entity))
            .collect();
        asleep.sort_unstable();
        Self { asleep, ..snapshot }
    }

    /// Takes the solver's memory from where the steps run.
    fn take_memory(&mut self, step: &mut Step) {
        #[cfg(feature = "gpu")]
        if step.engine.is_on_gpu() {
            self.device = step.device_memory();
            return;
        }
        (self.memory, self.manifolds) = step.state.complete_memory();
    }

    /// Restores the state of all bodies and characters. Pending results of later steps are dropped. Entities that were
    /// spawned since then keep their state. Returns the entities that no longer exist.
    pub fn restore(&self, world: &mut World) -> Vec<Entity> {
        let mut gone = Vec::new();
        for (&entity, motion) in &self.bodies {
            let Ok(mut body) = world.get_entity_mut(entity) else {
                gone.push(entity);
                continue;
            };
            #[cfg(feature = "interpolation")]
            interpolation::show_exact(&mut body);
            if !body.contains::<ChildOf>()
                && let Some(mut transform) = body.get_mut::<Transform>()
            {
                (transform.translation, transform.rotation) = (motion.position, motion.rotation);
                keep_pose(&mut body);
            }
            if let Some(mut linear) = body.get_mut::<LinearVelocity>() {
                linear.0 = motion.linear_velocity;
            }
            if let Some(mut angular) = body.get_mut::<AngularVelocity>() {
                angular.0 = motion.angular_velocity;
            }
            match self.driven_velocities.get(&entity) {
                Some(&driven) => _ = body.insert(driven),
                None => _ = body.remove::<DrivenVelocity>(),
            }
            if let Some(mut sleeping) = body.get_mut::<Sleeping>() {
                // A component that disagrees with the solver would wake the body.
                sleeping.0 = self.asleep.binary_search(&entity).is_ok();
            }
        }
        self.restore_nested(world);
        let gone_characters = characters::restore(&self.characters, world);
        gone.extend(
            gone_characters
                .into_iter()
                .filter(|entity| !self.bodies.contains_key(entity)),
        );
        // These poses come from a step. Writes of others from now on place bodies.
        let written_at = world.increment_change_tick();
        if let Some(mut step) = world.get_resource_mut::<Step>() {
            step.written_at = Some(written_at);
            step.driven.clone_from(&self.driven);
            self.restore_memory(&mut step);
            step.touching.pairs.clone_from(&self.touching);
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
            if let Ok(mut body) = world.get_entity_mut(entity) {
                keep_pose(&mut body);
            }
        }
        if let Some(mut step) = world.get_resource_mut::<Step>() {
            step.nested = nested;
        }
    }

    /// Restores the solver's memory where the steps run, which may be elsewhere than when the snapshot was taken.
    fn restore_memory(&self, step: &mut Step) {
        #[cfg(feature = "gpu")]
        if step.engine.is_on_gpu() {
            if self.memory.keys().is_empty() {
                step.remember(&self.device);
            } else {
                step.remember(&DeviceMemory::from_cpu(&self.memory, &self.manifolds));
            }
            return;
        }
        step.forget();
        step.kept.forget();
        #[cfg(feature = "gpu")]
        if !self.device.is_empty() {
            (step.state.memory, step.state.results.manifolds) = self.device.to_cpu();
            return;
        }
        step.state.memory.clone_from(&self.memory);
        step.state.results.manifolds.copy_from(&self.manifolds);
    }

    /// Converts the memory of a GPU to the CPU's, which is plain data. Manifolds without memory are dropped.
    fn leave_device(&mut self) {
        #[cfg(feature = "gpu")]
        if !self.device.is_empty() {
            (self.memory, self.manifolds) = std::mem::take(&mut self.device).to_cpu();
        }
        if self.memory.keys().is_empty() {
            self.manifolds = Manifolds::default();
        }
    }

    /// Sorts the lists that are searched, and the two halves of each pair.
    fn sort(&mut self) {
        self.asleep.sort_unstable();
        for touching in &mut self.touching {
            *touching = touching.ordered();
        }
        self.touching.sort_unstable_by_key(|touching| touching.pair);
        self.touching.dedup_by_key(|touching| touching.pair);
    }

    /// The bodies with pose and velocities, in the order of entities.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = (Entity, &Motion)> {
        self.bodies.iter().map(|(&entity, motion)| (entity, motion))
    }
}

/// Notes that the pose of a body comes from a step.
fn keep_pose(body: &mut EntityWorldMut) {
    if let Some(&transform) = body.get::<Transform>()
        && let Some(mut pose) = body.get_mut::<PoseOfStep>()
    {
        pose.0 = transform;
    }
}
