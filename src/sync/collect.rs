//! Components to arrays.

use super::tables::Tables;
use super::{Collected, Step};
use crate::asset::CollisionMesh;
use crate::components::*;
use crate::events::BodyRejected;
use crate::settings::{Culling, Gravity, Response};
use crate::stages::bodies::BodyFault;
use crate::stages::mesh_arena::MeshArena;
use crate::stages::state::{Body, Plane};
use bevy::asset::LoadState;
use bevy::ecs::query::QueryData;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use std::time::Instant;

/// What a body is made of.
#[derive(QueryData)]
pub(crate) struct BodyComponents {
    entity: Entity,
    collider: &'static MeshCollider,
    transform: &'static Transform,
    kind: Option<&'static RigidBody>,
    linear_velocity: Option<&'static LinearVelocity>,
    angular_velocity: Option<&'static AngularVelocity>,
    mass: Option<&'static Mass>,
    restitution: Option<&'static Restitution>,
    gravity_scale: Option<&'static GravityScale>,
    layers: Option<&'static CollisionLayers>,
    sensor: Has<Sensor>,
    is_child: Has<ChildOf>,
    culling: Option<&'static BodyCulling>,
}

/// Fills the stages' input from the world.
pub(crate) fn collect(
    mut step: ResMut<Step>,
    bodies: Query<BodyComponents>,
    planes: Query<(Entity, &PlaneCollider, Option<&Restitution>, Has<MeshCollider>)>,
    meshes: Res<Assets<CollisionMesh>>,
    assets: Res<AssetServer>,
    time: Res<Time>,
    gravity: Res<Gravity>,
    response: Res<Response>,
    culling: Res<Culling>,
    mut rejected: MessageWriter<BodyRejected>,
) {
    let step = &mut *step;
    step.begun = Instant::now();
    step.state.config.dt = time.delta_secs();
    step.state.config.response = *response;
    step.state.config.gravity = if gravity.is_finite() {
        gravity.0
    } else {
        error_once!("Gravity is {}, which is not finite, and counts as zero", gravity.0);
        Vec3::ZERO
    };

    let mut faults = Vec::new();
    step.bodies.clear();
    step.tables.poll();
    for body in &bodies {
        let id = body.collider.0.id();
        if body.is_child {
            faults.push((body.entity, BodyFault::Child));
            continue;
        }
        let culling = body.culling.map_or(*culling, |c| c.0);
        if culling == Culling::FacesOfCollision
            && let Some(mesh) = meshes.get(id).filter(|mesh| mesh.faces.is_none())
        {
            let name = || {
                assets
                    .get_path(id)
                    .map_or_else(|| id.to_string(), |path| path.to_string())
            };
            step.tables.request(id, mesh, name);
        }
        if let Some(mesh) = slot(&mut step.state.meshes, &mut step.slots, &step.tables, &meshes, id) {
            step.bodies.push((body.entity, body.with_mesh(mesh, culling)));
        } else {
            match assets.load_state(id) {
                LoadState::Loading | LoadState::Loaded => {}
                LoadState::NotLoaded => faults.push((body.entity, BodyFault::MeshMissing)),
                LoadState::Failed(_) => faults.push((body.entity, BodyFault::MeshFailed)),
            }
        }
    }
    // Query order depends on archetypes; the order of entities does not, and nearly always is the same.
    step.bodies.sort_unstable_by_key(|&(entity, _)| entity);

    let Collected {
        entities,
        kinds,
        planes: plane_entities,
    } = &mut step.collected;
    entities.clear();
    kinds.clear();
    step.state.bodies.clear();
    for (entity, body) in &step.bodies {
        match step.state.bodies.push(body, &step.state.meshes) {
            Ok(()) => {
                entities.push(*entity);
                kinds.push(body.kind);
            }
            Err(fault) => faults.push((*entity, fault)),
        }
    }

    step.planes.clear();
    for (entity, plane, restitution, is_body) in &planes {
        step.planes.push((entity, *plane, restitution.copied(), is_body));
    }
    step.planes.sort_unstable_by_key(|&(entity, ..)| entity);
    plane_entities.clear();
    step.state.planes.clear();
    for &(entity, ref plane, restitution, is_body) in &step.planes {
        if is_body {
            faults.push((entity, BodyFault::PlaneOnBody));
            continue;
        }
        match half_space(plane, restitution) {
            Ok(plane) => {
                plane_entities.push(entity);
                step.state.planes.push(plane);
            }
            Err(fault) => faults.push((entity, fault)),
        }
    }

    faults.sort_unstable_by_key(|&(entity, _)| entity);
    for &(entity, fault) in &faults {
        // The same kind of fault again is not news, whatever its numbers.
        let known = step.faults.binary_search_by_key(&entity, |&(entity, _)| entity);
        let known = known.map(|at| std::mem::discriminant(&step.faults[at].1));
        if known != Ok(std::mem::discriminant(&fault)) {
            error!("{entity} is left out of collisions: {fault}");
            rejected.write(BodyRejected { entity, fault });
        }
    }
    step.faults = faults;

    step.tables.retain(|id| meshes.contains(id));
    let (arena, slots) = (&mut step.state.meshes, &mut step.slots);
    slots.retain(|&id, &mut slot| {
        let keep = meshes.contains(id);
        if !keep {
            arena.remove(slot);
        }
        keep
    });
}

/// The arena slot of a mesh, if it is loaded; a mesh that was replaced, by a hot reload say, is replaced there too.
fn slot(
    arena: &mut MeshArena,
    slots: &mut HashMap<AssetId<CollisionMesh>, u32>,
    tables: &Tables,
    meshes: &Assets<CollisionMesh>,
    id: AssetId<CollisionMesh>,
) -> Option<u32> {
    let mesh = tables.best(id, meshes.get(id)?);
    let slot = *slots.entry(id).or_insert_with(|| arena.add(mesh.clone()));
    if !arena[slot].mesh.is_same(mesh) {
        arena.replace(slot, mesh.clone());
    }
    Some(slot)
}

fn half_space(plane: &PlaneCollider, restitution: Option<Restitution>) -> Result<Plane, BodyFault> {
    let restitution = restitution.map_or(0.0, |r| r.coefficient);
    // In double precision no finite vector is too long or too short.
    let normal = plane
        .normal
        .as_dvec3()
        .try_normalize()
        .ok_or(BodyFault::PlaneNormal(plane.normal))?
        .as_vec3();
    if !plane.distance.is_finite() {
        return Err(BodyFault::PlaneDistance(plane.distance));
    }
    if !restitution.is_finite() {
        return Err(BodyFault::NonFiniteMotion);
    }
    Ok(Plane {
        normal,
        distance: plane.distance,
        restitution: restitution.clamp(0.0, 1.0),
    })
}

impl BodyComponentsItem<'_, '_> {
    fn with_mesh(&self, mesh: u32, culling: Culling) -> Body {
        let transform = self.transform;
        let mut body = Body::at_rest(mesh, transform.translation, transform.rotation, transform.scale);
        body.kind = self.kind.copied().unwrap_or(RigidBody::Static);
        body.linear_velocity = self.linear_velocity.map_or(Vec3::ZERO, |v| v.0);
        body.angular_velocity = self.angular_velocity.map_or(Vec3::ZERO, |w| w.0);
        body.mass = self.mass.map(|m| m.0);
        body.restitution = self.restitution.map_or(0.0, |r| r.coefficient);
        body.gravity_scale = self.gravity_scale.map_or(1.0, |g| g.0);
        body.layers = self.layers.copied().unwrap_or_default();
        body.sensor = self.sensor;
        body.culling = culling;
        body
    }
}
