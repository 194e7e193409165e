//! Colliders made of what is drawn: [`MeshColliderFrom`]. Needs the feature `bevy_mesh`.

use crate::asset::CollisionMesh;
use crate::plugin::assets::bevy_mesh::Triangles;
use crate::plugin::components::MeshCollider;
use crate::plugin::sync::named;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on};

/// Gives its entity a [`MeshCollider`] of a Bevy mesh as soon as that mesh is loaded.
///
/// Baking happens in the background, once for each mesh, however many entities name it. A mesh that cannot collide is
/// reported once in the log, and its entities stay without collider. The collider stays what it is when the mesh changes
/// later; remove the [`MeshCollider`] to have it made anew.
///
/// For meshes whose collisions matter a recipe is better: it loads faster, and can have a face table.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, PartialEq)]
#[require(Transform)]
pub struct MeshColliderFrom(pub Handle<Mesh>);

/// Runs [`MeshColliderFrom`]. Where there are no Bevy meshes, for want of Bevy's `MeshPlugin`, an error in the log tells of every
/// entity with one.
pub struct MeshColliderFromPlugin;

impl Plugin for MeshColliderFromPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Bakes>()
            .register_type::<MeshColliderFrom>()
            .add_systems(
                Update,
                (
                    make_colliders.run_if(resource_exists::<Assets<Mesh>>),
                    tell.run_if(not(resource_exists::<Assets<Mesh>>)),
                ),
            );
    }
}

/// The meshes that colliders were made of, for as long as they stay as they are.
#[derive(Resource, Default)]
struct Bakes(HashMap<AssetId<Mesh>, Bake>);

enum Bake {
    Running(Task<Result<CollisionMesh, crate::geometry::MeshError>>),
    Done(Handle<CollisionMesh>),
    Failed,
}

/// Tells of those that stay without collider.
fn tell(waiting: Query<(Entity, Option<&Name>), (Added<MeshColliderFrom>, Without<MeshCollider>)>) {
    for (entity, name) in &waiting {
        error!(
            "{}: its MeshColliderFrom gives it no collider, since there is no Assets<Mesh>: add Bevy's MeshPlugin, which \
             DefaultPlugins has, or use a MeshCollider",
            named(entity, name)
        );
    }
}

fn make_colliders(
    mut commands: Commands,
    mut bakes: ResMut<Bakes>,
    mut changes: MessageReader<AssetEvent<Mesh>>,
    meshes: Res<Assets<Mesh>>,
    mut baked: ResMut<Assets<CollisionMesh>>,
    waiting: Query<(Entity, &MeshColliderFrom), Without<MeshCollider>>,
) {
    for change in changes.read() {
        // Whatever was made of it is out of date. Being added is no change: the bake may have begun before Bevy says so.
        if let AssetEvent::Modified { id } | AssetEvent::Removed { id } = change {
            bakes.0.remove(id);
        }
    }
    for (entity, MeshColliderFrom(handle)) in &waiting {
        let id = handle.id();
        if !bakes.0.contains_key(&id) {
            let Some(mesh) = meshes.get(id) else { continue };
            bakes.0.insert(id, begin(handle, mesh));
        }
        let Some(bake) = bakes.0.get_mut(&id) else { continue };
        if let Bake::Running(task) = bake
            && task.is_finished()
        {
            *bake = match block_on(task) {
                Ok(mesh) => Bake::Done(baked.add(mesh)),
                Err(error) => {
                    error!("{} cannot collide: {error}", name(handle));
                    Bake::Failed
                }
            };
        }
        if let Bake::Done(mesh) = bake {
            // The entity may be despawned by then.
            commands.entity(entity).try_insert(MeshCollider(mesh.clone()));
        }
    }
}

fn begin(handle: &Handle<Mesh>, mesh: &Mesh) -> Bake {
    match Triangles::of(mesh) {
        Ok(triangles) => {
            let name = name(handle);
            let bake = async move {
                let mesh = CollisionMesh::new(&triangles.into_mesh()?);
                for warning in mesh.warnings() {
                    warn!("{name}: {warning}");
                }
                Ok(mesh)
            };
            Bake::Running(AsyncComputeTaskPool::get_or_init(default).spawn(bake))
        }
        Err(error) => {
            error!("{} cannot collide: {error}", name(handle));
            Bake::Failed
        }
    }
}

fn name(handle: &Handle<Mesh>) -> String {
    handle
        .path()
        .map_or_else(|| format!("mesh {:?}", handle.id()), |path| path.to_string())
}
