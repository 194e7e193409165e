//! Results to components, resources, messages and events.

use super::Step;
use crate::backend::{ActiveBackend, BackendFailed};
use crate::collisions::{Collisions, StepReport};
use crate::components::*;
use crate::events::{CollisionEnd, CollisionStart};
use bevy::prelude::*;

/// Impulses act once: whenever the results come, the step was told.
pub(crate) fn spend_impulses(step: Res<Step>, mut acted_on: Query<&mut ExternalForces>) {
    if !step.engine.runs() {
        return;
    }
    for mut forces in &mut acted_on {
        if (forces.impulse, forces.angular_impulse) != (Vec3::ZERO, Vec3::ZERO) {
            (forces.impulse, forces.angular_impulse) = (Vec3::ZERO, Vec3::ZERO);
        }
    }
}

/// Moves the bodies in the world.
pub(crate) fn write_back(
    mut step: ResMut<Step>,
    mut moving: Query<(
        &mut Transform,
        Option<&mut LinearVelocity>,
        Option<&mut AngularVelocity>,
        Option<&mut Sleeping>,
    )>,
) {
    let step = &mut *step;
    let Some(results) = &step.results else { return };
    let mut write = |entity, pose: Option<(Vec3, Quat)>, velocities: Option<[Vec3; 2]>, asleep: Option<bool>| {
        let Ok((mut transform, linear, angular, sleeping)) = moving.get_mut(entity) else {
            return;
        };
        if let Some((mut sleeping, asleep)) = sleeping.zip(asleep) {
            sleeping.set_if_neq(Sleeping(asleep));
        }
        if let Some((translation, rotation)) = pose {
            let scale = transform.scale;
            transform.set_if_neq(Transform {
                translation,
                rotation,
                scale,
            });
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
    #[cfg(feature = "gpu")]
    if step.engine.latent().is_some() {
        step.latent.write(results, &step.state.asleep, |entity, written| {
            write(entity, written.pose, written.velocities, written.asleep)
        });
        return;
    }
    for (i, (&entity, &kind)) in results.entities.iter().zip(&results.kinds).enumerate() {
        let motion = step.state.bodies.motion(i);
        write(
            entity,
            (kind != RigidBody::Static).then_some((motion.position, motion.rotation)),
            (kind == RigidBody::Dynamic).then_some([motion.linear_velocity, motion.angular_velocity]),
            Some(step.state.asleep.get(i) == Some(&true)),
        );
    }
}

/// Tells that a device failed.
pub(crate) fn tell_failure(
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

/// Hands out contacts and tells who began and who ceased to touch.
pub(crate) fn publish(
    mut step: ResMut<Step>,
    mut collisions: ResMut<Collisions>,
    mut report: ResMut<StepReport>,
    mut started: MessageWriter<CollisionStart>,
    mut ended: MessageWriter<CollisionEnd>,
    observed: Query<(), With<CollisionEventsEnabled>>,
    mut colliding: Query<(Entity, &mut CollidingEntities)>,
    mut commands: Commands,
) {
    let step = &mut *step;
    (report.in_flight, report.waits) = step.engine.flights();
    let Some(results) = &mut step.results else { return };
    let counts = step.counts;
    *report = StepReport {
        step: report.step + 1,
        bodies: results.entities.len(),
        stages: step.state.times,
        total: std::time::Duration::ZERO,
        sphere_pairs: counts.sphere_pairs,
        approximate_pairs: counts.approximate_pairs,
        tables_in_bake: step.tables.in_bake(),
        touching_pairs: counts.touching_pairs,
        contact_points: counts.contact_points,
        intervals: step.state.intervals,
        sleeping: counts.asleep,
        triangle_tests: counts.triangle_tests,
        face_pairs: counts.face_pairs,
        ..*report
    };

    let contacts = &step.state.contacts;
    let pairs = contacts
        .pairs
        .iter()
        .map(|pair| pair.bodies.map(|i| results.entities[i as usize]));
    let planes = contacts.planes.iter().map(|c| {
        let (body, plane) = (results.entities[c.body as usize], results.planes[c.plane as usize]);
        [body.min(plane), body.max(plane)]
    });
    let touching = &mut step.touching_now;
    touching.clear();
    touching.extend(pairs.chain(planes));
    touching.sort_unstable();

    let mut tell = |pair: [Entity; 2], start: bool| {
        let [entity1, entity2] = pair;
        if start {
            started.write(CollisionStart { entity1, entity2 });
        } else {
            ended.write(CollisionEnd { entity1, entity2 });
        }
        for [entity1, entity2] in [[entity1, entity2], [entity2, entity1]] {
            if observed.contains(entity1) {
                if start {
                    commands.trigger(CollisionStart { entity1, entity2 });
                } else {
                    commands.trigger(CollisionEnd { entity1, entity2 });
                }
            }
        }
    };
    differences(&step.touching, touching, &mut tell);

    if !colliding.is_empty() {
        let both = &mut step.touching_both_ways;
        both.clear();
        both.extend(touching.iter().flat_map(|&[a, b]| [[a, b], [b, a]]));
        both.sort_unstable();
        for (entity, mut list) in &mut colliding {
            let first = both.partition_point(|&[a, _]| a < entity);
            let others = both[first..].iter().take_while(|&&[a, _]| a == entity).map(|&[_, b]| b);
            if !list.iter().copied().eq(others.clone()) {
                list.0.clear();
                list.0.extend(others);
            }
        }
    }
    std::mem::swap(&mut step.touching, &mut step.touching_now);

    report.total = step.begun.elapsed();
    std::mem::swap(&mut collisions.contacts, &mut step.state.contacts);
    std::mem::swap(&mut collisions.entities, &mut results.entities);
    std::mem::swap(&mut collisions.planes, &mut results.planes);
    // The next step reads what those had that sleep.
    collisions.manifolds.copy(&step.state.manifolds);
}

/// Walks two ascending lists and tells what is only in the second (`true`) or only in the first (`false`).
fn differences<T: Ord + Copy>(before: &[T], after: &[T], tell: &mut impl FnMut(T, bool)) {
    let (mut before, mut after) = (before.iter().copied().peekable(), after.iter().copied().peekable());
    loop {
        match (before.peek(), after.peek()) {
            (Some(b), Some(a)) if b == a => {
                before.next();
                after.next();
            }
            (Some(b), a) if a.is_none_or(|a| b < a) => {
                tell(*b, false);
                before.next();
            }
            (_, Some(a)) => {
                tell(*a, true);
                after.next();
            }
            _ => return,
        }
    }
}
