//! Changes by users since the last step in colliders and bodies that are static or dormant.
//!
//! One scan of Bevy's change ticks, component by component through contiguous memory, takes under a nanosecond for each
//! body and component.

use super::Step;
use super::kept::Kept;
use crate::plugin::components::*;
use crate::types::body::*;
use crate::types::hooks::ActiveCollisionHooks;
use crate::types::material::{Friction, Restitution};
use bevy::ecs::change_detection::ContiguousRef;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// Colliders and bodies.
type IsPart = Or<(With<RigidBody>, With<MeshCollider>)>;

/// What a step reads.
type Read = (
    (Transform, ChildOf, MeshCollider, RigidBody, StableKey),
    (Teleport, Sensor, BodyCulling),
    (Density, Restitution, Friction, CollisionLayers, ActiveCollisionHooks),
    (LinearVelocity, AngularVelocity, Mass, AngularInertia, GravityScale),
    (CenterOfMass, LockedAxes, ExternalForces, ContinuousCollision),
    (LinearDamping, AngularDamping, MaxLinearSpeed, MaxAngularSpeed),
    (Sleeping, SleepingDisabled),
);

/// Notes that a static or dormant entity loses a component that a step reads. Bevy's `RemovedComponents` forget after
/// two frames, and frames may be shorter than steps.
pub(crate) fn note_removed(removed: On<Remove, Read>, step: Option<ResMut<Step>>) {
    if let Some(mut step) = step {
        step.kept.note_removed(removed.entity);
    }
}

/// Notes that something is enabled that no step has read.
pub(crate) fn note_enabled(enabled: On<Remove, (ColliderDisabled, RigidBodyDisabled)>, step: Option<ResMut<Step>>) {
    if let Some(mut step) = step
        && !step.kept.moves(enabled.entity)
    {
        step.kept.forget();
    }
}

/// The changes of one component of colliders and bodies.
#[derive(SystemParam)]
pub(crate) struct Changes<'w, 's, T: Component> {
    all: Query<'w, 's, (Entity, Ref<'static, T>, Option<&'static RigidBody>), IsPart>,
}

impl<T: Component> Changes<'_, '_, T> {
    /// Notes changes of static and of dormant bodies. Returns whether too many static ones have changed.
    fn too_many(&self, kept: &mut Kept) -> bool {
        let Ok(tables) = self.all.contiguous_iter() else {
            return true;
        };
        tables.into_iter().any(|(entities, components, kinds)| {
            any_changed(components, |i| {
                kept.note_written(entities[i], kinds.map(|kinds| kinds[i]))
            })
        })
    }
}

/// Whether `found` holds for a row of a table whose component has changed. Later rows are then not asked.
pub(crate) fn any_changed<T: Component>(components: ContiguousRef<T>, mut found: impl FnMut(usize) -> bool) -> bool {
    let (_, ticks) = ContiguousRef::split(components);
    // Without an early exit, so that the loop uses vector instructions. In most tables nothing has changed.
    if !ticks.is_changed_iter().fold(false, |any, own| any | own) {
        return false;
    }
    let mut changed = ticks
        .is_changed_iter()
        .enumerate()
        .filter(|(_, is_changed)| *is_changed);
    changed.any(|(i, _)| found(i))
}

/// The changes of all components of colliders and bodies that a step reads, except components that the step writes to
/// moving bodies.
#[derive(SystemParam)]
pub(crate) struct ChangesAtRest<'w, 's> {
    place: (
        Changes<'w, 's, Transform>,
        Changes<'w, 's, ChildOf>,
        Changes<'w, 's, MeshCollider>,
        Changes<'w, 's, StableKey>,
        Changes<'w, 's, ColliderDisabled>,
        Changes<'w, 's, RigidBodyDisabled>,
    ),
    surface: (
        Changes<'w, 's, Density>,
        Changes<'w, 's, Restitution>,
        Changes<'w, 's, Friction>,
        Changes<'w, 's, CollisionLayers>,
        Changes<'w, 's, BodyCulling>,
        Changes<'w, 's, ActiveCollisionHooks>,
        Changes<'w, 's, Sensor>,
    ),
    /// What changes nothing about static bodies, but wakes dormant ones.
    motion: (
        Changes<'w, 's, LinearVelocity>,
        Changes<'w, 's, AngularVelocity>,
        Changes<'w, 's, Sleeping>,
    ),
    body: (
        Changes<'w, 's, Mass>,
        Changes<'w, 's, AngularInertia>,
        Changes<'w, 's, GravityScale>,
        Changes<'w, 's, CenterOfMass>,
        Changes<'w, 's, LockedAxes>,
        Changes<'w, 's, ExternalForces>,
    ),
    handling: (
        Changes<'w, 's, LinearDamping>,
        Changes<'w, 's, AngularDamping>,
        Changes<'w, 's, MaxLinearSpeed>,
        Changes<'w, 's, MaxAngularSpeed>,
        Changes<'w, 's, SleepingDisabled>,
        Changes<'w, 's, ContinuousCollision>,
        Changes<'w, 's, Teleport>,
    ),
    /// New bodies, and others whose kind has changed.
    kinds: Query<'w, 's, (Entity, Ref<'static, RigidBody>, Option<Ref<'static, Transform>>)>,
    above: Query<'w, 's, (Option<Ref<'static, Transform>>, Option<Ref<'static, ChildOf>>)>,
}

impl ChangesAtRest<'_, '_> {
    /// Notes changes of static and of dormant bodies. Returns whether all static bodies must be read again: too many
    /// have changed, or an entity above one has.
    pub fn are_many(&self, kept: &mut Kept) -> bool {
        macro_rules! any {
            ($($group:ident: [$($index:tt)*])*) => { false $($(|| self.$group.$index.too_many(kept))*)* };
        }
        let has_changed = any! {
            place: [0 1 2 3 4 5]
            surface: [0 1 2 3 4 5 6]
            body: [0 1 2 3 4 5]
            handling: [0 1 2 3 4 5 6]
        };
        if kept.has_dormant() && any! { motion: [0 1 2] } {
            return true;
        }
        has_changed
            || kept.above.iter().any(|&entity| {
                let Ok((transform, parent)) = self.above.get(entity) else {
                    return true;
                };
                transform.is_some_and(|transform| transform.is_changed())
                    || parent.is_some_and(|parent| parent.is_changed())
            })
    }

    /// Adds new moving bodies to the kept ones. Returns false if another entity has become a body, or a body has
    /// changed its kind.
    pub fn add_movers(&self, kept: &mut Kept) -> bool {
        let Ok(tables) = self.kinds.contiguous_iter() else {
            return false;
        };
        for (entities, kinds, transforms) in tables {
            let (values, ticks) = ContiguousRef::split(kinds);
            if !ticks.is_changed_iter().fold(false, |any, own| any | own) {
                continue;
            }
            let spawned = transforms.map(|transforms| ContiguousRef::split(transforms).1);
            let mut spawned = spawned.iter().flat_map(|ticks| ticks.is_added_iter());
            for ((is_changed, &entity), &kind) in ticks.is_changed_iter().zip(entities).zip(values) {
                let is_spawned = spawned.next() == Some(true);
                if !is_changed {
                    continue;
                }
                let was_mover = kept.movers.binary_search(&entity).is_ok();
                if kind == RigidBody::Static || !was_mover && !is_spawned {
                    return false;
                }
                kept.add_mover(entity);
            }
        }
        true
    }
}
