//! Reads components into the stages' arrays, before a step.

use super::components::{BodyComponents, BodyComponentsItem, Surface};
use super::driven::DrivenBodies;
use super::hierarchy::{self, Above, NestedBodies, Node, Placed, Posed, affine};
use super::planes::{self, PlaneComponents};
use super::sheared::Sheared;
use super::{Assembly, AssemblyPart, Step, named};
use crate::asset::CollisionMesh;
use crate::plugin::clock::Physics;
use crate::plugin::components::*;
use crate::plugin::events::BodyRejected;
use crate::plugin::settings::Gravity;
use crate::state::Body;
use crate::state::bodies::check_body;
use crate::state::fault::BodyFault;
use crate::state::mesh_arena::MeshArena;
use crate::types::body::*;
use crate::types::settings::{Culling, Response};
use crate::types::solver_settings::SolverSettings;
use bevy::asset::LoadState;
use bevy::ecs::system::SystemParam;
use bevy::math::{DAffine3, DMat3};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use std::time::Instant;

/// Colliders that may be parts of a body above them.
type Children = (
    With<MeshCollider>,
    With<ChildOf>,
    Without<RigidBody>,
    Without<ColliderDisabled>,
);

/// Bodies without any collider of their own.
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

/// The hierarchy above colliders and bodies.
#[derive(SystemParam)]
pub(crate) struct Hierarchy<'w, 's> {
    nodes: Query<'w, 's, Node>,
    parents: Query<'w, 's, &'static ChildOf>,
    transforms: Query<'w, 's, &'static Transform>,
    children: Query<'w, 's, Entity, Children>,
    to_come: Query<'w, 's, Entity, (With<ColliderToCome>, With<ChildOf>, Without<MeshCollider>)>,
    bare: Query<'w, 's, (Entity, &'static RigidBody), Bare>,
}

/// The loaded meshes.
#[derive(SystemParam)]
pub(crate) struct Meshes<'w> {
    meshes: Res<'w, Assets<CollisionMesh>>,
    assets: Res<'w, AssetServer>,
}

/// A collider below its body, or a static one below other entities.
#[derive(Clone, Copy)]
pub(crate) struct Child {
    collider: Entity,
    /// `None` for a static one.
    body: Option<Entity>,
    /// To the coordinates of the body, or to the world.
    up: DAffine3,
}

/// Fills the stages' input from the world, and reports invalid bodies and planes.
pub(crate) fn collect(
    mut step: ResMut<Step>,
    mut bodies: Query<BodyComponents, Or<(With<MeshCollider>, With<RigidBody>)>>,
    plane_query: Query<PlaneComponents>,
    hierarchy: Hierarchy,
    names: Query<&Name>,
    meshes: Meshes,
    time: Res<Time<Physics>>,
    rules: Rules,
    mut rejected: MessageWriter<BodyRejected>,
) {
    let step = &mut *step;
    step.begun = Instant::now();
    let has_hooks = step.hooks.is_some();
    step.state.input.config.dt = time.delta_secs();
    step.state.input.config.response = *rules.response;
    step.state.input.config.gravity = rules.gravity();
    step.state.input.config.solver = rules.solver();

    step.new_faults.clear();
    step.bodies.clear();
    step.assemblies.clear();
    step.parts.clear();
    step.tables.poll();
    hierarchy.find_children(&mut step.children);
    let before = Before {
        nested: step.nested.take(),
        driven: step.driven.take(),
    };
    let mut reader = Reader {
        step,
        meshes: &meshes,
        culling: *rules.culling,
        response: *rules.response,
        before: &before,
    };
    // Those that are not single bodies without a parent. They are few in most worlds.
    let mut others = std::mem::take(&mut reader.step.others);
    others.clear();
    for mut body in &mut bodies {
        body.note(has_hooks, &mut reader.step.oddities);
        if body.kind.is_none() && body.parent.is_some() {
            continue;
        }
        let is_single = body.parent.is_none()
            && body.center.is_none()
            && body.collider.is_some()
            && !body.collider_disabled
            && !body.body_disabled
            && !reader.step.has_children(body.entity);
        if is_single {
            let posed = Posed::root(body.transform);
            reader.single(&mut body, &posed);
        } else {
            others.push(body.entity);
        }
    }
    // So that assemblies are ascending by body.
    others.sort_unstable();
    for &entity in &others {
        if let Ok(mut body) = bodies.get_mut(entity)
            && !body.body_disabled
        {
            reader.any(&mut body, &hierarchy);
        }
    }
    reader.children(&mut bodies);
    reader.step.others = others;
    // The order of a query depends on archetypes. The order of entities does not.
    step.bodies.sort_unstable_by_key(|&(entity, _)| entity);
    step.fill();
    step.check_driven();
    for (assembly, center) in step.centers() {
        if let Ok(mut body) = bodies.get_mut(assembly)
            && let Some(computed) = &mut body.computed_center
        {
            computed.set_if_neq(ComputedCenterOfMass(center));
        }
    }

    let keys = &mut step.state.input.keys;
    keys.clear();
    keys.extend(step.collected.entities.iter().map(|entity| entity.to_bits()));

    planes::read(
        &plane_query,
        |entity| hierarchy.to_world(entity),
        has_hooks,
        &mut step.planes,
        &mut step.new_faults,
        &mut step.oddities,
    );
    let plane_entities = &mut step.collected.planes;
    plane_entities.clear();
    plane_entities.extend(step.planes.iter().map(|&(entity, _)| entity));
    step.state.input.planes.clear();
    step.state
        .input
        .planes
        .extend(step.planes.iter().map(|&(_, plane)| plane));

    let named = |entity: Entity| named(entity, names.get(entity).ok());
    step.new_faults.sort_unstable_by_key(|&(entity, _)| entity);
    for &(entity, fault) in &step.new_faults {
        let known = step.faults.binary_search_by_key(&entity, |&(entity, _)| entity);
        if !known.is_ok_and(|at| step.faults[at].1.is_like(&fault)) {
            error!("{} is left out of collisions: {fault}", named(entity));
            rejected.write(BodyRejected { entity, fault });
        }
    }
    std::mem::swap(&mut step.faults, &mut step.new_faults);
    let children = &step.children;
    let moving = (hierarchy.bare.iter())
        .filter(|&(entity, &kind)| kind != RigidBody::Static && !has_children(children, entity))
        .filter(|&(entity, _)| !hierarchy.will_have_children(entity));
    step.oddities.count_bare(moving.map(|(entity, _)| entity));
    step.oddities
        .report(|entity, oddity| warn!("{}: {oddity}", named(entity)));
    step.choose_place();

    step.tables.retain(|id| meshes.meshes.contains(id));
    step.sheared.end_step(&mut step.state.input.meshes);
    let (arena, slots) = (&mut step.state.input.meshes, &mut step.slots);
    slots.retain(|&id, &mut slot| {
        let keep = meshes.meshes.contains(id);
        if !keep {
            arena.remove(slot);
        }
        keep
    });
}

/// Whether a body has colliders below it. `children` are ascending by body.
fn has_children(children: &[Child], body: Entity) -> bool {
    !children.is_empty() && children.binary_search_by_key(&Some(body), |child| child.body).is_ok()
}

impl Step {
    fn has_children(&self, body: Entity) -> bool {
        has_children(&self.children, body)
    }

    /// The body of each [`Assembly`] with its centre of mass, in the coordinates of its entity.
    fn centers(&self) -> Vec<(Entity, Vec3)> {
        let center = |assembly: &Assembly| {
            let compound = self.state.input.bodies.compounds.get(assembly.compound? as usize)?;
            let center = assembly.stretch.inverse() * compound.local_center;
            Some((assembly.body, center.as_vec3()))
        };
        self.assemblies.iter().filter_map(center).collect()
    }
}

impl Hierarchy<'_, '_> {
    /// Finds what is above each collider that is a child, ascending by body.
    fn find_children(&self, children: &mut Vec<Child>) {
        children.clear();
        for collider in &self.children {
            let own = self.transforms.get(collider).map_or(DAffine3::IDENTITY, affine);
            let (body, up) = match hierarchy::above(collider, &self.nodes) {
                Above::Body(body, up) => (Some(body), up),
                Above::World(up) => (None, up),
                Above::Disabled => continue,
            };
            children.push(Child {
                collider,
                body,
                up: up * own,
            });
        }
        children.sort_unstable_by_key(|child| (child.body, child.collider));
    }

    /// Whether a body has descendants that become colliders.
    fn will_have_children(&self, body: Entity) -> bool {
        let is_above = |entity| matches!(hierarchy::above(entity, &self.nodes), Above::Body(above, _) if above == body);
        self.to_come.iter().any(is_above)
    }

    /// The transformation from the coordinates of an entity to the world.
    fn to_world(&self, entity: Entity) -> DAffine3 {
        let transform_of = |entity| self.transforms.get(entity).ok().copied();
        hierarchy::to_world(entity, hierarchy::parent_in(&self.parents), transform_of)
    }

    /// The transformation from the parent of an entity to the world.
    fn above(&self, entity: Entity) -> DAffine3 {
        let transform_of = |entity| self.transforms.get(entity).ok().copied();
        hierarchy::world_above(entity, hierarchy::parent_in(&self.parents), transform_of)
    }
}

/// What bodies were in the last step.
struct Before {
    nested: NestedBodies,
    driven: DrivenBodies,
}

/// Reads bodies and their colliders.
struct Reader<'a, 'w> {
    step: &'a mut Step,
    meshes: &'a Meshes<'w>,
    /// Of colliders without one of their own.
    culling: Culling,
    response: Response,
    before: &'a Before,
}

impl Reader<'_, '_> {
    /// Adds a body that is its only collider.
    fn single(&mut self, body: &mut BodyComponentsItem, posed: &Posed) {
        let surface = body.surface.read();
        let Some(mesh) = self.mesh(body.entity, body.collider, &surface, None) else {
            return;
        };
        if let Some(center) = &mut body.computed_center {
            center.set_if_neq(ComputedCenterOfMass(
                self.step.state.input.meshes[mesh].mesh.mass.center,
            ));
        }
        self.drive(body, posed);
        let stretch = posed.stretch;
        let mut own = body.body(posed);
        own.mesh = mesh;
        own.scale = Vec3::new(
            stretch.x_axis.x as f32,
            stretch.y_axis.y as f32,
            stretch.z_axis.z as f32,
        );
        surface.apply(&mut own, surface.culling.unwrap_or(self.culling));
        self.step.bodies.push((body.entity, own));
    }

    /// Notes a kinematic body that moves by its `Transform`. What pushes nothing is better tested where it is put.
    fn drive(&mut self, body: &BodyComponentsItem, posed: &Posed) {
        let pushes = self.response == Response::Contacts && !body.surface.is_sensor();
        if pushes && body.kind == Some(&RigidBody::Kinematic) && body.has_no_velocity() {
            let pose = (posed.position, posed.rotation);
            self.step
                .driven
                .add(&self.before.driven, body.entity, pose, body.teleports);
        }
    }

    /// Adds a body with any number of colliders, anywhere in the hierarchy.
    fn any(&mut self, body: &mut BodyComponentsItem, hierarchy: &Hierarchy) {
        let entity = body.entity;
        let kind = body.kind.copied().unwrap_or(RigidBody::Static);
        let posed = match body.parent {
            None => Posed::root(body.transform),
            Some(_) => {
                let above = hierarchy.above(entity);
                self.step
                    .nested
                    .read(&self.before.nested, entity, kind, body.transform, above)
            }
        };
        let has_children = self.step.has_children(entity);
        let own = body.collider.filter(|_| !body.collider_disabled);
        let is_plain = own.is_some() && hierarchy::place(&posed.stretched(&DAffine3::IDENTITY)).shear.is_none();
        if !has_children && body.center.is_none() && is_plain {
            self.single(body, &posed);
            return;
        }
        if own.is_none() && !has_children {
            return;
        }
        let assembly = body.body(&posed);
        let center = body
            .center
            .map(|center| (posed.stretch * center.0.as_dvec3()).as_vec3());
        let fault = match check_body(&assembly) {
            Ok(()) if center.is_some_and(|center| !center.is_finite()) => Some(BodyFault::NonFinite("CenterOfMass")),
            checked => checked.err(),
        };
        if let Some(fault) = fault {
            self.step.new_faults.push((entity, fault));
            return;
        }
        self.drive(body, &posed);
        let surface = body.surface.read();
        let number = self.step.assemblies.len() as u32;
        self.step.assemblies.push(Assembly {
            body: entity,
            values: assembly,
            center,
            stretch: posed.stretch,
            surface,
            compound: None,
        });
        if own.is_some() {
            self.part(number, entity, body.collider, &surface, &DAffine3::IDENTITY);
        }
    }

    /// Adds the colliders that are children.
    fn children(&mut self, bodies: &mut Query<BodyComponents, Or<(With<MeshCollider>, With<RigidBody>)>>) {
        let children = std::mem::take(&mut self.step.children);
        for &Child { collider, body, up } in &children {
            let Ok(item) = bodies.get(collider) else { continue };
            let surface = item.surface.read();
            match body {
                Some(body) => {
                    let assemblies = &self.step.assemblies;
                    // Those of an invalid body are left out with it.
                    if let Ok(number) = assemblies.binary_search_by_key(&body, |assembly| assembly.body) {
                        let surface = surface.or(&self.step.assemblies[number].surface);
                        self.part(number as u32, collider, item.collider, &surface, &up);
                    }
                }
                None => self.fixed(collider, item.collider, &surface, &up),
            }
        }
        self.step.children = children;
    }

    /// Adds a collider of an [`Assembly`]. `up` leads to the coordinates of its body.
    fn part(&mut self, number: u32, entity: Entity, collider: Option<&MeshCollider>, surface: &Surface, up: &DAffine3) {
        let assembly = &self.step.assemblies[number as usize];
        let posed = Posed {
            position: assembly.values.position,
            rotation: assembly.values.rotation,
            stretch: assembly.stretch,
        };
        let Placed { place, scale, shear } = hierarchy::place(&posed.stretched(up));
        let Some(mesh) = self.mesh(entity, collider, surface, shear.as_ref()) else {
            return;
        };
        let assembly = &self.step.assemblies[number as usize];
        let mut part = assembly.values.collider(mesh, &place, scale);
        surface.apply(&mut part, surface.culling.unwrap_or(self.culling));
        self.step.parts.push(AssemblyPart {
            assembly: number,
            collider: entity,
            place,
            density: part.density,
        });
        self.step.bodies.push((entity, part));
    }

    /// Adds a static collider below other entities. `up` leads to the world.
    fn fixed(&mut self, entity: Entity, collider: Option<&MeshCollider>, surface: &Surface, up: &DAffine3) {
        let Placed { place, scale, shear } = hierarchy::place(up);
        let Some(mesh) = self.mesh(entity, collider, surface, shear.as_ref()) else {
            return;
        };
        let origin = Body {
            kind: RigidBody::Static,
            ..Body::at_rest(mesh, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
        };
        let mut fixed = origin.collider(mesh, &place, scale);
        surface.apply(&mut fixed, surface.culling.unwrap_or(self.culling));
        self.step.bodies.push((entity, fixed));
    }

    /// The slot of a collider's mesh, with this shear applied. `None`, and maybe a fault, if it is not there.
    fn mesh(
        &mut self,
        entity: Entity,
        collider: Option<&MeshCollider>,
        surface: &Surface,
        shear: Option<&DMat3>,
    ) -> Option<u32> {
        let Meshes { meshes, assets } = self.meshes;
        let id = collider?.0.id();
        let step = &mut *self.step;
        let Some(mesh) = meshes.get(id) else {
            match assets.load_state(id) {
                LoadState::Loading | LoadState::Loaded => {}
                LoadState::NotLoaded => step.new_faults.push((entity, BodyFault::MeshMissing)),
                LoadState::Failed(_) => step.new_faults.push((entity, BodyFault::MeshFailed)),
            }
            return None;
        };
        let name = || {
            assets
                .get_path(id)
                .map_or_else(|| id.to_string(), |path| path.to_string())
        };
        if surface.culling.unwrap_or(self.culling) == Culling::FacesOfCollision && mesh.faces.is_none() {
            step.tables.request(id, mesh, name);
        }
        let mesh = step.tables.best(id, mesh);
        let arena = &mut step.state.input.meshes;
        let Some(shear) = shear else {
            return Some(slot(arena, &mut step.slots, id, mesh));
        };
        match step.sheared.request(entity, mesh, shear, arena, name) {
            Sheared::Ready(slot) => Some(slot),
            Sheared::Waits => None,
            Sheared::Failed => {
                step.new_faults.push((entity, BodyFault::Sheared));
                None
            }
        }
    }
}

/// The arena slot of the mesh with this asset. If the asset was replaced, for example by a hot reload, so is the mesh in the
/// slot.
fn slot(
    arena: &mut MeshArena,
    slots: &mut HashMap<AssetId<CollisionMesh>, u32>,
    id: AssetId<CollisionMesh>,
    mesh: &CollisionMesh,
) -> u32 {
    let slot = *slots.entry(id).or_insert_with(|| arena.add(mesh.clone()));
    if !arena[slot].mesh.is_same(mesh) {
        arena.replace(slot, mesh.clone());
    }
    slot
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
