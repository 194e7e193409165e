//! Colliders of exact meshes that have none.

use super::ExactCollider;
use avian3d::math::{AdjustPrecision, AsF32};
use avian3d::parry::shape::TriMeshBuilderError;
use avian3d::prelude::*;
use bevy::asset::AssetLoadFailedEvent;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;

/// Colliders of meshes: of one mesh they share their shape.
#[derive(Resource, Default)]
pub(super) struct Shapes(HashMap<AssetId<CollisionMesh>, Collider>);

/// The [`Collider`] was made of the mesh, and follows it.
#[derive(Component)]
pub(super) struct MadeFromMesh;

/// The body waits for its mesh.
#[derive(Component)]
#[require(RigidBodyDisabled)]
pub(super) struct AwaitsMesh;

/// An exact collider, and what of it there is.
type Made<'a> = (
    &'a ExactCollider,
    Option<&'a Collider>,
    Has<MadeFromMesh>,
    Has<AwaitsMesh>,
    Has<RigidBody>,
    Has<RigidBodyDisabled>,
);

/// Gives a new exact collider its [`Collider`].
pub(super) fn on_insert(
    inserted: On<Insert, ExactCollider>,
    colliders: Query<Made>,
    meshes: Res<Assets<CollisionMesh>>,
    mut shapes: ResMut<Shapes>,
    mut commands: Commands,
) {
    let entity = inserted.entity;
    let Ok((exact, collider, made, awaits, is_body, disabled)) = colliders.get(entity) else {
        return;
    };
    match (meshes.get(&exact.0), collider) {
        (Some(mesh), Some(collider)) if !made => check(entity, mesh, collider),
        (Some(mesh), _) => shapes.give(entity, exact.0.id(), mesh, awaits, &mut commands),
        (None, None) if is_body && !disabled => {
            commands.entity(entity).insert(AwaitsMesh);
        }
        (None, _) => {}
    }
}

/// Gives colliders to those whose mesh has been loaded, and new ones where it was loaded again.
pub(super) fn follow_assets(
    mut events: MessageReader<AssetEvent<CollisionMesh>>,
    colliders: Query<(Entity, Made)>,
    meshes: Res<Assets<CollisionMesh>>,
    mut shapes: ResMut<Shapes>,
    mut commands: Commands,
) {
    let mut changed = HashSet::new();
    for event in events.read() {
        match event {
            AssetEvent::Added { id } => {
                changed.insert((*id, false));
            }
            AssetEvent::Modified { id } => {
                shapes.0.remove(id);
                changed.insert((*id, true));
            }
            AssetEvent::Removed { id } | AssetEvent::Unused { id } => {
                shapes.0.remove(id);
            }
            AssetEvent::LoadedWithDependencies { .. } => {}
        }
    }
    if changed.is_empty() {
        return;
    }
    for (entity, (exact, collider, made, awaits, ..)) in &colliders {
        let id = exact.0.id();
        let is_new = changed.contains(&(id, false)) && collider.is_none();
        let is_other = changed.contains(&(id, true)) && made;
        if let Some(mesh) = meshes.get(id).filter(|_| is_new || is_other) {
            shapes.give(entity, id, mesh, awaits, &mut commands);
        }
    }
}

/// Names the entities whose mesh cannot be loaded. Bevy's loader has told why.
pub(super) fn tell_failures(
    mut failures: MessageReader<AssetLoadFailedEvent<CollisionMesh>>,
    colliders: Query<(Entity, &ExactCollider)>,
) {
    for failure in failures.read() {
        for (entity, _) in colliders.iter().filter(|(_, exact)| exact.0.id() == failure.id) {
            error!(
                "{entity}: the exact collider has no mesh, because {} cannot be loaded: {}",
                failure.path, failure.error
            );
        }
    }
}

impl Shapes {
    fn give(
        &mut self,
        entity: Entity,
        id: AssetId<CollisionMesh>,
        mesh: &CollisionMesh,
        awaits: bool,
        commands: &mut Commands,
    ) {
        let collider = match self.0.get(&id) {
            Some(collider) => Ok(collider.clone()),
            None => collider(mesh).inspect(|new| {
                self.0.insert(id, new.clone());
            }),
        };
        match collider {
            Ok(collider) => {
                if awaits {
                    // First: Avian does not notice that the body of a collider is enabled again.
                    commands.entity(entity).remove::<(AwaitsMesh, RigidBodyDisabled)>();
                }
                commands.entity(entity).insert((collider, MadeFromMesh));
            }
            Err(error) => error!("{entity}: Avian makes no collider of the exact mesh, which is left out: {error}"),
        }
    }
}

/// Avian's collider of the same triangles.
fn collider(mesh: &CollisionMesh) -> Result<Collider, TriMeshBuilderError> {
    let vertices: Vec<_> = mesh.mesh.vertices().iter().map(|v| v.adjust_precision()).collect();
    let triangles = mesh.mesh.triangles().to_vec();
    // So that bodies of other shapes slide over it too. Meshes whose faces do not fit together have no inside for it.
    Collider::try_trimesh_with_config(vertices.clone(), triangles.clone(), TrimeshFlags::FIX_INTERNAL_EDGES)
        .or_else(|_| Collider::try_trimesh(vertices, triangles))
}

/// Warns of a collider that does not enclose the mesh.
fn check(entity: Entity, mesh: &CollisionMesh, collider: &Collider) {
    let bounds = collider.shape().compute_local_aabb();
    let (low, high) = (bounds.mins.f32(), bounds.maxs.f32());
    let slack = 1.0e-3 * mesh.radius;
    let outside = |v: &&Vec3| !(v.cmpge(low - slack).all() && v.cmple(high + slack).all());
    if let Some(vertex) = mesh.mesh.vertices().iter().find(outside) {
        warn!(
            "{entity}: the collider does not enclose the exact mesh, so contacts will be missed. The vertex {vertex} is \
             outside the collider's box from {low} to {high}. Leave out the collider, and one of the mesh is made"
        );
    }
}
