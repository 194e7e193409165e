//! Reads the poses of colliders and planes from components.

use super::index::{IndexedCollider, SpatialIndex, SpatialQueryError};
use crate::asset::CollisionMesh;
#[cfg(feature = "bevy_picking")]
use crate::plugin::clock::{Physics, PhysicsTime};
use crate::plugin::collisions::StepReport;
use crate::plugin::components::{ColliderDisabled, MeshCollider, RigidBodyDisabled, Sensor};
use crate::plugin::sync::Step;
use crate::plugin::sync::hierarchy::{self, Ancestor, Node, Placed, above, affine, decompose, parent_in, place};
use crate::plugin::sync::planes::{IsPlane, PlaneComponents};
use crate::state::Motion;
use crate::types::body::{CollisionLayers, RigidBody};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::{DAffine3, DMat3};
use bevy::prelude::*;
use std::collections::BTreeMap;

/// A system that updates what [`SpatialQuery`](super::SpatialQuery) sees. Run it before a system that queries, if
/// others have moved, spawned or removed colliders since the last step.
///
/// After each step it runs by itself, if any system queries. With
/// [`Readback::Resident`](crate::plugin::settings::Readback::Resident) it does nothing.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_faceoff::prelude::*;
/// # use bevy_faceoff::plugin::queries::update_spatial_queries;
/// # fn place_buildings() {}
/// # fn aim(_: SpatialQuery) {}
/// # let mut app = App::new();
/// app.add_systems(Update, (place_buildings, update_spatial_queries, aim).chain());
/// ```
pub fn update_spatial_queries(mut index: ResMut<SpatialIndex>, colliders: Colliders) {
    if colliders.step.as_ref().is_some_and(|step| step.is_resident()) {
        // What was read from components, for example while the device was opened, is no longer true.
        if !index.has_given_poses {
            index.clear();
            index.fault = Some(SpatialQueryError::Resident);
        }
        return;
    }
    colliders.read(&mut index, &|_| None);
    index.has_given_poses = false;
}

/// [`update_spatial_queries`] after a step, if any system queries.
pub(crate) fn update_after_step(index: ResMut<SpatialIndex>, colliders: Colliders) {
    if index.is_active {
        update_spatial_queries(index, colliders);
    }
}

/// [`update_spatial_queries`], if the results of a step were published since.
pub(super) fn catch_up(index: ResMut<SpatialIndex>, report: Option<Res<StepReport>>, colliders: Colliders) {
    if index.is_active && report.is_some_and(|report| index.step != report.step) {
        update_spatial_queries(index, colliders);
    }
}

/// [`update_spatial_queries`], if no step runs that would do it.
#[cfg(feature = "bevy_picking")]
pub(crate) fn update_while_time_stands(
    index: ResMut<SpatialIndex>,
    physics: Option<Res<Time<Physics>>>,
    game: Option<Res<Time<Virtual>>>,
    colliders: Colliders,
) {
    let stands = physics.is_some_and(|time| time.is_paused() || time.relative_speed() == 0.0)
        || game.is_some_and(|time| time.delta().is_zero());
    if stands && !index.has_given_poses {
        update_spatial_queries(index, colliders);
    }
}

/// Makes queries see bodies at these poses, until the next call or, except with
/// [`Readback::Resident`](crate::plugin::settings::Readback::Resident), the next step. The poses of a
/// [`Snapshot`](crate::plugin::snapshot::Snapshot) are `snapshot.bodies()`.
pub fn update_spatial_queries_from<'a>(world: &mut World, bodies: impl IntoIterator<Item = (Entity, &'a Motion)>) {
    let poses = bodies.into_iter();
    let poses: Poses = poses
        .map(|(body, motion)| (body, (motion.position, motion.rotation)))
        .collect();
    if let Err(error) = world.run_system_cached_with(read_with, poses) {
        error!("{error}");
    }
}

/// Poses of bodies, which replace the poses in their components.
type Poses = BTreeMap<Entity, (Vec3, Quat)>;

fn read_with(In(poses): In<Poses>, mut index: ResMut<SpatialIndex>, colliders: Colliders) {
    colliders.read(&mut index, &|entity| poses.get(&entity).copied());
    index.has_given_poses = true;
}

/// The components of a collider.
#[derive(QueryData)]
pub(crate) struct ColliderComponents {
    entity: Entity,
    mesh: &'static MeshCollider,
    transform: &'static Transform,
    parent: Option<&'static ChildOf>,
    layers: Option<&'static CollisionLayers>,
    is_sensor: Has<Sensor>,
    is_body: Has<RigidBody>,
    body_disabled: Has<RigidBodyDisabled>,
}

/// All colliders and planes.
#[derive(SystemParam)]
pub struct Colliders<'w, 's> {
    step: Option<Res<'w, Step>>,
    report: Option<Res<'w, StepReport>>,
    meshes: Res<'w, Assets<CollisionMesh>>,
    colliders: Query<'w, 's, ColliderComponents, Without<ColliderDisabled>>,
    planes: Query<'w, 's, PlaneComponents, IsPlane>,
    nodes: Query<'w, 's, Node>,
    parents: Query<'w, 's, &'static ChildOf>,
    transforms: Query<'w, 's, &'static Transform>,
    layers: Query<'w, 's, &'static CollisionLayers>,
}

/// Gives the pose of a body, which replaces the pose in its components.
type PoseOf<'a> = &'a dyn Fn(Entity) -> Option<(Vec3, Quat)>;

impl Colliders<'_, '_> {
    fn read(&self, index: &mut SpatialIndex, pose_of: PoseOf) {
        index.clear();
        index.fault = None;
        index.step = self.report.as_ref().map_or(0, |report| report.step);
        for collider in &self.colliders {
            if !self.is_rejected(collider.entity) {
                self.add_collider(index, &collider, pose_of);
            }
        }
        for plane in &self.planes {
            let Ok(half_space) = plane.half_space(Some(self.to_world(plane.entity))) else {
                continue;
            };
            let (normal, distance) = (half_space.normal.as_dvec3(), f64::from(half_space.distance));
            if index.scene.add_plane(normal, distance).is_ok() {
                index.colliders.push(IndexedCollider {
                    collider: plane.entity,
                    body: plane.entity,
                    layers: half_space.layers,
                    is_sensor: half_space.sensor,
                });
            }
        }
    }

    /// Adds a collider whose mesh is there.
    fn add_collider(&self, index: &mut SpatialIndex, collider: &ColliderComponentsItem, pose_of: PoseOf) {
        let entity = collider.entity;
        let (body, placed) = match collider.parent {
            Some(parent) if !collider.is_body => match hierarchy::from_parent(parent.parent(), &self.nodes) {
                Ancestor::Body(body, up) if !self.is_rejected(body) => {
                    let own = affine(collider.transform);
                    (body, self.body_to_world(body, pose_of) * up * own)
                }
                Ancestor::World(up) => (entity, up * affine(collider.transform)),
                Ancestor::Body(..) | Ancestor::Disabled => return,
            },
            _ if collider.body_disabled => return,
            _ => (entity, self.body_to_world(entity, pose_of)),
        };
        let Placed { pose, scale, shear } = place(&placed);
        let mesh = match shear {
            None => self.meshes.get(&collider.mesh.0),
            Some(_) => self.step.as_ref().and_then(|step| step.sheared_mesh(entity)),
        };
        let Some(mesh) = mesh else { return };
        if index
            .scene
            .add_mesh(mesh, pose.translation, pose.rotation, scale)
            .is_ok()
        {
            let layers = collider.layers.or_else(|| self.layers.get(body).ok());
            index.colliders.push(IndexedCollider {
                collider: entity,
                body,
                layers: layers.copied().unwrap_or_default(),
                is_sensor: collider.is_sensor,
            });
        }
    }

    /// An entity, and the body to which it belongs.
    pub(super) fn own(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        let body = match above(entity, &self.nodes) {
            Ancestor::Body(body, _) => Some(body),
            Ancestor::World(_) | Ancestor::Disabled => None,
        };
        std::iter::once(entity).chain(body)
    }

    /// Whether the step leaves an entity out of collisions.
    fn is_rejected(&self, entity: Entity) -> bool {
        let Some(step) = &self.step else { return false };
        step.faults.binary_search_by_key(&entity, |&(entity, _)| entity).is_ok()
    }

    /// The transformation from the coordinates of a body to the world.
    fn body_to_world(&self, body: Entity, pose_of: PoseOf) -> DAffine3 {
        let to_world = self.to_world(body);
        let Some((position, rotation)) = pose_of(body) else {
            return to_world;
        };
        let stretch = match (self.parents.get(body), self.transforms.get(body)) {
            (Err(_), Ok(transform)) => DMat3::from_diagonal(transform.scale.as_dvec3()),
            _ => decompose(&to_world.matrix3).1,
        };
        DAffine3 {
            matrix3: DMat3::from_quat(rotation.as_dquat().normalize()) * stretch,
            translation: position.as_dvec3(),
        }
    }

    /// The transformation from the coordinates of an entity to the world.
    pub(super) fn to_world(&self, entity: Entity) -> DAffine3 {
        let transform_of = |entity| self.transforms.get(entity).ok().copied();
        hierarchy::to_world(entity, parent_in(&self.parents), transform_of)
    }
}
