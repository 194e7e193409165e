//! Reads components into the stages' arrays, before a step.

use super::oddities::{Oddities, Oddity};
use super::tables::Tables;
use super::{Collected, Step, named};
use crate::asset::CollisionMesh;
use crate::plugin::clock::Physics;
use crate::plugin::components::*;
use crate::plugin::events::BodyRejected;
use crate::plugin::settings::Gravity;
use crate::state::fault::BodyFault;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Body, BodyParams, Plane};
use crate::types::body::*;
use crate::types::material::{Friction, Restitution};
use crate::types::settings::{Culling, Response};
use crate::types::solver_settings::SolverSettings;
use bevy::asset::LoadState;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use std::time::Instant;

/// The components of a body.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct BodyComponents {
    entity: Entity,
    collider: &'static MeshCollider,
    transform: &'static Transform,
    kind: Option<&'static RigidBody>,
    linear_velocity: Option<&'static LinearVelocity>,
    angular_velocity: Option<&'static AngularVelocity>,
    mass: Option<&'static Mass>,
    density: Option<&'static Density>,
    inertia: Option<&'static AngularInertia>,
    restitution: Option<&'static Restitution>,
    params: HandlingComponents,
    gravity_scale: Option<&'static GravityScale>,
    layers: Option<&'static CollisionLayers>,
    sensor: Has<Sensor>,
    is_child: Has<ChildOf>,
    culling: Option<&'static BodyCulling>,
    center: Option<&'static mut CenterOfMass>,
}

/// The components that the contact solver reads.
#[derive(QueryData)]
pub(crate) struct HandlingComponents {
    friction: Option<&'static Friction>,
    linear_damping: Option<&'static LinearDamping>,
    angular_damping: Option<&'static AngularDamping>,
    max_linear_speed: Option<&'static MaxLinearSpeed>,
    max_angular_speed: Option<&'static MaxAngularSpeed>,
    locked_axes: Option<&'static LockedAxes>,
    forces: Option<&'static ExternalForces>,
    sleeping: Option<&'static Sleeping>,
    never_sleeps: Has<SleepingDisabled>,
    continuous: Has<ContinuousCollision>,
}

/// The components of a plane.
#[derive(QueryData)]
pub(crate) struct PlaneComponents {
    entity: Entity,
    plane: &'static PlaneCollider,
    restitution: Option<&'static Restitution>,
    friction: Option<&'static Friction>,
    is_body: Has<MeshCollider>,
    kind: Option<&'static RigidBody>,
}

/// A component that becomes a collider later.
#[cfg(feature = "bevy_mesh")]
use crate::plugin::mesh_collider_from::MeshColliderFrom as ColliderToCome;
/// Without the feature there is no such component.
#[cfg(not(feature = "bevy_mesh"))]
use MeshCollider as ColliderToCome;

/// Bodies without any collider.
type Bare = (
    With<RigidBody>,
    Without<MeshCollider>,
    Without<ColliderToCome>,
    Without<PlaneCollider>,
);

/// The settings of all bodies.
#[derive(SystemParam)]
pub(crate) struct Rules<'w> {
    gravity: Res<'w, Gravity>,
    response: Res<'w, Response>,
    culling: Res<'w, Culling>,
    solver: Res<'w, SolverSettings>,
}

/// Fills the stages' input from the world, and reports invalid bodies and planes.
pub(crate) fn collect(
    mut step: ResMut<Step>,
    mut bodies: Query<BodyComponents>,
    planes: Query<PlaneComponents>,
    bare: Query<(Entity, &RigidBody), Bare>,
    names: Query<&Name>,
    meshes: Res<Assets<CollisionMesh>>,
    assets: Res<AssetServer>,
    time: Res<Time<Physics>>,
    rules: Rules,
    mut rejected: MessageWriter<BodyRejected>,
) {
    let step = &mut *step;
    step.begun = Instant::now();
    step.state.input.config.dt = time.delta_secs();
    step.state.input.config.response = *rules.response;
    step.state.input.config.gravity = rules.gravity();
    step.state.input.config.solver = rules.solver();

    let mut faults = Vec::new();
    step.bodies.clear();
    step.tables.poll();
    for mut body in &mut bodies {
        body.note(&mut step.oddities);
        let id = body.collider.0.id();
        if body.is_child {
            faults.push((body.entity, BodyFault::Child));
            continue;
        }
        let culling = body.culling.map_or(*rules.culling, |c| c.0);
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
        if let Some(mesh) = slot(&mut step.state.input.meshes, &mut step.slots, &step.tables, &meshes, id) {
            if let Some(center) = &mut body.center {
                center.set_if_neq(CenterOfMass(step.state.input.meshes[mesh].mesh.mass.center));
            }
            step.bodies.push((body.entity, body.with_mesh(mesh, culling)));
        } else {
            match assets.load_state(id) {
                LoadState::Loading | LoadState::Loaded => {}
                LoadState::NotLoaded => faults.push((body.entity, BodyFault::MeshMissing)),
                LoadState::Failed(_) => faults.push((body.entity, BodyFault::MeshFailed)),
            }
        }
    }
    // The order of a query depends on archetypes. The order of entities does not.
    step.bodies.sort_unstable_by_key(|&(entity, _)| entity);

    let Collected {
        entities,
        kinds,
        planes: plane_entities,
    } = &mut step.collected;
    entities.clear();
    kinds.clear();
    step.state.input.bodies.clear();
    for (entity, body) in &step.bodies {
        match step.state.input.bodies.push(body, &step.state.input.meshes) {
            Ok(()) => {
                entities.push(*entity);
                kinds.push(body.kind);
            }
            Err(fault) => faults.push((*entity, fault)),
        }
    }

    let keys = &mut step.state.input.keys;
    keys.clear();
    keys.extend(entities.iter().map(|entity| entity.to_bits()));

    step.planes.clear();
    for plane in &planes {
        plane.note(&mut step.oddities);
        match plane.half_space() {
            Ok(half_space) => step.planes.push((plane.entity, half_space)),
            Err(fault) => faults.push((plane.entity, fault)),
        }
    }
    step.planes.sort_unstable_by_key(|&(entity, _)| entity);
    plane_entities.clear();
    plane_entities.extend(step.planes.iter().map(|&(entity, _)| entity));
    step.state.input.planes.clear();
    step.state
        .input
        .planes
        .extend(step.planes.iter().map(|&(_, plane)| plane));

    let named = |entity: Entity| named(entity, names.get(entity).ok());
    faults.sort_unstable_by_key(|&(entity, _)| entity);
    for &(entity, fault) in &faults {
        let known = step.faults.binary_search_by_key(&entity, |&(entity, _)| entity);
        if !known.is_ok_and(|at| step.faults[at].1.is_like(&fault)) {
            error!("{} is left out of collisions: {fault}", named(entity));
            rejected.write(BodyRejected { entity, fault });
        }
    }
    step.faults = faults;
    let moving = bare.iter().filter(|&(_, &kind)| kind != RigidBody::Static);
    step.oddities.count_bare(moving.map(|(entity, _)| entity));
    step.oddities
        .report(|entity, oddity| warn!("{}: {oddity}", named(entity)));
    step.choose_place();

    step.tables.retain(|id| meshes.contains(id));
    let (arena, slots) = (&mut step.state.input.meshes, &mut step.slots);
    slots.retain(|&id, &mut slot| {
        let keep = meshes.contains(id);
        if !keep {
            arena.remove(slot);
        }
        keep
    });
}

/// The arena slot of a mesh, if it is loaded. If the asset was replaced, for example by a hot reload, so is the mesh in
/// the slot.
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

impl PlaneComponentsItem<'_, '_> {
    /// Records components without effect.
    fn note(&self, oddities: &mut Oddities) {
        oddities.check_restitution(self.entity, self.restitution.map(|r| r.coefficient));
        oddities.check(self.entity, "Friction", self.friction.map(|f| f.coefficient));
        if self.kind.is_some_and(|&kind| kind != RigidBody::Static) && !self.is_body {
            oddities.add(self.entity, Oddity::PlaneDoesNotMove);
        }
    }

    fn half_space(&self) -> Result<Plane, BodyFault> {
        if self.is_body {
            return Err(BodyFault::PlaneOnBody);
        }
        let PlaneCollider { normal, distance } = *self.plane;
        let restitution = self.restitution.copied().unwrap_or_default();
        let friction = self.friction.copied().unwrap_or_default();
        // In double precision the length of a finite vector neither overflows nor underflows.
        let unit = normal.as_dvec3().try_normalize();
        let normal = unit.ok_or(BodyFault::PlaneNormal(normal))?.as_vec3();
        if !distance.is_finite() {
            return Err(BodyFault::PlaneDistance(distance));
        }
        let numbers = [
            ("Restitution", restitution.coefficient),
            ("Friction", friction.coefficient),
        ];
        if let Some((name, _)) = numbers.into_iter().find(|(_, number)| !number.is_finite()) {
            return Err(BodyFault::NonFinite(name));
        }
        Ok(Plane {
            normal,
            distance,
            restitution: restitution.coefficient.clamp(0.0, 1.0),
            restitution_combine: restitution.combine,
            friction,
        })
    }
}

impl Rules<'_> {
    fn gravity(&self) -> Vec3 {
        if self.gravity.is_finite() {
            return self.gravity.0;
        }
        error_once!("Gravity is {}, which is not finite, and counts as zero", self.gravity.0);
        Vec3::ZERO
    }

    fn solver(&self) -> SolverSettings {
        match self.solver.fault() {
            None => *self.solver,
            Some(name) => {
                error_once!(
                    "SolverSettings::{name} is negative, not finite or too large: all settings of the solver count as \
                     their defaults until it is a finite number of 0 or more, and within the limit in its documentation"
                );
                SolverSettings::default()
            }
        }
    }
}

impl BodyComponentsItem<'_, '_> {
    /// Records components without effect.
    fn note(&self, oddities: &mut Oddities) {
        let (entity, params) = (self.entity, &self.params);
        oddities.check_restitution(entity, self.restitution.map(|r| r.coefficient));
        oddities.check(entity, "Friction", params.friction.map(|f| f.coefficient));
        oddities.check(entity, "LinearDamping", params.linear_damping.map(|d| d.0));
        oddities.check(entity, "AngularDamping", params.angular_damping.map(|d| d.0));
        oddities.check_limit(entity, "MaxLinearSpeed", params.max_linear_speed.map(|m| m.0));
        oddities.check_limit(entity, "MaxAngularSpeed", params.max_angular_speed.map(|m| m.0));
    }

    fn with_mesh(&self, mesh: u32, culling: Culling) -> Body {
        let transform = self.transform;
        let mut body = Body::at_rest(mesh, transform.translation, transform.rotation, transform.scale);
        body.kind = self.kind.copied().unwrap_or(RigidBody::Static);
        body.linear_velocity = self.linear_velocity.map_or(Vec3::ZERO, |v| v.0);
        body.angular_velocity = self.angular_velocity.map_or(Vec3::ZERO, |w| w.0);
        body.mass = self.mass.map(|m| m.0);
        body.density = self.density.map_or(1.0, |d| d.0);
        body.inertia = self.inertia.map(|i| i.0);
        body.restitution = self.restitution.map_or(0.0, |r| r.coefficient);
        body.gravity_scale = self.gravity_scale.map_or(1.0, |g| g.0);
        body.layers = self.layers.copied().unwrap_or_default();
        body.sensor = self.sensor;
        body.culling = culling;
        body.params = self.params.read(self.restitution);
        body
    }
}

impl HandlingComponentsItem<'_, '_> {
    fn read(&self, restitution: Option<&Restitution>) -> BodyParams {
        BodyParams {
            friction: self.friction.copied().unwrap_or_default(),
            restitution_combine: restitution.map_or_else(Default::default, |r| r.combine),
            linear_damping: self.linear_damping.map_or(0.0, |d| d.0),
            angular_damping: self.angular_damping.map_or(0.0, |d| d.0),
            max_linear_speed: self.max_linear_speed.map_or(f32::INFINITY, |m| m.0),
            max_angular_speed: self.max_angular_speed.map_or(f32::INFINITY, |m| m.0),
            locked_axes: self.locked_axes.copied().unwrap_or_default(),
            forces: self.forces.copied().unwrap_or_default(),
            can_sleep: !self.never_sleeps,
            continuous: self.continuous,
            woken: self.sleeping.is_some_and(|sleeping| !sleeping.0),
        }
    }
}
