//! Triangle meshes of Avian, baked.

use super::collider::MadeFromMesh;
use super::{ExactCollider, ExactTrimesh};
use avian3d::math::AsF32;
use avian3d::parry::shape::{SharedShape, TriMesh as ParryMesh};
use avian3d::prelude::*;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_faceoff::asset::CollisionMesh;
use bevy_faceoff::geometry::{MeshError, TriMesh};

/// The bakes of shapes that are in use.
#[derive(Resource, Default)]
pub(super) struct Bakes(HashMap<Address, Bake>);

/// Where a shape is in memory.
type Address = usize;

struct Bake {
    mesh: AssetId<CollisionMesh>,
    /// Keeps the address from being used again.
    _shape: SharedShape,
}

/// Bakes the meshes of colliders that are new or have changed.
pub(super) fn bake(
    colliders: Query<
        (Entity, &Collider, Option<&ExactCollider>, Option<&MadeFromMesh>),
        (With<ExactTrimesh>, Or<(Changed<Collider>, Added<ExactTrimesh>)>),
    >,
    mut meshes: ResMut<Assets<CollisionMesh>>,
    mut bakes: ResMut<Bakes>,
    mut commands: Commands,
) {
    for (entity, collider, exact, made) in &colliders {
        if made.is_some_and(|made| made.is(collider)) {
            // Its mesh is baked already.
            continue;
        }
        let Some(trimesh) = collider.shape().as_trimesh() else {
            error!(
                "{entity}: `ExactTrimesh` needs a collider that is a triangle mesh, such as `Collider::trimesh`. Its \
                 contacts stay those of Avian"
            );
            commands.entity(entity).remove::<ExactCollider>();
            continue;
        };
        match bakes.mesh(collider.shape(), trimesh, &mut meshes) {
            Ok(mesh) => {
                if exact.is_none_or(|exact| exact.0 != mesh) {
                    commands.entity(entity).insert(ExactCollider(mesh));
                }
            }
            Err(error) => {
                error!("{entity}: the collider's mesh cannot be exact. Its contacts stay those of Avian. {error}");
                commands.entity(entity).remove::<ExactCollider>();
            }
        }
    }
}

/// Forgets bakes that nothing uses.
pub(super) fn forget(mut events: MessageReader<AssetEvent<CollisionMesh>>, mut bakes: ResMut<Bakes>) {
    for event in events.read() {
        if let AssetEvent::Removed { id } | AssetEvent::Unused { id } = event {
            bakes.0.retain(|_, bake| bake.mesh != *id);
        }
    }
}

impl Bakes {
    fn mesh(
        &mut self,
        shape: &SharedShape,
        trimesh: &ParryMesh,
        meshes: &mut Assets<CollisionMesh>,
    ) -> Result<Handle<CollisionMesh>, MeshError> {
        let address = std::ptr::from_ref(trimesh) as Address;
        if let Some(mesh) = self
            .0
            .get(&address)
            .and_then(|bake| meshes.get_strong_handle(bake.mesh))
        {
            return Ok(mesh);
        }
        let vertices = trimesh.vertices().iter().map(|v| v.f32()).collect();
        let mesh = meshes.add(CollisionMesh::new(&TriMesh::new(vertices, trimesh.indices().to_vec())?));
        let bake = Bake {
            mesh: mesh.id(),
            _shape: shape.clone(),
        };
        self.0.insert(address, bake);
        Ok(mesh)
    }
}
