//! Colliders of exact meshes that have none.

use super::ExactCollider;
use avian3d::math::{AdjustPrecision, AsF32};
use avian3d::parry::shape::{SharedShape, TriMeshBuilderError};
use avian3d::prelude::*;
use bevy::asset::AssetLoadFailedEvent;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::lifetimeless::Read;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{Orientation, TriMesh};
use std::sync::Arc;

/// The collider of each mesh. Entities with the same mesh share its shape.
#[derive(Resource, Default)]
pub(super) struct Shapes(HashMap<AssetId<CollisionMesh>, Collider>);

/// The shape that was made of a mesh. A [`Collider`] with this very shape follows the mesh; another one is the game's.
#[derive(Component)]
pub(super) struct MadeFromMesh(SharedShape);

impl MadeFromMesh {
    pub(super) fn is(&self, collider: &Collider) -> bool {
        Arc::ptr_eq(&self.0.0, &collider.shape().0)
    }
}

/// The mesh that the [`Collider`] was made of or compared with.
#[derive(Component)]
pub(super) struct Settled(AssetId<CollisionMesh>);

/// An exact collider, with those of its components that exist.
#[derive(QueryData)]
pub(super) struct Parts {
    entity: Entity,
    exact: Read<ExactCollider>,
    collider: Option<Read<Collider>>,
    settled: Option<Read<Settled>>,
    made: Option<Read<MadeFromMesh>>,
}

/// Gives a new exact collider its [`Collider`], if the mesh is there.
pub(super) fn on_insert(
    inserted: On<Insert, ExactCollider>,
    colliders: Query<Parts>,
    meshes: Res<Assets<CollisionMesh>>,
    mut shapes: ResMut<Shapes>,
    mut commands: Commands,
) {
    let Ok(parts) = colliders.get(inserted.entity) else {
        return;
    };
    if let Some(mesh) = meshes.get(&parts.exact.0) {
        shapes.settle(&parts, mesh, &mut commands);
    }
}

/// Gives colliders to entities whose mesh has been loaded, and new ones if it was loaded again.
pub(super) fn follow_assets(
    mut events: MessageReader<AssetEvent<CollisionMesh>>,
    colliders: Query<Parts>,
    meshes: Res<Assets<CollisionMesh>>,
    mut shapes: ResMut<Shapes>,
    mut commands: Commands,
) {
    let (mut added, mut modified) = (HashSet::new(), HashSet::new());
    for event in events.read() {
        match event {
            AssetEvent::Added { id } => {
                added.insert(*id);
            }
            AssetEvent::Modified { id } => {
                shapes.0.remove(id);
                modified.insert(*id);
            }
            AssetEvent::Removed { id } | AssetEvent::Unused { id } => {
                shapes.0.remove(id);
            }
            AssetEvent::LoadedWithDependencies { .. } => {}
        }
    }
    if added.is_empty() && modified.is_empty() {
        return;
    }
    for parts in &colliders {
        let id = parts.exact.0.id();
        let is_new = added.contains(&id) && parts.settled.is_none_or(|settled| settled.0 != id);
        if let Some(mesh) = meshes.get(id).filter(|_| is_new || modified.contains(&id)) {
            shapes.settle(&parts, mesh, &mut commands);
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
    /// Makes the collider of the mesh, or checks a collider that was not made of it.
    fn settle(&mut self, parts: &PartsItem, mesh: &CollisionMesh, commands: &mut Commands) {
        let (entity, id) = (parts.entity, parts.exact.0.id());
        let mut commands = commands.entity(entity);
        commands.insert(Settled(id));
        let is_made = |collider: &Collider| parts.made.is_some_and(|made| made.is(collider));
        if let Some(collider) = parts.collider.filter(|collider| !is_made(collider)) {
            check(entity, mesh, collider);
            return;
        }
        match self.of(id, mesh) {
            Ok(collider) => {
                let made = MadeFromMesh(collider.shape().clone());
                commands.insert((collider, made));
            }
            Err(error) => error!("{entity}: Avian makes no collider of the exact mesh, which is left out: {error}"),
        }
    }

    /// The collider of a mesh.
    fn of(&mut self, id: AssetId<CollisionMesh>, mesh: &CollisionMesh) -> Result<Collider, TriMeshBuilderError> {
        if let Some(collider) = self.0.get(&id) {
            return Ok(collider.clone());
        }
        let new = collider(mesh)?;
        self.0.insert(id, new.clone());
        Ok(new)
    }
}

/// Avian's collider of the same triangles.
fn collider(mesh: &CollisionMesh) -> Result<Collider, TriMeshBuilderError> {
    let vertices = mesh.mesh.vertices().iter().map(|v| v.adjust_precision()).collect();
    let flags = if is_one_sided(&mesh.mesh) {
        // So that bodies of other shapes slide over it too.
        TrimeshFlags::FIX_INTERNAL_EDGES
    } else {
        // With the flag parry drops contacts behind faces, and an open mesh may be hit from there.
        TrimeshFlags::empty()
    };
    Collider::try_trimesh_with_config(vertices, mesh.mesh.triangles().to_vec(), flags)
}

/// Whether nothing can come from behind the faces of the mesh.
fn is_one_sided(mesh: &TriMesh) -> bool {
    (mesh.is_solid() || mesh.is_room()) && mesh.orientation() != Orientation::Mixed
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
