//! What scenes and inspectors need of the type registry.

use crate::app::Sim;
use bevy::asset::{HandleTemplate, ReflectAsset, ReflectHandle};
use bevy::prelude::*;
use bevy_faceoff::prelude::*;
use std::any::TypeId;

/// Handles of meshes are saved in scenes by their path, and made of a path.
#[test]
fn handles_of_meshes_are_registered() {
    let mut sim = Sim::new();
    let registry = sim.world().resource::<AppTypeRegistry>().read();
    let mesh = TypeId::of::<CollisionMesh>();
    assert!(registry.get_type_data::<ReflectAsset>(mesh).is_some());
    let handle = registry.get_type_data::<ReflectHandle>(TypeId::of::<Handle<CollisionMesh>>());
    assert_eq!(handle.map(ReflectHandle::asset_type_id), Some(mesh));
    assert!(registry.get(TypeId::of::<HandleTemplate<CollisionMesh>>()).is_some());
}

/// The default plane is the ground.
#[test]
fn the_default_plane_is_the_ground() {
    assert_eq!(PlaneCollider::default(), PlaneCollider::through(Vec3::ZERO, Vec3::Y));
    assert_eq!(PlaneCollider::default().normal, Vec3::Y);
}
