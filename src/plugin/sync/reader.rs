//! Reads bodies and their colliders from components.

use super::children::{Child, ChildComponents, IsChild};
use super::components::{BodyComponents, BodyComponentsItem, Surface};
use super::driven::DrivenBodies;
use super::hierarchy::{self, Ancestor, NestedBodies, Node, Placed, Posed};
use super::kept::{Kept, ReadRules};
use super::order::{self, Keyed};
use super::sheared::Sheared;
use super::{Assembly, AssemblyPart, Candidate, Step};
use crate::asset::CollisionMesh;
use crate::plugin::components::*;
use crate::state::checks::check_body;
use crate::state::fault::BodyFault;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Body, StepInput};
use crate::types::body::*;
use crate::types::settings::{Culling, Response};
use bevy::asset::LoadState;
use bevy::ecs::system::SystemParam;
use bevy::math::{DAffine3, DMat3};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// Bodies, and colliders without a parent.
pub(super) type IsBody = Or<(With<RigidBody>, (With<MeshCollider>, Without<ChildOf>))>;

/// Bodies without any collider of their own.
type Bare = (
    With<RigidBody>,
    Without<MeshCollider>,
    Without<ColliderToCome>,
    Without<PlaneCollider>,
);

/// The hierarchy above colliders and bodies.
#[derive(SystemParam)]
pub(crate) struct Hierarchy<'w, 's> {
    nodes: Query<'w, 's, Node>,
    parents: Query<'w, 's, &'static ChildOf>,
    transforms: Query<'w, 's, &'static Transform>,
    pub(super) children: Query<'w, 's, ChildComponents, IsChild>,
    to_come: Query<'w, 's, Entity, (With<ColliderToCome>, With<ChildOf>, Without<MeshCollider>)>,
    bare: Query<'w, 's, (Entity, &'static RigidBody), Bare>,
}

/// The loaded meshes.
#[derive(SystemParam)]
pub(crate) struct Meshes<'w> {
    pub(super) meshes: Res<'w, Assets<CollisionMesh>>,
    assets: Res<'w, AssetServer>,
}

impl Hierarchy<'_, '_> {
    /// Whether a body has descendants that become colliders.
    fn will_have_children(&self, body: Entity) -> bool {
        let is_above =
            |entity| matches!(hierarchy::above(entity, &self.nodes), Ancestor::Body(above, _) if above == body);
        self.to_come.iter().any(is_above)
    }

    /// Lists the entities above static colliders and bodies, without repetition.
    pub(super) fn list_above(&self, children: &[Child], bodies: &[Entity], kept: &mut Kept) {
        let Kept { above, movers, .. } = kept;
        above.clear();
        let moves = |body: &Entity| movers.binary_search(body).is_ok();
        let children = children.iter().filter(|child| !child.body.as_ref().is_some_and(moves));
        let bodies = bodies.iter().filter(|body| !moves(body)).copied();
        let mut last = None;
        for entity in children.map(|child| child.collider).chain(bodies) {
            let parent = self.parents.get(entity).ok().map(ChildOf::parent);
            if parent == last {
                continue;
            }
            last = parent;
            let mut next = parent;
            while let Some(entity) = next {
                above.push(entity);
                next = self.parents.get(entity).ok().map(ChildOf::parent);
            }
        }
        above.sort_unstable();
        above.dedup();
    }

    /// The transformation from the coordinates of an entity to the world.
    pub(super) fn to_world(&self, entity: Entity) -> DAffine3 {
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
pub(super) struct PreviousBodies {
    pub nested: NestedBodies,
    pub driven: DrivenBodies,
}

/// Reads bodies and their colliders.
pub(super) struct Reader<'a, 'w> {
    pub step: &'a mut Step,
    pub meshes: &'a Meshes<'w>,
    pub rules: ReadRules,
    pub before: PreviousBodies,
    /// Whether the mesh of some collider is not there.
    pub misses_mesh: bool,
}

impl Reader<'_, '_> {
    /// Whether a body is its only collider, and below no other entity.
    fn is_single(&self, body: &BodyComponentsItem) -> bool {
        body.parent.is_none()
            && body.center.is_none()
            && body.collider.is_some()
            && !body.collider_disabled
            && !body.body_disabled
            && !self.step.children.are_below(body.entity)
    }

    /// Adds a body if it is its only collider, or else adds it to `others`.
    fn add(&mut self, body: &mut BodyComponentsItem, others: &mut Vec<Entity>) {
        body.note(self.rules.has_hooks, &mut self.step.warnings);
        if self.is_single(body) {
            let posed = Posed::root(body.transform);
            self.single(body, &posed);
        } else {
            others.push(body.entity);
        }
    }

    /// Adds these bodies, ascending.
    fn others(&mut self, bodies: &mut Query<BodyComponents, IsBody>, others: &mut [Entity], hierarchy: &Hierarchy) {
        // So that assemblies are ascending by the entity of their body.
        others.sort_unstable();
        for &entity in others.iter() {
            if let Ok(mut body) = bodies.get_mut(entity)
                && !body.body_disabled
            {
                self.any(&mut body, hierarchy);
            }
        }
    }

    /// Reads all bodies and colliders.
    pub fn all(&mut self, bodies: &mut Query<BodyComponents, IsBody>, hierarchy: &Hierarchy) {
        self.begin_all(hierarchy);
        // Bodies that have a parent or are not a single collider. They are few in most worlds.
        let mut others = std::mem::take(&mut self.step.others);
        others.clear();
        for mut body in &mut *bodies {
            if body.kind.is_some_and(|&kind| kind != RigidBody::Static) {
                self.step.kept.movers.push(body.entity);
            }
            self.add(&mut body, &mut others);
        }
        self.step.kept.movers.sort_unstable();
        self.others(bodies, &mut others, hierarchy);
        let all = 0..self.step.children.all().len() as u32;
        self.children(all);
        let step = &mut *self.step;
        step.others = others;
        #[cfg(feature = "gpu")]
        {
            step.last_nested = std::mem::take(&mut self.before.nested);
        }
        // The order of a query depends on archetypes. That of keys does not.
        order::sort(&mut step.candidates, |id| step.warnings.add_same_key(id));
        step.fill();
        let children = &step.children;
        let moving = (hierarchy.bare.iter())
            .filter(|&(entity, &kind)| kind != RigidBody::Static && !children.are_below(entity))
            .filter(|&(entity, _)| !hierarchy.will_have_children(entity));
        step.warnings.count_bare(moving.map(|(entity, _)| entity));
    }

    /// Forgets what has been read or kept, and finds the colliders below entities.
    fn begin_all(&mut self, hierarchy: &Hierarchy) {
        let step = &mut *self.step;
        step.new_faults.clear();
        step.candidates.clear();
        step.assemblies.clear();
        step.parts.clear();
        step.kept_assemblies = 0;
        step.warnings.restart();
        step.driven.take();
        step.kept.forget();
        step.kept.movers.clear();
        let known = std::mem::replace(&mut self.before.nested, step.nested.take());
        self.before.nested.0.extend(known.0);
        self.misses_mesh = false;
        let (has_hooks, warnings) = (self.rules.has_hooks, &mut step.warnings);
        (step.children).find(&hierarchy.children, &hierarchy.nodes, |entity, surface| {
            surface.note(entity, has_hooks, warnings);
        });
    }

    /// Reads moving bodies again, and dormant ones only if needed. Returns false if everything must be read again.
    pub fn at_most_moving(
        &mut self,
        bodies: &mut Query<BodyComponents, IsBody>,
        hierarchy: &Hierarchy,
        counts: [usize; 2],
    ) -> bool {
        self.moving(bodies, hierarchy, counts)
            || self.step.kept.may_skip_dormant() && self.all_moving(bodies, hierarchy, counts)
    }

    /// Reads moving bodies again, in a step that may keep the static colliders of the last one. `counts` are the
    /// numbers of bodies and of colliders below others. Returns false if everything must be read again.
    fn moving(
        &mut self,
        bodies: &mut Query<BodyComponents, IsBody>,
        hierarchy: &Hierarchy,
        counts: [usize; 2],
    ) -> bool {
        if !self.changed_statics(bodies) {
            self.step.kept.forget();
            return false;
        }
        let kept = &mut self.step.kept;
        let skips_dormant = kept.may_skip_dormant();
        let movers = std::mem::take(kept.bodies_to_read(skips_dormant));
        let mut gone = Vec::new();
        let mut others = std::mem::take(&mut self.step.others);
        others.clear();
        self.step
            .assemblies
            .retain(|assembly| assembly.values.kind == RigidBody::Static);
        self.step.kept_assemblies = self.step.assemblies.len();
        let mut is_same = true;
        for &entity in &movers {
            let Ok(mut body) = bodies.get_mut(entity) else {
                // The entity may be a static collider now.
                is_same &= !hierarchy.nodes.contains(entity);
                gone.push(entity);
                continue;
            };
            is_same &= body.kind.is_some_and(|&kind| kind != RigidBody::Static);
            // The step counts how long a body has no collider.
            is_same &= body.collider.is_some() || self.step.children.are_below(entity);
            self.add(&mut body, &mut others);
        }
        let read = movers.len() - gone.len();
        let kept = &mut self.step.kept;
        *kept.bodies_to_read(skips_dormant) = movers;
        kept.remove_movers(&gone);
        is_same &= counts[0] == kept.counts[0] + kept.mover_count(read, skips_dormant);
        if is_same {
            self.others(bodies, &mut others, hierarchy);
            is_same = self.moving_children(hierarchy, counts[1]);
        }
        self.step.others = others;
        is_same &= !self.misses_mesh;
        if is_same {
            let Step { candidates, kept, .. } = &mut *self.step;
            order::sort(candidates, |_| is_same = false);
            let mut stable = candidates.iter().filter(|candidate| candidate.id.is_stable());
            is_same &= !stable.any(|candidate| kept.rows.entities.has_key(candidate.id.key));
        }
        if is_same {
            let bodies = &mut self.step.state.input.bodies;
            if !skips_dormant {
                bodies.end_dormancy();
            }
            bodies.list_movers();
            is_same = self.step.fill_moving();
        }
        is_same && self.step.new_faults.is_empty()
    }

    /// Reads changed static colliders again. Returns false if all must be read again.
    fn changed_statics(&mut self, bodies: &mut Query<BodyComponents, IsBody>) -> bool {
        let mut changed = std::mem::take(&mut self.step.kept.changed);
        changed.sort_unstable();
        changed.dedup();
        let mut read = Vec::new();
        for &entity in &changed {
            let Ok(mut body) = bodies.get_mut(entity) else {
                return false;
            };
            if !self.is_single(&body) || self.step.assembly(entity).is_some() {
                return false;
            }
            body.note(self.rules.has_hooks, &mut self.step.warnings);
            let posed = Posed::root(body.transform);
            self.single(&mut body, &posed);
            let Some(Candidate { id, body, .. }) = self.step.candidates.pop() else {
                return false;
            };
            let entities = &self.step.kept.rows.entities;
            match entities.number_of(entity) {
                Some(number) if entities.keyed(number) == id => read.push((number as u32, body)),
                _ => return false,
            }
        }
        self.step.kept.statics_read += read.len();
        if read.is_empty() {
            return true;
        }
        let StepInput { bodies, meshes, .. } = &mut self.step.state.input;
        let is_valid = bodies.rewrite_static(&read, meshes).is_ok();
        self.step.kept.keep_changes(bodies);
        is_valid
    }

    /// Reads again what moves, dormant bodies too.
    fn all_moving(
        &mut self,
        bodies: &mut Query<BodyComponents, IsBody>,
        hierarchy: &Hierarchy,
        counts: [usize; 2],
    ) -> bool {
        let step = &mut *self.step;
        step.new_faults.clear();
        step.candidates.clear();
        step.parts.clear();
        step.warnings.restart();
        step.driven.take();
        step.kept.has_news = true;
        self.moving(bodies, hierarchy, counts)
    }

    /// Adds the colliders that are children of moving bodies, if there are `count` children in all.
    fn moving_children(&mut self, hierarchy: &Hierarchy, count: usize) -> bool {
        let mut children = std::mem::take(&mut self.step.children);
        let (kept, warnings) = (&self.step.kept, &mut self.step.warnings);
        let has_hooks = self.rules.has_hooks;
        let found = children.update(
            &kept.moving_children,
            &hierarchy.children,
            &hierarchy.nodes,
            |entity, surface| {
                surface.note(entity, has_hooks, warnings);
            },
        );
        let is_same = found.is_some_and(|found| count == kept.counts[1] + found);
        self.step.children = children;
        if is_same {
            let indices = std::mem::take(&mut self.step.kept.moving_children);
            self.children(indices.iter().copied());
            self.step.kept.moving_children = indices;
        }
        is_same
    }

    /// Adds a body that is its only collider.
    fn single(&mut self, body: &mut BodyComponentsItem, posed: &Posed) {
        let surface = body.surface.read();
        let Some(mesh) = body
            .collider
            .and_then(|collider| self.mesh(body.entity, collider.0.id(), &surface, None))
        else {
            return;
        };
        if let Some(center) = &mut body.computed_center {
            center.set_if_neq(ComputedCenterOfMass(
                self.step.state.input.meshes[mesh].mesh.mass.center,
            ));
        }
        let velocities = self.velocities(body);
        self.drive(body, posed, velocities);
        let stretch = posed.stretch;
        let mut own = body.body(posed, velocities);
        own.params.always_read = body.parent.is_some();
        own.mesh = mesh;
        own.scale = Vec3::new(
            stretch.x_axis.x as f32,
            stretch.y_axis.y as f32,
            stretch.z_axis.z as f32,
        );
        surface.apply(&mut own, surface.culling.unwrap_or(self.rules.culling));
        let id = Keyed::new(body.entity, body.key.copied());
        self.step.candidates.push(Candidate::single(id, own));
    }

    /// The velocities of a body, without values that the step has written to a kinematic one.
    fn velocities(&mut self, body: &BodyComponentsItem) -> [Vec3; 2] {
        let kind = body.kind.copied().unwrap_or(RigidBody::Static);
        self.step
            .driven
            .velocities(body.entity, kind, body.velocities(), body.driven)
    }

    /// Notes a kinematic body that moves by its `Transform`. What pushes nothing is better tested where it is put.
    fn drive(&mut self, body: &BodyComponentsItem, posed: &Posed, velocities: [Vec3; 2]) {
        let pushes = self.rules.response == Response::Contacts && !body.surface.is_sensor();
        if pushes && body.kind == Some(&RigidBody::Kinematic) && velocities == [Vec3::ZERO; 2] {
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
        let has_children = self.step.children.are_below(entity);
        let own = body.collider.filter(|_| !body.collider_disabled);
        let is_plain = own.is_some() && hierarchy::place(&posed.stretched(&DAffine3::IDENTITY)).shear.is_none();
        if !has_children && body.center.is_none() && is_plain {
            self.single(body, &posed);
            return;
        }
        if own.is_none() && !has_children {
            return;
        }
        let velocities = self.velocities(body);
        let assembly = body.body(&posed, velocities);
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
        self.drive(body, &posed, velocities);
        let surface = body.surface.read();
        let number = self.step.assemblies.len() as u32;
        self.step.assemblies.push(Assembly {
            body: entity,
            key: body.key.copied(),
            values: assembly,
            center,
            stretch: posed.stretch,
            surface,
            number: None,
            compound: None,
        });
        if let Some(MeshCollider(mesh)) = own {
            let placed = hierarchy::place(&DAffine3::from_mat3(posed.stretch));
            self.part(
                number,
                Keyed::new(entity, body.key.copied()),
                mesh.id(),
                &surface,
                &placed,
            );
        }
    }

    /// Adds the child colliders with these indices, which are ascending.
    fn children(&mut self, indices: impl Iterator<Item = u32>) {
        let mut children = std::mem::take(&mut self.step.children);
        let mut number = self.step.kept_assemblies;
        for at in indices {
            let child = &mut children.all()[at as usize];
            let Some(body) = child.body else {
                self.fixed(child);
                continue;
            };
            // Assemblies and children are ascending by body.
            while (self.step.assemblies.get(number)).is_some_and(|assembly| assembly.body < body) {
                number += 1;
            }
            // Colliders of an invalid body are left out with it.
            if let Some(assembly) = self.step.assemblies.get(number).filter(|it| it.body == body) {
                let surface = child.surface.or(&assembly.surface);
                let placed = child.place(&assembly.stretch);
                let id = Keyed::new(child.collider, child.key.or(assembly.key));
                self.part(number as u32, id, child.mesh, &surface, &placed);
            }
        }
        self.step.children = children;
    }

    /// Adds a collider of an [`Assembly`].
    fn part(
        &mut self,
        number: u32,
        id: Keyed,
        mesh: AssetId<CollisionMesh>,
        surface: &Surface,
        &Placed { pose, scale, shear }: &Placed,
    ) {
        let Some(mesh) = self.mesh(id.entity, mesh, surface, shear.as_ref()) else {
            return;
        };
        let assembly = &self.step.assemblies[number as usize];
        let mut part = assembly.values.collider(mesh, &pose, scale);
        surface.apply(&mut part, surface.culling.unwrap_or(self.rules.culling));
        self.step.parts.push(AssemblyPart {
            assembly: number,
            collider: id.entity,
            number: None,
            pose,
            density: part.density,
        });
        let is_joined = part.kind != RigidBody::Static;
        self.step.candidates.push(Candidate {
            id,
            body: part,
            is_joined,
        });
    }

    /// Adds a static collider below other entities.
    fn fixed(&mut self, child: &mut Child) {
        let (entity, surface) = (child.collider, child.surface);
        let Placed { pose, scale, shear } = child.place(&DMat3::IDENTITY);
        let Some(mesh) = self.mesh(entity, child.mesh, &surface, shear.as_ref()) else {
            return;
        };
        let origin = Body {
            kind: RigidBody::Static,
            ..Body::at_rest(mesh, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
        };
        let mut fixed = origin.collider(mesh, &pose, scale);
        surface.apply(&mut fixed, surface.culling.unwrap_or(self.rules.culling));
        let id = Keyed::new(entity, child.key);
        self.step.candidates.push(Candidate::single(id, fixed));
    }

    /// The slot of a collider's mesh, with this shear applied. `None`, and maybe a fault, if it is not there.
    fn mesh(
        &mut self,
        entity: Entity,
        id: AssetId<CollisionMesh>,
        surface: &Surface,
        shear: Option<&DMat3>,
    ) -> Option<u32> {
        let Meshes { meshes, assets } = self.meshes;
        let step = &mut *self.step;
        let Some(mesh) = meshes.get(id) else {
            self.misses_mesh = true;
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
        if surface.culling.unwrap_or(self.rules.culling) == Culling::FacesOfCollision && mesh.faces.is_none() {
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

/// The arena slot of the asset's mesh. If the asset was replaced, for example by a hot reload, so is the mesh in the
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
