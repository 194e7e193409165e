//! Where colliders and bodies are in the world.

use crate::asset::CollisionMesh;
use crate::plugin::components::{ColliderDisabled, MeshCollider, RigidBodyDisabled, Sensor};
use crate::plugin::sync::Step;
use crate::plugin::sync::hierarchy::{self, Ancestor, Node, Placed, affine, decompose, parent_in, place};
use crate::types::body::{RigidBody, Sleeping};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::{DAffine3, DMat3};
use bevy::prelude::*;

/// Poses as the step computes them from `Transform`s.
#[derive(SystemParam)]
pub(crate) struct WorldPoses<'w, 's> {
    step: Option<Res<'w, Step>>,
    meshes: Option<Res<'w, Assets<CollisionMesh>>>,
    colliders: Query<'w, 's, ColliderComponents>,
    sleeping: Query<'w, 's, &'static Sleeping>,
    nodes: Query<'w, 's, Node>,
    parents: Query<'w, 's, &'static ChildOf>,
    transforms: Query<'w, 's, &'static Transform>,
}

#[derive(QueryData)]
pub(crate) struct ColliderComponents {
    entity: Entity,
    mesh: &'static MeshCollider,
    transform: &'static Transform,
    parent: Option<&'static ChildOf>,
    is_body: Has<RigidBody>,
    is_sensor: Has<Sensor>,
    is_disabled: Has<ColliderDisabled>,
    body_disabled: Has<RigidBodyDisabled>,
}

/// A collider in the world.
pub(crate) struct PlacedCollider<'a> {
    /// Without a body, the collider itself.
    pub body: Entity,
    /// The mesh that collides: a copy with the shear if the collider is sheared.
    pub mesh: &'a CollisionMesh,
    /// Where the mesh is.
    pub placed: Placed,
    /// From coordinates of the mesh.
    pub to_world: DAffine3,
    pub state: ColliderState,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColliderState {
    Awake,
    Asleep,
    Sensor,
    /// Disabled, rejected, or its sheared copy is not baked yet.
    LeftOut,
}

impl PlacedCollider<'_> {
    /// Radius of the bounding sphere about the mesh's centre of mass, metres.
    pub fn radius(&self) -> f32 {
        self.mesh.radius * self.placed.scale.abs().max_element()
    }

    /// A point of the mesh in the world.
    pub fn in_world(&self, point: Vec3) -> Vec3 {
        self.to_world.transform_point3(point.as_dvec3()).as_vec3()
    }
}

impl WorldPoses<'_, '_> {
    /// All colliders whose mesh is loaded and whose pose is finite.
    pub fn colliders(&self) -> impl Iterator<Item = PlacedCollider<'_>> {
        self.colliders.iter().filter_map(|collider| self.place(&collider))
    }

    /// One of [`WorldPoses::colliders`].
    pub fn collider(&self, entity: Entity) -> Option<PlacedCollider<'_>> {
        self.place(&self.colliders.get(entity).ok()?)
    }

    fn place(&self, collider: &ColliderComponentsItem) -> Option<PlacedCollider<'_>> {
        let entity = collider.entity;
        let mesh = self.meshes.as_ref()?.get(&collider.mesh.0)?;
        let own = || affine(collider.transform);
        let (body, to_world, is_disabled) = match collider.parent {
            Some(parent) if !collider.is_body => match hierarchy::from_parent(parent.parent(), &self.nodes) {
                Ancestor::Body(body, up) => (body, self.body_to_world(body) * up * own(), false),
                Ancestor::World(up) => (entity, up * own(), false),
                Ancestor::Disabled => (entity, self.to_world(entity), true),
            },
            _ => (entity, self.body_to_world(entity), collider.body_disabled),
        };
        if !to_world.is_finite() {
            return None;
        }
        let placed = place(&to_world);
        let copy = self.step.as_ref().and_then(|step| step.sheared_mesh(entity));
        let (mesh, to_world, is_ready) = match (placed.shear, copy) {
            (None, _) => (mesh, to_world, true),
            (Some(_), Some(copy)) => (copy, to_world_of(&placed), true),
            (Some(_), None) => (mesh, to_world, false),
        };
        let left_out = is_disabled || collider.is_disabled || !is_ready;
        let state = if left_out || self.is_rejected(entity) || self.is_rejected(body) {
            ColliderState::LeftOut
        } else if collider.is_sensor {
            ColliderState::Sensor
        } else if self.sleeping.get(body).is_ok_and(|sleeping| sleeping.0) {
            ColliderState::Asleep
        } else {
            ColliderState::Awake
        };
        Some(PlacedCollider {
            body,
            mesh,
            placed,
            to_world,
            state,
        })
    }

    /// The transformation from the coordinates of a body to the world.
    pub fn body_to_world(&self, body: Entity) -> DAffine3 {
        let to_world = self.to_world(body);
        let stretch = self.step.as_ref().and_then(|step| step.nested.stretch(body));
        match stretch {
            // Shear of entities above does not follow the rotation of a body that moves by itself.
            Some(stretch) => DAffine3 {
                matrix3: DMat3::from_quat(decompose(&to_world.matrix3).0) * stretch,
                translation: to_world.translation,
            },
            None => to_world,
        }
    }

    /// The transformation from the coordinates of an entity to the world.
    pub fn to_world(&self, entity: Entity) -> DAffine3 {
        let transform_of = |entity| self.transforms.get(entity).ok().copied();
        hierarchy::to_world(entity, parent_in(&self.parents), transform_of)
    }

    /// Whether the step leaves an entity out of collisions.
    fn is_rejected(&self, entity: Entity) -> bool {
        let Some(step) = &self.step else { return false };
        step.faults.binary_search_by_key(&entity, |&(entity, _)| entity).is_ok()
    }
}

/// The transformation to where a mesh is placed, without shear.
fn to_world_of(placed: &Placed) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(placed.scale.as_dvec3(), placed.pose.rotation, placed.pose.translation)
}
