//! Bodies that wait for the meshes of their colliders.

use super::ExactCollider;
use avian3d::collider_tree::{ColliderTreeProxyFlags, ColliderTreeProxyKey, ColliderTrees, MovedProxies};
use avian3d::dynamics::solver::islands::BodyIslandNode;
use avian3d::dynamics::solver::solver_body::{SolverBody, SolverBodyInertia};
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use std::iter::once;

/// The collider has no mesh yet, and this body waits for it.
#[derive(Component)]
#[relationship(relationship_target = AwaitsMeshes, allow_self_referential)]
pub(super) struct AwaitedBy(Entity);

/// The colliders whose meshes a body waits for.
#[derive(Component)]
#[relationship_target(relationship = AwaitedBy)]
pub(super) struct AwaitsMeshes(Vec<Entity>);

/// The body is disabled because it waits, and nobody else has disabled it.
#[derive(Component)]
pub(super) struct DisabledByWaiting;

pub(super) fn plugin(app: &mut App) {
    app.add_observer(on_place)
        .add_observer(on_settled::<Add, Collider>)
        .add_observer(on_settled::<Remove, ExactCollider>)
        .add_observer(on_wait)
        .add_observer(on_disable)
        .add_observer(on_solver_body)
        .add_observer(on_ready);
}

/// Has the body of each collider without a mesh, at the entity or below it, wait for the mesh.
fn on_place(
    placed: On<Insert, (ExactCollider, ChildOf, RigidBody)>,
    colliders: Query<&ExactCollider, Without<Collider>>,
    bodies: Query<(), With<RigidBody>>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    meshes: Res<Assets<CollisionMesh>>,
    mut commands: Commands,
) {
    for entity in once(placed.entity).chain(children.iter_descendants(placed.entity)) {
        if !colliders.get(entity).is_ok_and(|exact| !meshes.contains(&exact.0)) {
            continue;
        }
        let mut ancestors = once(entity).chain(parents.iter_ancestors(entity));
        if let Some(body) = ancestors.find(|&ancestor| bodies.contains(ancestor)) {
            commands
                .entity(entity)
                .queue_silenced(move |mut collider: EntityWorldMut| {
                    // To insert the same again would enable the body for a moment.
                    if collider.get::<AwaitedBy>().is_none_or(|awaited| awaited.0 != body) {
                        collider.insert(AwaitedBy(body));
                    }
                });
        }
    }
}

/// Ends the wait for a collider that has its mesh, or needs none.
fn on_settled<E: EntityEvent, C: Component>(
    settled: On<E, C>,
    awaited: Query<(), With<AwaitedBy>>,
    mut commands: Commands,
) {
    let collider = settled.event_target();
    if awaited.contains(collider) {
        commands.entity(collider).try_remove::<AwaitedBy>();
    }
}

fn on_wait(waits: On<Add, AwaitsMeshes>, disabled: Query<(), With<RigidBodyDisabled>>, mut commands: Commands) {
    if !disabled.contains(waits.entity) {
        // One after the other: a `RigidBodyDisabled` that comes to a disabled body is the game's.
        commands
            .entity(waits.entity)
            .insert(RigidBodyDisabled)
            .insert(DisabledByWaiting);
    }
}

/// A body that the game disables stays disabled.
fn on_disable(
    disabled: On<Insert, RigidBodyDisabled>,
    waiting: Query<(), With<DisabledByWaiting>>,
    mut commands: Commands,
) {
    if waiting.contains(disabled.entity) {
        commands.entity(disabled.entity).remove::<DisabledByWaiting>();
    }
}

/// If Avian's observer of a new body runs first, Avian makes the solver's body after the body was disabled here. Avian
/// counts on a disabled body having none.
fn on_solver_body(made: On<Add, SolverBody>, waiting: Query<(), With<DisabledByWaiting>>, mut commands: Commands) {
    if waiting.contains(made.entity) {
        commands
            .entity(made.entity)
            .try_remove::<(SolverBody, SolverBodyInertia, BodyIslandNode)>();
    }
}

fn on_ready(ready: On<Remove, AwaitsMeshes>, waiting: Query<(), With<DisabledByWaiting>>, mut commands: Commands) {
    if waiting.contains(ready.entity) {
        commands
            .entity(ready.entity)
            .try_remove::<(RigidBodyDisabled, DisabledByWaiting)>();
        commands.run_system_cached_with(have_pairs, ready.entity);
    }
}

/// Puts the colliders of an enabled body in pairs again. Avian's observer looks too early, when the body is still
/// disabled.
fn have_pairs(
    In(body): In<Entity>,
    bodies: Query<&RigidBodyColliders, Without<RigidBodyDisabled>>,
    keys: Query<&ColliderTreeProxyKey>,
    mut trees: ResMut<ColliderTrees>,
    mut moved: ResMut<MovedProxies>,
) {
    let colliders = bodies.get(body).into_iter().flat_map(|colliders| colliders.iter());
    for &key in colliders.filter_map(|collider| keys.get(collider).ok()) {
        if let Some(proxy) = trees.get_proxy_mut(key) {
            proxy.flags.remove(ColliderTreeProxyFlags::BODY_DISABLED);
            moved.insert(key);
        }
    }
}
