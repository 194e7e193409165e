//! Writes results to components, resources, messages and events, after a step.

use super::Step;
use super::hierarchy::{parent_in, sort_top_down, world_above};
use super::touching::CollisionWriters;
use crate::plugin::backend::{ActiveBackend, BackendFailed};
use crate::plugin::collisions::{Collisions, StepReport};
use crate::plugin::components::*;
use crate::plugin::settings::{EventHysteresis, MeasureEnergy};
use crate::state::StepInput;
use crate::types::body::*;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::prelude::*;

/// Sets external impulses to zero, because they act once. Impulses of bodies that were not in the step, for example
/// because their mesh is not loaded yet, wait for the first step with the body.
pub(crate) fn use_up_impulses(step: Res<Step>, mut acted_on: Query<(Entity, &mut ExternalForces)>) {
    if !step.engine.runs() {
        return;
    }
    // Even if results come later, the step has read the impulses.
    for (entity, mut forces) in &mut acted_on {
        if (forces.impulse, forces.angular_impulse) != (Vec3::ZERO, Vec3::ZERO) && step.has_run(entity) {
            (forces.impulse, forces.angular_impulse) = (Vec3::ZERO, Vec3::ZERO);
        }
    }
}

/// Removes the markers [`Teleport`], which the step has read.
pub(crate) fn use_up_teleports(step: Res<Step>, teleported: Query<Entity, With<Teleport>>, mut commands: Commands) {
    if !step.engine.runs() {
        return;
    }
    for entity in &teleported {
        commands.entity(entity).remove::<Teleport>();
    }
}

/// Writes the velocities of bodies that move by their `Transform`. Like their poses they are known before the results.
pub(crate) fn show_driven(
    mut step: ResMut<Step>,
    mut bodies: Query<(
        Option<&mut LinearVelocity>,
        Option<&mut AngularVelocity>,
        Option<&mut DrivenVelocity>,
    )>,
    mut commands: Commands,
) {
    let mut stopped = EntityHashSet::default();
    step.driven.show(|entity, [v, w], is_moved| {
        let Ok((linear, angular, driven)) = bodies.get_mut(entity) else {
            return;
        };
        if let Some(mut linear) = linear {
            linear.set_if_neq(LinearVelocity(v));
        }
        if let Some(mut angular) = angular {
            angular.set_if_neq(AngularVelocity(w));
        }
        if !is_moved {
            stopped.insert(entity);
            return;
        }
        stopped.remove(&entity);
        let now = DrivenVelocity { linear: v, angular: w };
        match driven {
            Some(mut driven) => *driven = now,
            None => _ = commands.entity(entity).insert(now),
        }
    });
    for entity in stopped {
        commands.entity(entity).remove::<DrivenVelocity>();
    }
}

/// Waits for the results of the oldest pending step and publishes them. Returns false if there are none.
pub(crate) fn land(world: &mut World) -> bool {
    if !world.resource_mut::<Step>().land() {
        return false;
    }
    let published = world
        .run_system_cached(write_back)
        .and_then(|()| world.run_system_cached(publish));
    if let Err(error) = published {
        error!("{error}");
    }
    true
}

/// Chooses where the next step runs. If the simulation leaves a device, its pending results are published first, but
/// not written to components, which may hold what users wrote for this step: the step takes the bodies from the device,
/// and writes them when it has run.
pub(crate) fn choose_place(world: &mut World) {
    #[cfg(feature = "gpu")]
    while world.resource::<Step>().leaves_device() && world.resource_mut::<Step>().land() {
        if let Err(error) = world.run_system_cached(publish) {
            error!("{error}");
        }
    }
    world.resource_mut::<Step>().choose_place();
}

/// The `Transform` after the last step, on entities whose `Transform` changes between steps without being placed.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct PoseOfStep(pub Transform);

/// Keeps the poses that the step has written.
#[cfg(feature = "interpolation")]
pub(crate) fn keep_poses(mut poses: Query<(&Transform, &mut PoseOfStep)>) {
    for (transform, mut pose) in &mut poses {
        pose.0 = *transform;
    }
}

/// Tells which `Transform`s others have written since the last step.
#[derive(SystemParam)]
pub(crate) struct WrittenTransforms<'w, 's> {
    transforms: Query<'w, 's, (Ref<'static, Transform>, Option<&'static PoseOfStep>)>,
    ticks: SystemChangeTick,
}

impl WrittenTransforms<'_, '_> {
    /// Whether others have written this entity's `Transform`. The step has written it at `written_at`.
    pub fn contains(&self, entity: Entity, written_at: Tick) -> bool {
        self.transforms.get(entity).is_ok_and(|(transform, pose)| match pose {
            Some(pose) => *transform != pose.0,
            None => transform
                .last_changed()
                .is_newer_than(written_at, self.ticks.this_run()),
        })
    }
}

/// Finds which of the colliders and bodies that touched were placed by others since the last step.
pub(crate) fn find_written(mut step: ResMut<Step>, written: WrittenTransforms) {
    let step = &mut *step;
    if step.has_new_dormant() {
        step.touching.join_dormant();
    }
    step.written.clear();
    let Some(written_at) = step.written_at else { return };
    let touching = step.touching.pairs.iter();
    let touching = touching.flat_map(|touching| [touching.colliders(), touching.bodies].into_iter().flatten());
    let placed = touching.filter(|&entity| written.contains(entity, written_at));
    step.written.extend(placed);
    step.written.sort_unstable();
}

/// Writes poses, velocities and sleep states to components.
pub(crate) fn write_back(
    ticks: SystemChangeTick,
    mut step: ResMut<Step>,
    mut moving: Query<(
        &mut Transform,
        Option<&mut LinearVelocity>,
        Option<&mut AngularVelocity>,
        Option<&mut Sleeping>,
        Option<&mut PoseOfStep>,
    )>,
    parents: Query<&ChildOf>,
) {
    let step = &mut *step;
    step.written_at = Some(ticks.this_run());
    let Some(results) = &step.results else { return };
    // Bodies under other entities are written last, because these may be bodies too.
    let mut nested = Vec::new();
    let mut write = |entity, pose: Option<(Vec3, Quat)>, velocities: Option<[Vec3; 2]>, asleep: Option<bool>| {
        let Ok((mut transform, linear, angular, sleeping, kept)) = moving.get_mut(entity) else {
            return;
        };
        if let Some((mut sleeping, asleep)) = sleeping.zip(asleep) {
            sleeping.set_if_neq(Sleeping(asleep));
        }
        if let Some((translation, rotation)) = pose
            && parents.contains(entity)
        {
            nested.push((entity, (translation, rotation)));
        } else if let Some((translation, rotation)) = pose {
            let scale = transform.scale;
            let written = Transform {
                translation,
                rotation,
                scale,
            };
            transform.set_if_neq(written);
            if let Some(mut kept) = kept {
                kept.0 = written;
            }
        }
        if let Some([v, w]) = velocities {
            if let Some(mut linear) = linear {
                linear.set_if_neq(LinearVelocity(v));
            }
            if let Some(mut angular) = angular {
                angular.set_if_neq(AngularVelocity(w));
            }
        }
    };
    let is_latent = step.engine.is_latent();
    #[cfg(feature = "gpu")]
    if is_latent {
        step.latent.write(&step.state.results.asleep, |entity, written| {
            write(entity, written.pose, written.velocities, written.asleep)
        });
    }
    let bodies = &step.state.input.bodies;
    let movers = if is_latent { None } else { Some(bodies.movers()) };
    for i in movers.into_iter().flatten().filter(|&i| bodies.is_body(i)) {
        let (entity, kind) = (results.bodies[i], results.kinds[i]);
        let motion = bodies.body_motion(i);
        let moves_by_itself = !step.driven.contains(entity);
        write(
            entity,
            moves_by_itself.then_some((motion.position, motion.rotation)),
            (kind == RigidBody::Dynamic).then_some([motion.linear_velocity, motion.angular_velocity]),
            Some(step.state.results.asleep.get(i) == Some(&true)),
        );
    }
    sort_top_down(&mut nested, |&(entity, _)| entity, parent_in(&parents));
    for (entity, pose) in nested {
        let transform_of = |entity| moving.get(entity).ok().map(|(transform, ..)| *transform);
        let above = world_above(entity, parent_in(&parents), transform_of);
        if let Ok((mut transform, .., kept)) = moving.get_mut(entity) {
            let written = step.nested.write(entity, &transform, above, pose);
            transform.set_if_neq(written);
            if let Some(mut kept) = kept {
                kept.0 = written;
            }
        }
    }
}

/// Logs and publishes the failure of a device, if there was one.
pub(crate) fn report_failure(
    mut step: ResMut<Step>,
    mut active: ResMut<ActiveBackend>,
    mut failed: MessageWriter<BackendFailed>,
) {
    if let Some(reason) = step.engine.take_failure() {
        error!("{reason}");
        *active = step.engine.active().clone();
        failed.write(BackendFailed { reason });
    }
}

/// Publishes contacts and the step's report, and tells of collisions that started or ended.
pub(crate) fn publish(
    mut step: ResMut<Step>,
    mut collisions: ResMut<Collisions>,
    mut report: ResMut<StepReport>,
    hysteresis: Res<EventHysteresis>,
    measure_energy: Res<MeasureEnergy>,
    mut writers: CollisionWriters,
) {
    let step = &mut *step;
    (report.in_flight, report.waits) = step.engine.flights();
    if step.results.is_none() {
        return;
    }
    step.warn_of_crowd(report.crowded_bodies);
    step.report(&mut report, **measure_energy);
    step.touch(&mut collisions, seconds(*hysteresis), &mut writers);
    report.total = step.begun.elapsed();
    let Some(results) = &mut step.results else { return };
    std::mem::swap(&mut collisions.contacts, &mut step.state.results.contacts);
    std::mem::swap(&mut collisions.rows, &mut results.rows);
    std::mem::swap(&mut collisions.planes, &mut results.planes);
    // Copied, because the next step reuses the manifolds of bodies asleep.
    collisions.manifolds.copy_from(&step.state.results.manifolds);
}

impl Step {
    /// Logs the first step that leaves pairs out.
    fn warn_of_crowd(&self, before: usize) {
        let Some(results) = &self.results else { return };
        let crowded = self.counts.crowded;
        if crowded > 0 && before == 0 {
            let example = self.state.results.crowd.example as usize;
            error!(
                "{crowded} bodies overlap so many others that the step leaves some of their pairs out; one of them is {} at {}. \
                 Move them apart, despawn some, let their CollisionLayers not meet, or raise StepLimits",
                results.bodies[example], self.state.input.bodies.center[example]
            );
        }
    }

    /// Reports the last step, except its total time.
    fn report(&self, report: &mut StepReport, measure_energy: bool) {
        let (counts, results) = (self.counts, &self.state.results);
        let StepInput { bodies, config, .. } = &self.state.input;
        let energy = (measure_energy && !self.engine.is_latent()).then(|| bodies.energy(config.gravity));
        let body_counts = self.results.as_ref().map_or([0; 2], |results| results.body_counts);
        *report = StepReport {
            step: report.step + 1,
            bodies: body_counts.iter().sum(),
            colliders_read: self.candidates.len() + self.kept.statics_read,
            stages: results.times,
            total: std::time::Duration::ZERO,
            sphere_pairs: counts.sphere_pairs,
            approximate_pairs: counts.approximate_pairs,
            tables_in_bake: self.tables.in_bake(),
            touching_pairs: counts.touching_pairs,
            contact_points: counts.contact_points,
            collision_substeps: results.collision_substeps,
            mean_collision_substeps: results.mean_collision_substeps,
            sleeping: counts.asleep,
            dormant: counts.dormant,
            triangle_tests: counts.triangle_tests,
            face_pairs: counts.face_pairs,
            parallel_stages: self.engine.parallel_stages(),
            crowded_bodies: counts.crowded,
            gpu: results.gpu,
            energy,
            ..*report
        };
    }
}

/// The hysteresis in seconds, 0 or more.
fn seconds(hysteresis: EventHysteresis) -> f32 {
    if hysteresis.is_nan() {
        error_once!(
            "EventHysteresis is NaN, and counts as its default: set it to a number of seconds, 0 to turn it off"
        );
        return *EventHysteresis::default();
    }
    hysteresis.max(0.0)
}
