//! From collected bodies and colliders to the stages' arrays.

use super::Step;
use super::collected::Collected;
use super::components::Surface;
#[cfg(feature = "gpu")]
use super::latent::{Row, Seen};
#[cfg(feature = "gpu")]
use crate::state::Motion;
use crate::state::fault::BodyFault;
use crate::state::{Body, NewPart, Place, StepInput};
use crate::types::body::RigidBody;
#[cfg(feature = "gpu")]
use bevy::ecs::entity::EntityHashSet;
use bevy::math::DMat3;
use bevy::prelude::*;

/// A body whose colliders are placed in it.
pub(crate) struct Assembly {
    pub body: Entity,
    /// Its pose and its values, without a mesh.
    pub values: Body,
    /// Overrides the centre of mass, in the axes of the pose.
    pub center: Option<Vec3>,
    /// From the coordinates of the entity to the axes of the pose.
    pub stretch: DMat3,
    /// For colliders without their own.
    pub surface: Surface,
    /// Its index among the compounds of the step.
    pub compound: Option<u32>,
}

/// A collider of an [`Assembly`].
pub(crate) struct AssemblyPart {
    /// Index of the assembly.
    pub assembly: u32,
    pub collider: Entity,
    pub place: Place,
    pub density: f32,
}

/// A collider that was read, valid or not.
pub(crate) struct Candidate {
    pub entity: Entity,
    pub body: Body,
    /// Whether it becomes part of an [`Assembly`] that moves.
    pub is_joined: bool,
}

impl Candidate {
    /// A collider that is a body by itself.
    pub fn single(entity: Entity, body: Body) -> Self {
        Self {
            entity,
            body,
            is_joined: false,
        }
    }
}

impl Step {
    /// Fills the stages' arrays with the bodies that were read, and records which of them are invalid.
    pub fn fill(&mut self) {
        let Self {
            state,
            candidates,
            assemblies,
            parts,
            collected,
            new_faults,
            ..
        } = self;
        let StepInput {
            bodies: arrays, meshes, ..
        } = &mut state.input;
        let Collected {
            entities,
            bodies: owners,
            kinds,
            body_count,
            ..
        } = collected;
        entities.clear();
        owners.clear();
        kinds.clear();
        arrays.clear();
        for candidate in candidates.iter() {
            let (entity, body) = (candidate.entity, &candidate.body);
            let pushed = if candidate.is_joined {
                arrays.push_part(body, meshes)
            } else {
                arrays.push(body, meshes)
            };
            match pushed {
                Ok(()) => {
                    entities.push(entity);
                    owners.push(entity);
                    kinds.push(body.kind);
                }
                Err(fault) => new_faults.push((entity, fault)),
            }
        }
        *body_count = entities.len();
        // Ascending by assembly, then collider, and those of one assembly follow each other.
        parts.sort_unstable_by_key(|part| (part.assembly, part.collider));
        let mut rest = &parts[..];
        let mut found = Vec::new();
        let mut next = 0;
        for (number, assembly) in (0..).zip(assemblies) {
            let count = rest.iter().take_while(|part| part.assembly == number).count();
            let (own, others) = rest.split_at(count);
            rest = others;
            found.clear();
            found.extend(own.iter().filter_map(|part| {
                // Most colliders of a body follow each other.
                if entities.get(next) != Some(&part.collider) {
                    next = entities.binary_search(&part.collider).ok()?;
                }
                let collider = next as u32;
                next += 1;
                Some(NewPart {
                    collider,
                    place: part.place,
                    density: part.density,
                })
            }));
            for part in &found {
                owners[part.collider as usize] = assembly.body;
            }
            *body_count -= found.len().saturating_sub(1);
            // Colliders of a static body need not know each other: two static ones never collide.
            if found.is_empty() || assembly.values.kind == RigidBody::Static {
                continue;
            }
            assembly.compound = Some(arrays.compounds.len() as u32);
            let joined: Result<(), BodyFault> = arrays.join(&assembly.values, assembly.center, &found, meshes);
            debug_assert!(joined.is_ok(), "the body was checked");
        }
        arrays.end_joins();
    }

    /// The number of a body in the arrays.
    pub fn number_of(&self, body: Entity) -> Option<usize> {
        match self.assemblies.binary_search_by_key(&body, |assembly| assembly.body) {
            Ok(at) => {
                let compound = self.assemblies[at].compound?;
                Some(self.state.input.bodies.compounds[compound as usize].number as usize)
            }
            Err(_) => self.collected.entities.binary_search(&body).ok(),
        }
    }

    /// Links the bodies of the step that is about to run with those of the last one.
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
        let seen = |entity: Entity, body: &Body| Seen {
            motion: body.motion(),
            asleep: !body.params.woken,
            driven: driven.contains(entity),
        };
        let count = collected.entities.len() as u32;
        // Both lists are ascending, and the candidates have invalid ones too.
        let mut read = candidates.iter();
        let singles = (0..count).zip(&collected.entities).filter_map(|(row, &entity)| {
            let Candidate { body, .. } = read.find(|other| other.entity == entity)?;
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
        let (mut singles, mut compounds) = (singles.peekable(), compounds.peekable());
        let merged = std::iter::from_fn(|| match (singles.peek(), compounds.peek()) {
            (Some((one, _)), Some((other, _))) if other.entity < one.entity => compounds.next(),
            (Some(_), _) => singles.next(),
            (None, _) => compounds.next(),
        });
        latent.link(&collected.entities, arrays.compounds.len(), merged, resident);
        for i in 0..arrays.len() {
            let row = arrays
                .part(i as u32)
                .map_or(i, |part| count as usize + part.compound as usize);
            arrays.params[i].woken = latent.woken[row];
        }
    }

    /// Fills the arrays again, with the poses and velocities that `motion_of` gives for bodies. A body whose new state is
    /// invalid keeps the old one, which was valid.
    #[cfg(feature = "gpu")]
    pub fn refill(&mut self, motion_of: impl Fn(Entity) -> Option<Motion>) {
        let moved = |body: &Body, motion: Motion| Body {
            position: motion.position,
            rotation: motion.rotation,
            linear_velocity: motion.linear_velocity,
            angular_velocity: motion.angular_velocity,
            ..*body
        };
        let meshes = &self.state.input.meshes;
        let parts: EntityHashSet = self.parts.iter().map(|part| part.collider).collect();
        for Candidate { entity, body, .. } in &mut self.candidates {
            let Some(motion) = motion_of(*entity).filter(|_| !parts.contains(entity)) else {
                continue;
            };
            let moved = moved(body, motion);
            if crate::state::Bodies::default().push(&moved, meshes).is_ok() {
                *body = moved;
            }
        }
        for assembly in &mut self.assemblies {
            if let Some(motion) = motion_of(assembly.body) {
                let moved = moved(&assembly.values, motion);
                if crate::state::bodies::check_body(&moved).is_ok() {
                    assembly.values = moved;
                }
            }
        }
        for part in &self.parts {
            let at = (self.candidates).binary_search_by_key(&part.collider, |candidate| candidate.entity);
            if let Ok(at) = at {
                let own = &mut self.candidates[at].body;
                let placed = self.assemblies[part.assembly as usize]
                    .values
                    .collider(own.mesh, &part.place, own.scale);
                (own.position, own.rotation) = (placed.position, placed.rotation);
                (own.linear_velocity, own.angular_velocity) = (placed.linear_velocity, placed.angular_velocity);
            }
        }
        self.fill();
    }
}
