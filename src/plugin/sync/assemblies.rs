//! From collected bodies and colliders to the stages' arrays.

use super::Step;
use super::collected::Rows;
use super::components::Surface;
#[cfg(feature = "gpu")]
use super::latent::{ComponentState, Row};
use super::order::{self, InOrder, Keyed};
use crate::plugin::components::StableKey;
#[cfg(feature = "gpu")]
use crate::state::Motion;
use crate::state::fault::BodyFault;
use crate::state::{Body, LocalPose, NewCompoundPart, StepInput};
use crate::types::body::RigidBody;
#[cfg(feature = "gpu")]
use bevy::ecs::entity::EntityHashMap;
use bevy::math::DMat3;
use bevy::prelude::*;
use std::ops::Range;

/// A body whose colliders are placed in it.
pub(crate) struct Assembly {
    pub body: Entity,
    /// The key of the body, which its colliders without a key share.
    pub key: Option<StableKey>,
    /// Pose and values of the body, without a mesh.
    pub values: Body,
    /// Overrides the centre of mass, in the axes of the pose.
    pub center: Option<Vec3>,
    /// From the coordinates of the entity to the axes of the pose.
    pub stretch: DMat3,
    /// For colliders without their own.
    pub surface: Surface,
    /// The number of its first collider in the step, if it has one there.
    pub number: Option<u32>,
    /// Index among the compounds of the step; `None` for static bodies.
    pub compound: Option<u32>,
}

/// A collider of an [`Assembly`].
pub(crate) struct AssemblyPart {
    /// Index of the assembly.
    pub assembly: u32,
    pub collider: Entity,
    /// Number in the step, if it is valid.
    pub number: Option<u32>,
    pub pose: LocalPose,
    pub density: f32,
}

/// A collider that was read, valid or not.
pub(crate) struct Candidate {
    pub id: Keyed,
    pub body: Body,
    /// Whether it becomes part of an [`Assembly`] that moves.
    pub is_joined: bool,
}

impl Candidate {
    /// A collider that is a body by itself.
    pub fn single(id: Keyed, body: Body) -> Self {
        Self {
            id,
            body,
            is_joined: false,
        }
    }
}

impl Candidate {
    fn is_static(&self) -> bool {
        self.body.kind == RigidBody::Static
    }
}

impl InOrder for Candidate {
    fn is_static(&self) -> bool {
        self.is_static()
    }

    fn id(&self) -> Keyed {
        self.id
    }

    fn id_mut(&mut self) -> &mut Keyed {
        &mut self.id
    }
}

impl Step {
    /// Fills the stages' arrays with the bodies that were read, and records which of them are invalid. Static bodies
    /// come first, so that moving ones can come and go.
    pub fn fill(&mut self) {
        order::put_static_first(&mut self.candidates);
        let fixed = self.candidates.partition_point(Candidate::is_static);
        self.state.input.bodies.clear();
        self.collected.rows.clear();
        self.add_candidates(0..fixed);
        self.collected.rows.end_fixed();
        self.state.input.bodies.end_static();
        self.add_candidates(fixed..self.candidates.len());
        self.collected.rows.finish();
        self.collected.rows.body_counts[0] = self.collected.entities.fixed();
        self.join_parts(true);
    }

    /// Fills the arrays with the bodies that were read: all that are neither static nor dormant. The others stay as in
    /// the last step. Changes nothing and returns false if dormant bodies would get other numbers.
    pub fn fill_moving(&mut self) -> bool {
        let StepInput { bodies, meshes, .. } = &mut self.state.input;
        let Some(again) = self.kept.same_as_before(bodies, &self.candidates) else {
            return false;
        };
        let count = bodies.len();
        let (again, same) = (again.candidates, again.colliders);
        bodies.begin_rewriting(same);
        let moving = std::mem::take(&mut bodies.moving);
        for (&number, Candidate { id, body, is_joined }) in moving.iter().zip(&self.candidates) {
            if let Err(fault) = bodies.rewrite(number as usize, body, meshes, *is_joined) {
                self.new_faults.push((id.entity, fault));
            }
        }
        bodies.moving = moving;
        self.collected.rows.clone_from(&self.kept.all_rows);
        let is_new = same < count || again < self.candidates.len();
        if is_new {
            self.collected.rows.reopen(same);
            self.add_candidates(again..self.candidates.len());
            self.collected.rows.finish();
        }
        self.join_parts(is_new);
        if is_new {
            let bodies = &mut self.state.input.bodies;
            bodies.list_movers();
            self.kept.keep_layout(bodies, &self.collected.rows, same);
        }
        true
    }

    /// Adds some of the candidates to the arrays.
    fn add_candidates(&mut self, range: Range<usize>) {
        let StepInput { bodies, meshes, .. } = &mut self.state.input;
        let rows = &mut self.collected.rows;
        for &Candidate { id, body, is_joined } in &self.candidates[range] {
            let pushed = if is_joined {
                bodies.push_part(&body, meshes)
            } else {
                bodies.push(&body, meshes)
            };
            match pushed {
                Ok(()) => {
                    rows.entities.push(id);
                    rows.bodies.push(id.entity);
                    rows.kinds.push(body.kind);
                }
                Err(fault) => self.new_faults.push((id.entity, fault)),
            }
        }
    }

    /// Joins colliders to their bodies. `are_new`: their bodies are not known from the last step.
    fn join_parts(&mut self, are_new: bool) {
        if are_new {
            let colliders = self.collected.rows.entities.len();
            let fixed = self.collected.rows.entities.fixed();
            self.collected.rows.body_counts[1] = colliders - fixed;
        }
        let Self {
            state,
            assemblies,
            parts,
            collected,
            ..
        } = self;
        let StepInput {
            bodies: arrays, meshes, ..
        } = &mut state.input;
        let Rows {
            entities,
            bodies: owners,
            body_counts,
            ..
        } = &mut collected.rows;
        let mut next = 0;
        for part in parts.iter_mut() {
            // Most colliders of a body follow each other.
            let is_next = entities.get(next) == Some(part.collider);
            let number = if is_next {
                Some(next)
            } else {
                entities.number_of(part.collider)
            };
            next = number.map_or(next, |number| number + 1);
            part.number = number.map(|number| number as u32);
        }
        // By bodies, then colliders, so that the colliders of a body are contiguous.
        parts.sort_unstable_by_key(|part| {
            let Assembly { body, key, .. } = assemblies[part.assembly as usize];
            (Keyed::new(body, key), part.number)
        });
        let mut found = Vec::new();
        for own in parts.chunk_by(|part, next| part.assembly == next.assembly) {
            let assembly = &mut assemblies[own[0].assembly as usize];
            found.clear();
            found.extend(own.iter().filter_map(|part| {
                Some(NewCompoundPart {
                    collider: part.number?,
                    pose: part.pose,
                    density: part.density,
                })
            }));
            let is_static = assembly.values.kind == RigidBody::Static;
            if are_new {
                for part in &found {
                    owners.set(part.collider as usize, assembly.body);
                }
                body_counts[usize::from(!is_static)] -= found.len().saturating_sub(1);
            }
            assembly.number = found.first().map(|part| part.collider);
            // Colliders of a static body need not know each other: two static ones never collide.
            if found.is_empty() || is_static {
                continue;
            }
            assembly.compound = Some(arrays.compounds.len() as u32);
            let joined: Result<(), BodyFault> = arrays.join(&assembly.values, assembly.center, &found, meshes);
            debug_assert!(joined.is_ok(), "the body was checked");
        }
        arrays.end_joins();
    }

    /// The number of a body in the arrays, which is the number of its first collider. `None` if the step leaves the
    /// body out.
    pub fn number_of(&self, body: Entity) -> Option<usize> {
        match self.assembly(body) {
            Some(assembly) => assembly.number.map(|number| number as usize),
            None => self.collected.entities.number_of(body),
        }
    }

    /// The body whose colliders are placed in it.
    pub fn assembly(&self, body: Entity) -> Option<&Assembly> {
        // Assemblies kept from the last step, and others; each part is ascending.
        let (kept, read) = self.assemblies.split_at(self.kept_assemblies);
        let find = |own: &'_ [Assembly]| own.binary_search_by_key(&body, |assembly| assembly.body).ok();
        let at = find(read).map(|at| at + kept.len()).or_else(|| find(kept));
        Some(&self.assemblies[at?])
    }

    /// Links the bodies of the next step with the bodies of the last one.
    #[cfg(feature = "gpu")]
    pub fn link(&mut self, resident: bool) {
        let Self {
            state,
            candidates,
            assemblies,
            collected,
            latent,
            driven,
            ..
        } = self;
        let arrays = &mut state.input.bodies;
        let seen = |entity: Entity, body: &Body| ComponentState {
            motion: body.motion(),
            asleep: !body.params.woken,
            driven: driven.contains(entity),
        };
        let count = collected.entities.len() as u32;
        // Both lists are in the same order; the candidates also contain invalid bodies.
        let mut read = candidates.iter();
        let singles = (0..count).zip(collected.entities.iter()).filter_map(|(row, entity)| {
            let Candidate { body, .. } = read.find(|other| other.id.entity == entity)?;
            let own = Row {
                entity,
                kind: body.kind,
                row,
                collider: row,
            };
            arrays.part(row).is_none().then(|| (own, seen(entity, body)))
        });
        let compounds = assemblies.iter().filter_map(|assembly| {
            let compound = assembly.compound?;
            let own = Row {
                entity: assembly.body,
                kind: assembly.values.kind,
                row: count + compound,
                collider: arrays.compounds[compound as usize].number,
            };
            Some((own, seen(assembly.body, &assembly.values)))
        });
        let mut bodies: Vec<_> = singles.chain(compounds).collect();
        // Without stable keys these are two ascending lists, which a stable sort merges.
        bodies.sort_by_key(|(row, _)| row.entity);
        latent.link(
            collected.entities.iter(),
            arrays.compounds.len(),
            bodies.into_iter(),
            resident,
        );
        for i in 0..arrays.len() {
            let row = arrays
                .part(i as u32)
                .map_or(i, |part| count as usize + part.compound as usize);
            arrays.params[i].woken = latent.woken[row];
        }
    }

    /// Fills the arrays again, with the poses and velocities that `motion_of` gives for bodies. A body whose new state
    /// is invalid keeps the old one, which was valid.
    #[cfg(feature = "gpu")]
    pub fn refill(&mut self, motion_of: impl Fn(Entity) -> Option<Motion>) {
        let moved = |body: &Body, motion: Motion| Body {
            position: motion.position,
            rotation: motion.rotation,
            linear_velocity: motion.linear_velocity,
            angular_velocity: motion.angular_velocity,
            ..*body
        };
        for assembly in &mut self.assemblies {
            if let Some(motion) = motion_of(assembly.body) {
                let moved = moved(&assembly.values, motion);
                if crate::state::checks::check_body(&moved).is_ok() {
                    assembly.values = moved;
                }
            }
        }
        let meshes = &self.state.input.meshes;
        let parts: EntityHashMap<_> = (self.parts.iter())
            .map(|part| (part.collider, (part.assembly, part.pose)))
            .collect();
        for Candidate { id, body, .. } in &mut self.candidates {
            if let Some((assembly, pose)) = parts.get(&id.entity) {
                let assembly = &self.assemblies[*assembly as usize].values;
                let placed = assembly.collider(body.mesh, pose, body.scale);
                (body.position, body.rotation) = (placed.position, placed.rotation);
                (body.linear_velocity, body.angular_velocity) = (placed.linear_velocity, placed.angular_velocity);
            } else if let Some(motion) = motion_of(id.entity) {
                let moved = moved(body, motion);
                if crate::state::Bodies::default().push(&moved, meshes).is_ok() {
                    *body = moved;
                }
            }
        }
        self.fill();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plugin::components::ColliderDisabled;
    use crate::plugin::sync::app_with_cube;
    use crate::plugin::sync::collect::collect;

    /// A body without a number counts as leaving the step, and with late results the step waits for it.
    #[test]
    fn a_body_in_the_step_has_a_number_whatever_its_kind_and_colliders() {
        let (mut app, cube) = app_with_cube();
        let world = app.world_mut();
        let kinds = [RigidBody::Dynamic, RigidBody::Kinematic, RigidBody::Static];
        for (place, kind) in (0..).zip(kinds) {
            let at = Transform::from_xyz(5.0 * place as f32, 0.0, 0.0);
            let single = world.spawn((kind, cube.clone(), at)).id();
            let both = world.spawn((kind, cube.clone(), at)).id();
            let part = world.spawn((cube.clone(), Transform::default(), ChildOf(both))).id();
            let bare = world.spawn((kind, at)).id();
            world.run_system_cached(collect).unwrap();
            let number_of = |world: &World, body| world.resource::<Step>().number_of(body);
            assert!(number_of(world, single).is_some(), "{kind:?}");
            assert!(number_of(world, both).is_some(), "{kind:?}");
            assert_eq!(number_of(world, bare), None, "{kind:?}");
            for collider in [both, part] {
                world.entity_mut(collider).insert(ColliderDisabled);
            }
            world.run_system_cached(collect).unwrap();
            assert_eq!(number_of(world, both), None, "{kind:?}");
        }
    }
}
