//! What is kept of the last step: its static and its dormant bodies. If they have not changed, only the others are read
//! again.

use super::Candidate;
use super::children::Child;
use super::collected::Rows;
use super::entity_index_set::EntityIndexSet;
use crate::state::Bodies;
use crate::state::revision::Revision;
use crate::types::body::RigidBody;
use crate::types::settings::{Culling, Response};
use bevy::prelude::*;

/// Number of bodies at rest that are read faster than searched for changes.
const FEW_ENTITIES: usize = 64;
/// With more bodies that move for each one at rest, to read all takes no longer.
const MOST_MOVERS: usize = 4;

/// Most changes of static colliders that are noted; with more, all are read again.
const MOST_CHANGES: usize = 256;

/// The settings on which what is read of a body depends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ReadRules {
    pub culling: Culling,
    pub response: Response,
    pub has_hooks: bool,
}

/// What has the numbers of the last step.
pub(crate) struct UnchangedCounts {
    /// Number of first candidates that keep their numbers.
    pub candidates: usize,
    /// Number of first colliders that keep their numbers.
    pub colliders: usize,
}

/// What is kept of the last step.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    /// The state of the static colliders; unknown if all must be read again.
    revision: Revision,
    /// The static colliders.
    pub rows: Rows,
    /// All colliders, in the layout with this name.
    pub all_rows: Rows,
    layout: Revision,
    /// Whether the keys of the last step belong to this layout.
    pub has_keys: bool,
    /// The bodies that are not static, ascending, whether or not the step has them.
    pub movers: Vec<Entity>,
    /// The `movers` that are not dormant, ascending.
    pub awake: Vec<Entity>,
    /// The dormant `movers`, in the set with this name.
    dormant: EntityIndexSet,
    dormant_name: Revision,
    /// Whether users have written to dormant bodies, or some of them have gone.
    pub has_news: bool,
    /// Static colliders to which users have written.
    pub changed: Vec<Entity>,
    /// How many changed static colliders the step has read.
    pub statics_read: usize,
    /// Colliders of `movers` on other entities, by their indices among the
    /// [`ChildColliders`](super::children::ChildColliders).
    pub moving_children: Vec<u32>,
    /// The entities of `moving_children`, ascending.
    parts: Vec<Entity>,
    /// The entities above static colliders and bodies, without repetition.
    pub above: Vec<Entity>,
    /// Numbers of other bodies and colliders, and of other colliders below entities.
    pub counts: [usize; 2],
    rules: ReadRules,
}

impl Kept {
    /// Forgets the last step.
    pub fn forget(&mut self) {
        self.revision = Revision::UNKNOWN;
        self.layout = Revision::UNKNOWN;
        self.dormant_name = Revision::UNKNOWN;
        self.dormant.clear();
    }

    /// Whether a step with these rules may have the static colliders of `bodies`.
    pub fn may_hold(&self, bodies: &Bodies, rules: ReadRules) -> bool {
        self.revision.is(bodies.revision) && self.rules == rules
    }

    /// Static colliders have changed, but kept their numbers.
    pub fn keep_changes(&mut self, bodies: &Bodies) {
        self.revision = bodies.revision;
    }

    /// Notes which bodies are dormant after the last step.
    pub fn begin(&mut self, bodies: &Bodies) {
        self.changed.clear();
        self.statics_read = 0;
        let set = &bodies.dormant;
        if self.dormant_name.is(set.name) || self.dormant.is_empty() && set.count == 0 {
            return;
        }
        self.dormant.clear();
        self.dormant_name = set.name;
        if self.layout.is(bodies.layout) {
            let owners = &self.all_rows.bodies;
            set.members().for_each(|i| self.dormant.insert(owners[i as usize]));
        }
        let dormant = &self.dormant;
        self.awake.clear();
        self.awake
            .extend(self.movers.iter().filter(|&&body| !dormant.contains(body)));
    }

    /// Whether there are dormant bodies.
    pub fn has_dormant(&self) -> bool {
        !self.dormant.is_empty()
    }

    /// Whether a step may leave dormant bodies as they are.
    pub fn may_skip_dormant(&self) -> bool {
        !self.dormant.is_empty() && !self.has_news
    }

    /// The bodies that a step reads which are not static, ascending.
    pub fn bodies_to_read(&mut self, skips_dormant: bool) -> &mut Vec<Entity> {
        match skips_dormant {
            true => &mut self.awake,
            false => &mut self.movers,
        }
    }

    /// Removes bodies that no longer exist, ascending, and that a step would have read.
    pub fn remove_movers(&mut self, gone: &[Entity]) {
        if gone.is_empty() {
            return;
        }
        for list in [&mut self.movers, &mut self.awake] {
            list.retain(|entity| gone.binary_search(entity).is_err());
        }
    }

    /// Number of bodies that are not static, when `read` of them were read.
    pub fn mover_count(&self, read: usize, skips_dormant: bool) -> usize {
        if skips_dormant { read + self.dormant.len() } else { read }
    }

    /// Notes that something at rest has lost a component.
    pub fn note_removed(&mut self, entity: Entity) {
        if self.dormant.contains(entity) {
            self.has_news = true;
        } else if self.is_static(entity) {
            self.forget();
        }
    }

    /// Notes that users have written to a body. Returns whether all static bodies must be read again.
    pub fn note_written(&mut self, body: Entity, kind: Option<RigidBody>) -> bool {
        let is_static = match kind {
            Some(RigidBody::Static) => true,
            Some(_) => {
                self.has_news |= self.dormant.contains(body);
                false
            }
            None => !self.moves(body),
        };
        if is_static {
            self.changed.push(body);
        }
        self.changed.len() > MOST_CHANGES
    }

    /// How many colliders keep their numbers if these `candidates` are all colliders that are neither static nor
    /// dormant. `None` if a dormant collider would get another number.
    pub fn same_as_before(&self, bodies: &Bodies, candidates: &[Candidate]) -> Option<UnchangedCounts> {
        if !self.layout.is(bodies.layout) {
            let colliders = bodies.static_count;
            let has_dormant = bodies.dormant.count > 0;
            return (!has_dormant).then_some(UnchangedCounts {
                candidates: 0,
                colliders,
            });
        }
        let entities = &self.all_rows.entities;
        let moving = bodies.movers();
        let own = moving.clone().zip(candidates);
        let same = own
            .take_while(|(i, candidate)| entities.keyed(*i) == candidate.id)
            .count();
        let next = moving.clone().nth(same);
        if next.is_none() && same == candidates.len() {
            return Some(UnchangedCounts {
                candidates: same,
                colliders: bodies.len(),
            });
        }
        let last = bodies.dormant.flags.iter().rposition(|&flag| flag);
        let is_after = last.is_none_or(|last| {
            let mut new = candidates[same..].iter();
            next.is_none_or(|next| next > last) && new.all(|new| new.id.key > entities.keyed(last).key)
        });
        let ends = [last, same.checked_sub(1).and_then(|at| moving.clone().nth(at))];
        let end = ends.into_iter().flatten().max();
        is_after.then_some(UnchangedCounts {
            candidates: same,
            colliders: end.map_or(bodies.static_count, |end| end + 1),
        })
    }

    /// Keeps which collider of a step has which number. The first `same` have the numbers of the last step.
    pub fn keep_layout(&mut self, bodies: &mut Bodies, rows: &Rows, same: usize) {
        bodies.keep_layout(same);
        self.layout = bodies.layout;
        self.all_rows = rows.clone();
        self.has_keys = false;
    }

    /// Keeps what a step has read: its static colliders, and which of its `children` are parts of `movers`. All of its
    /// colliders are valid. `counts` are the numbers of bodies, including single colliders, and of colliders below
    /// entities; `asleep` bodies sleep.
    pub fn keep(
        &mut self,
        bodies: &mut Bodies,
        rows: &Rows,
        children: &[Child],
        rules: ReadRules,
        counts: [usize; 2],
        asleep: usize,
    ) {
        let movers = self.movers.len();
        let at_rest = (counts.iter().sum::<usize>() - movers).max(asleep);
        if at_rest <= FEW_ENTITIES || at_rest < movers / MOST_MOVERS {
            return;
        }
        bodies.keep_static();
        self.keep_layout(bodies, rows, 0);
        self.revision = bodies.revision;
        self.rows.begin_moving(rows);
        self.moving_children.clear();
        self.parts.clear();
        for (at, child) in (0..).zip(children) {
            if child.body.is_some_and(|body| self.movers.binary_search(&body).is_ok()) {
                self.moving_children.push(at);
                self.parts.push(child.collider);
            }
        }
        self.parts.sort_unstable();
        self.counts = [counts[0] - self.movers.len(), counts[1] - self.parts.len()];
        self.rules = rules;
    }

    /// Whether this is a body that moves, or a collider of one.
    pub fn moves(&self, entity: Entity) -> bool {
        self.movers.binary_search(&entity).is_ok() || self.parts.binary_search(&entity).is_ok()
    }

    /// Whether this is a static collider, or above one.
    fn is_static(&self, entity: Entity) -> bool {
        self.revision.is_known()
            && (self.rows.entities.number_of(entity).is_some() || self.above.binary_search(&entity).is_ok())
    }

    /// Adds a body that moves, or notes that users have written to it.
    pub fn add_mover(&mut self, entity: Entity) {
        self.has_news |= self.dormant.contains(entity);
        if let Err(at) = self.movers.binary_search(&entity) {
            self.movers.insert(at, entity);
        }
        if let Err(at) = self.awake.binary_search(&entity) {
            self.awake.insert(at, entity);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::plugin::FaceoffStep;
    use crate::plugin::components::PlaneCollider;
    use crate::plugin::sync::{Step, app_with_cube};
    use crate::types::body::RigidBody;
    use bevy::prelude::*;

    #[test]
    fn what_comes_and_goes_beside_dormant_bodies_leaves_nothing_behind() {
        let (mut app, cube) = app_with_cube();
        let world = app.world_mut();
        world.spawn(PlaneCollider::through(Vec3::ZERO, Vec3::Y));
        for i in 0..80 {
            let place = Transform::from_xyz(3.0 * i as f32, 0.51, 0.0);
            world.spawn((RigidBody::Dynamic, cube.clone(), place));
        }
        for _ in 0..100 {
            world.run_schedule(FaceoffStep);
        }
        assert!(world.resource::<Step>().kept.has_dormant());
        for _ in 0..100 {
            let place = Transform::from_xyz(0.0, 90.0, 0.0);
            let last = world.spawn((RigidBody::Dynamic, cube.clone(), place)).id();
            world.run_schedule(FaceoffStep);
            world.despawn(last);
        }
        let kept = &world.resource::<Step>().kept;
        assert!(kept.has_dormant());
        assert!(
            kept.movers.len() <= 81 && kept.awake.len() <= 1,
            "{} {}",
            kept.movers.len(),
            kept.awake.len()
        );
    }
}
