//! Which pairs touch, from step to step: collisions that start and end.

use super::Step;
use super::collected::Collected;
use super::key_order::put_in_key_order;
use super::order::Keyed;
use crate::plugin::collisions::Collisions;
use crate::plugin::components::*;
use crate::plugin::events::{CollisionEnd, CollisionStart};
use crate::state::{Contacts, StepInput};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// A pair whose collision has started and not ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touching {
    /// The pair of colliders, with `first < second`.
    pub pair: [Keyed; 2],
    /// The bodies of the colliders.
    pub bodies: [Entity; 2],
    /// Seconds without a touch after which the collision ends.
    pub left: f32,
}

impl Touching {
    /// The two colliders.
    pub fn colliders(&self) -> [Entity; 2] {
        self.pair.map(|id| id.entity)
    }

    /// This collision with its pair in ascending order.
    pub fn ordered(mut self) -> Self {
        if self.pair[0] > self.pair[1] {
            self.pair.reverse();
            self.bodies.reverse();
        }
        self
    }

    /// Whether both are the same collision. A collider that became part of another body begins to touch anew.
    pub fn is_same(&self, other: &Self) -> bool {
        (self.pair, self.bodies) == (other.pair, other.bodies)
    }
}

/// Pairs whose collision has started and not ended.
#[derive(Default)]
pub(crate) struct TouchingPairs {
    /// Pairs that are not of dormant bodies, ascending.
    pub pairs: Vec<Touching>,
    /// Pairs of dormant bodies, ascending.
    dormant: Vec<Touching>,
    /// Scratch: the pairs after this step.
    now: Vec<Touching>,
    /// Scratch: pairs that no longer touch, but whose collision has not ended.
    lingering: Vec<Touching>,
    /// Scratch: the pairs in both orders.
    both_ways: Vec<(Entity, Keyed)>,
}

impl TouchingPairs {
    /// All pairs, ascending.
    pub fn all(&self) -> Vec<Touching> {
        let mut all = self.pairs.clone();
        all.extend_from_slice(&self.dormant);
        all.sort_unstable_by_key(|touching| touching.pair);
        all
    }

    /// Joins the pairs of bodies that were dormant to the others.
    pub fn join_dormant(&mut self) {
        if !self.dormant.is_empty() {
            self.pairs.append(&mut self.dormant);
            self.pairs.sort_unstable_by_key(|touching| touching.pair);
        }
    }

    /// Separates the pairs of dormant bodies from the others.
    fn separate(&mut self, dormant: &Contacts, results: &Collected, hold: f32) {
        add_touching(dormant, results, hold, &mut self.dormant);
        self.dormant.sort_unstable_by_key(|touching| touching.pair);
        let waits = |touching: &Touching| {
            let found = self.dormant.binary_search_by_key(&touching.pair, |own| own.pair);
            found.is_ok()
        };
        self.pairs.retain(|touching| !waits(touching));
    }

    /// Adds the pairs that no longer touch, but linger for `hold` seconds since their last touch, in steps of `dt`,
    /// unless they are `gone`.
    fn linger(&mut self, hold: f32, dt: f32, gone: impl Fn(&Touching) -> bool) {
        self.now.sort_unstable_by_key(|touching| touching.pair);
        let Self {
            pairs, now, lingering, ..
        } = self;
        lingering.clear();
        lingering.extend(pairs.iter().filter_map(|before| {
            let same = now.binary_search_by_key(&before.pair, |now| now.pair);
            let touches = same.is_ok_and(|at| now[at].is_same(before));
            let left = before.left.min(hold) - dt;
            let lingers = !touches && left > 0.0 && !gone(before);
            lingers.then_some(Touching { left, ..*before })
        }));
        now.append(lingering);
        now.sort_unstable_by_key(|touching| touching.pair);
    }

    /// What each collider and body touches, ascending.
    fn list_both_ways(&mut self) {
        let both = &mut self.both_ways;
        both.clear();
        for &Touching { pair, bodies, .. } in self.pairs.iter().chain(&self.dormant) {
            for (own, other) in [(0, 1), (1, 0)] {
                both.push((pair[own].entity, pair[other]));
                if bodies[own] != pair[own].entity {
                    both.push((bodies[own], pair[other]));
                }
            }
        }
        both.sort_unstable();
        // Several colliders of a body may touch the same one.
        both.dedup();
    }
}

impl Step {
    /// Finds which pairs touch after a step, and reports which collisions have started or ended. A collision ends
    /// `hold` seconds after the last touch.
    pub fn touch(&mut self, collisions: &mut Collisions, hold: f32, writers: &mut CollisionWriters) {
        let has_new_dormant = self.has_new_dormant();
        let Self {
            state,
            results,
            touching,
            written,
            engine,
            published_dormant,
            ..
        } = self;
        let Some(results) = results else { return };
        put_in_key_order(&mut state.results.contacts, &results.entities);
        touching.now.clear();
        add_touching(&state.results.contacts, results, hold, &mut touching.now);
        let dormant = &mut state.scratch.dormant;
        dormant.renumber_planes(results.entities.len() as u32);
        // If the number of colliders has changed, planes have other numbers.
        if has_new_dormant || collisions.rows.entities.len() != results.entities.len() {
            collisions.dormant_manifolds.copy_from(&dormant.manifolds);
        }
        if has_new_dormant {
            touching.join_dormant();
            collisions.dormant_contacts.clone_from(&dormant.contacts);
            put_in_key_order(&mut collisions.dormant_contacts, &results.entities);
            add_touching(&collisions.dormant_contacts, results, hold, &mut touching.now);
        }

        let is_latent = engine.is_latent();
        let was_taken_away = |before: &Touching| {
            let is_written = |entity: &Entity| written.binary_search(entity).is_ok();
            // If results come late, the arrays belong to another step.
            !is_latent
                && [before.colliders(), before.bodies].iter().flatten().any(is_written)
                && !is_near(results, &state.input, before.colliders())
        };
        touching.linger(hold, state.input.config.dt, |before| {
            let bodies = before.colliders().map(|entity| results.body_of(entity));
            bodies != before.bodies.map(Some) || was_taken_away(before)
        });
        differences(&touching.pairs, &touching.now, |touching, starts| {
            writers.send(touching, starts)
        });
        std::mem::swap(&mut touching.pairs, &mut touching.now);
        if has_new_dormant {
            *published_dormant = state.input.bodies.dormant.name;
            touching.separate(&collisions.dormant_contacts, results, hold);
        }
        writers.list(touching);
    }
}

/// Where collisions are written.
#[derive(SystemParam)]
pub(crate) struct CollisionWriters<'w, 's> {
    started: MessageWriter<'w, CollisionStart>,
    ended: MessageWriter<'w, CollisionEnd>,
    observed: Query<'w, 's, (), With<CollisionEventsEnabled>>,
    colliding: Query<'w, 's, (Entity, &'static mut CollidingEntities)>,
    commands: Commands<'w, 's>,
}

impl CollisionWriters<'_, '_> {
    /// Sends a message of a collision that starts or ends, and triggers its events.
    fn send(&mut self, touching: &Touching, starts: bool) {
        let ([a, b], [body_a, body_b]) = (touching.colliders(), touching.bodies);
        let event = |target, [collider1, collider2]: [Entity; 2], [body1, body2]: [Entity; 2]| CollisionStart {
            target,
            collider1,
            collider2,
            body1,
            body2,
        };
        let message = event(a, [a, b], [body_a, body_b]);
        if starts {
            self.started.write(message);
        } else {
            self.ended.write(message.into_end());
        }
        for (colliders, bodies) in [([a, b], [body_a, body_b]), ([b, a], [body_b, body_a])] {
            let (collider, body) = (colliders[0], bodies[0]);
            let body = Some(body).filter(|&body| body != collider);
            for target in [Some(collider), body].into_iter().flatten() {
                if !self.observed.contains(target) {
                    continue;
                }
                let event = event(target, colliders, bodies);
                if starts {
                    self.commands.trigger(event);
                } else {
                    self.commands.trigger(event.into_end());
                }
            }
        }
    }

    /// Lists what entities touch that want to know.
    fn list(&mut self, touching: &mut TouchingPairs) {
        if self.colliding.is_empty() {
            return;
        }
        touching.list_both_ways();
        let both = &touching.both_ways;
        for (entity, mut list) in &mut self.colliding {
            let first = both.partition_point(|&(own, _)| own < entity);
            let own = both[first..].iter().take_while(|&&(own, _)| own == entity);
            let others = own.map(|&(_, other)| other.entity);
            if !list.iter().copied().eq(others.clone()) {
                list.0.clear();
                list.0.extend(others);
            }
        }
    }
}

/// Adds the touching pairs, each of which ends `hold` seconds after its last touch.
fn add_touching(contacts: &Contacts, results: &Collected, hold: f32, touching: &mut Vec<Touching>) {
    let pairs = contacts.pairs.iter().map(|pair| Touching {
        pair: pair.bodies.map(|i| results.entities.keyed(i as usize)),
        bodies: pair.bodies.map(|i| results.bodies[i as usize]),
        left: if pair.passing { 0.0 } else { hold },
    });
    let planes = contacts.planes.iter().map(|c| {
        let plane = results.planes.keyed(c.plane as usize);
        let (collider, body) = (results.entities.keyed(c.body as usize), results.bodies[c.body as usize]);
        let touching = Touching {
            pair: [collider, plane],
            bodies: [body, plane.entity],
            left: hold,
        };
        touching.ordered()
    });
    touching.extend(pairs.chain(planes));
}

/// Whether the bounding spheres of a pair overlap, or one of them a plane.
fn is_near(collected: &Collected, input: &StepInput, pair: [Entity; 2]) -> bool {
    let bodies = &input.bodies;
    let number = |entity: &Entity| collected.entities.number_of(*entity);
    match [number(&pair[0]), number(&pair[1])] {
        [Some(a), Some(b)] => bodies.center[a].distance(bodies.center[b]) <= bodies.radius[a] + bodies.radius[b],
        [Some(i), None] | [None, Some(i)] => {
            let mut planes = collected.planes.iter().zip(&input.planes);
            let plane = planes.find(|&(entity, _)| pair.contains(&entity));
            plane.is_some_and(|(_, plane)| plane.normal.dot(bodies.center[i]) - plane.distance <= bodies.radius[i])
        }
        [None, None] => false,
    }
}

/// Walks two ascending lists, and calls `send` with each collision that is only in the second (`true`) or only in the
/// first (`false`).
fn differences(before: &[Touching], after: &[Touching], mut send: impl FnMut(&Touching, bool)) {
    let (mut before, mut after) = (before.iter().peekable(), after.iter().peekable());
    loop {
        match (before.peek(), after.peek()) {
            (Some(b), Some(a)) if b.is_same(a) => {
                before.next();
                after.next();
            }
            // When a collider changes its body, one collision ends, and then one starts.
            (Some(b), a) if a.is_none_or(|a| b.pair <= a.pair) => {
                send(b, false);
                before.next();
            }
            (_, Some(a)) => {
                send(a, true);
                after.next();
            }
            _ => return,
        }
    }
}
