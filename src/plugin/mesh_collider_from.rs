//! Colliders from Bevy's own meshes: [`MeshColliderFrom`]. Needs the feature `bevy_mesh`.

use crate::plugin::assets::MeshBakeError;
use crate::plugin::assets::mesh_bakes::{BakeAssets, MeshBakes, Source};
use crate::plugin::components::{ColliderToCome, MeshCollider};
use crate::plugin::sync::named;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use std::task::Poll;

/// Adds a [`MeshCollider`] to its entity, made from a Bevy mesh, as soon as that mesh is loaded.
///
/// Each mesh is baked once in the background, however many entities use it. If a mesh is not usable, an error is logged
/// once, and its entities get no collider. With `Handle::default()` an entity gets its collider once another handle is
/// set. On a child it is part of the body above, like any [`MeshCollider`]. The collider does not follow later changes
/// of the mesh; remove the [`MeshCollider`] to have a new one made.
///
/// A saved scene does not contain a collider that was made here, but this component: the collider is made again.
///
/// A bake recipe is better where loading times matter: it loads faster, and can have a face table.
#[derive(Component, Reflect, FromTemplate, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Debug, PartialEq)]
#[require(Transform, ColliderToCome)]
pub struct MeshColliderFrom(pub Handle<Mesh>);

/// Runs [`MeshColliderFrom`]. In an app without Bevy's `MeshPlugin` it logs an error for each entity with this
/// component.
pub struct MeshColliderFromPlugin;

impl Plugin for MeshColliderFromPlugin {
    fn build(&self, app: &mut App) {
        MeshBakes::register(app);
        app.register_type::<MeshColliderFrom>()
            .add_systems(PreUpdate, forget_unsaved)
            .add_systems(
                Update,
                (
                    make_colliders.run_if(resource_exists::<Assets<Mesh>>),
                    report_no_meshes.run_if(not(resource_exists::<Assets<Mesh>>)),
                ),
            );
    }
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

/// Removes colliders without a mesh. A scene is saved without meshes made here, and has the default handle instead.
fn forget_unsaved(
    mut commands: Commands,
    loaded: Query<(Entity, &MeshCollider), (With<MeshColliderFrom>, Changed<MeshCollider>)>,
) {
    for (entity, collider) in &loaded {
        if collider.0 == Handle::default() {
            commands.entity(entity).try_remove::<MeshCollider>();
        }
    }
}

fn make_colliders(
    mut commands: Commands,
    mut bakes: ResMut<MeshBakes>,
    mut assets: BakeAssets,
    // Meshes whose error is in the log.
    mut told: Local<HashSet<AssetId<Mesh>>>,
    waiting: Query<(Entity, Ref<MeshColliderFrom>, Option<&Name>), Without<MeshCollider>>,
) {
    told.retain(|id| !bakes.changed.contains(id));
    for (entity, from, name) in &waiting {
        let handle = &from.0;
        let source = Source::of(handle);
        match bakes.get(&source, &mut assets) {
            Poll::Pending => {}
            // The entity may be despawned before the command runs.
            Poll::Ready(Ok(mesh)) => {
                commands.entity(entity).try_insert(MeshCollider(mesh));
            }
            Poll::Ready(Err(MeshBakeError::NoMesh)) => {
                if from.is_changed() {
                    error!(
                        "{}: its MeshColliderFrom has the default handle, that of no mesh: it gets no collider until \
                         another is set",
                        named(entity, name)
                    );
                }
            }
            Poll::Ready(Err(error)) => {
                if told.insert(handle.id()) {
                    error!("{} cannot collide: {error}", source.name());
                }
            }
        }
    }
}
