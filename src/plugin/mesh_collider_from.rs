//! Colliders from Bevy's own meshes: [`MeshColliderFrom`]. Needs the feature `bevy_mesh`.

use crate::asset::CollisionMesh;
use crate::plugin::assets::bevy_mesh::Triangles;
use crate::plugin::components::MeshCollider;
use crate::plugin::sync::named;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on};

/// Adds a [`MeshCollider`] to its entity, made from a Bevy mesh, as soon as that mesh is loaded.
///
/// Each mesh is baked once in the background, however many entities use it. If a mesh is not usable, an error is logged
/// once, and its entities get no collider. The collider does not follow later changes of the mesh; remove the
/// [`MeshCollider`] to have a new one made.
///
/// A bake recipe is better where loading times matter: it loads faster, and can have a face table.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, PartialEq)]
#[require(Transform)]
pub struct MeshColliderFrom(pub Handle<Mesh>);

/// Runs [`MeshColliderFrom`]. In an app without Bevy's `MeshPlugin` it logs an error for each entity with this
/// component.
pub struct MeshColliderFromPlugin;

impl Plugin for MeshColliderFromPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Bakes>()
            .register_type::<MeshColliderFrom>()
            .add_systems(
                Update,
                (
                    make_colliders.run_if(resource_exists::<Assets<Mesh>>),
                    report_no_meshes.run_if(not(resource_exists::<Assets<Mesh>>)),
                ),
            );
    }
}

/// The collider of each Bevy mesh. An entry is dropped when its mesh changes.
#[derive(Resource, Default)]
struct Bakes(HashMap<AssetId<Mesh>, Bake>);

enum Bake {
    Running(Task<Result<CollisionMesh, crate::geometry::MeshError>>),
    Done(Handle<CollisionMesh>),
    Failed,
}

/// Logs an error for each entity that gets no collider because the app has no Bevy meshes.
fn report_no_meshes(waiting: Query<(Entity, Option<&Name>), (Added<MeshColliderFrom>, Without<MeshCollider>)>) {
    for (entity, name) in &waiting {
        error!(
            "{}: its MeshColliderFrom has no effect because there is no Assets<Mesh>: add Bevy's MeshPlugin, which is \
             part of DefaultPlugins, or use a MeshCollider",
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
        // `Added` is no change: the bake may begin before Bevy writes that event.
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
            // The entity may be despawned before the command runs.
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
