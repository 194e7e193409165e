//! Results of the last step, to read.

use crate::stages::Stage;
use crate::stages::manifolds::{ManifoldPoint, Manifolds};
use crate::stages::state::{Contact, Contacts, FacePair, TouchingPair};
use bevy::prelude::*;
use std::time::Duration;

/// All pairs of bodies that touched in the last fixed step; planes are not among them.
///
/// Bodies touch if their surfaces meet at the beginning of the step, or one contains the other. With
/// [`Response::Contacts`](crate::settings::Response) they also do if they pushed each other at some time in the step, or came
/// nearer than the gap that bodies at rest keep
/// ([`SolverSettings::rest_offset`](crate::settings::SolverSettings::rest_offset)).
///
/// "Ascending" and "smaller" are meant in the order of [`Entity`], in which a younger entity may come first.
#[derive(Resource, Debug, Default)]
pub struct Collisions {
    /// Ascending, so that body indices are in the order of entities.
    pub(crate) entities: Vec<Entity>,
    /// Ascending too; numbered after the bodies.
    pub(crate) planes: Vec<Entity>,
    pub(crate) contacts: Contacts,
    pub(crate) manifolds: Manifolds,
}

/// Two bodies that touch.
#[derive(Clone, Copy, Debug)]
pub struct Collision<'a> {
    /// The one of smaller [`Entity`].
    pub entity1: Entity,
    /// The other.
    pub entity2: Entity,
    /// One is closed and has the other, or a connected component of it, inside, and no faces were found to intersect; with an
    /// approximate culling mode some may.
    pub contained: bool,
    /// Where they push each other; the normal points from the first to the second.
    pub contact: Contact,
    /// Intersecting faces as indices of the input meshes, the first body's as `a`, with their common segments.
    /// Empty where the two only lie on each other, with the gap that bodies at rest keep, or sleep.
    pub faces: &'a [FacePair],
    /// The points at which they pushed each other last in the step. Empty with
    /// [`Response::Impulse`](crate::settings::Response), and for sensors.
    pub points: &'a [ManifoldPoint],
    /// How strongly they pushed each other along the normals of their points, over the whole step, newton seconds: a weight at
    /// rest gives its weight times the length of the step. 0 unless the response is
    /// [`Response::Contacts`](crate::settings::Response), and for bodies asleep.
    pub impulse: f32,
}

impl Collisions {
    /// All touching pairs in ascending order of entities.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Collision<'_>> {
        self.contacts.pairs.iter().map(|pair| self.collision(pair))
    }

    /// How many pairs touch.
    pub fn len(&self) -> usize {
        self.contacts.pairs.len()
    }

    /// Whether nothing touches.
    pub fn is_empty(&self) -> bool {
        self.contacts.pairs.is_empty()
    }

    /// The collision of two bodies, in either order, if they touch.
    pub fn get(&self, one: Entity, other: Entity) -> Option<Collision<'_>> {
        let index = |entity| self.entities.binary_search(&entity).ok().map(|i| i as u32);
        let (i, j) = (index(one)?, index(other)?);
        let key = [i.min(j), i.max(j)];
        let pairs = &self.contacts.pairs;
        let found = pairs.binary_search_by_key(&key, |pair| pair.bodies).ok()?;
        Some(self.collision(&pairs[found]))
    }

    /// All collisions of one body.
    pub fn of(&self, entity: Entity) -> impl Iterator<Item = Collision<'_>> {
        self.iter().filter(move |c| c.entity1 == entity || c.entity2 == entity)
    }

    fn collision<'a>(&'a self, pair: &TouchingPair) -> Collision<'a> {
        let [entity1, entity2] = pair.bodies.map(|i| self.entities[i as usize]);
        Collision {
            entity1,
            entity2,
            contained: pair.contained,
            contact: pair.contact,
            faces: self.contacts.faces_of(pair),
            points: self.points(pair.bodies),
            impulse: pair.impulse,
        }
    }

    fn points(&self, bodies: [u32; 2]) -> &[ManifoldPoint] {
        self.manifolds.find(bodies, self.entities.len() as u32)
    }

    /// The contact points of all pairs whose surfaces came nearer than the contact margin
    /// ([`SolverSettings::contact_margin`](crate::settings::SolverSettings::contact_margin)), whether they touch or not: what
    /// a solver of your own needs. Ascending, pairs of bodies first, then bodies, as the first, with planes. Sensors have
    /// none, and there are none with [`Response::Impulse`](crate::settings::Response).
    pub fn manifolds(&self) -> impl Iterator<Item = (Entity, Entity, &[ManifoldPoint])> {
        let entity = |i: u32| {
            let bodies = self.entities.len();
            let i = i as usize;
            if i < bodies {
                self.entities[i]
            } else {
                self.planes[i - bodies]
            }
        };
        let pairs = self.manifolds.pairs.iter();
        pairs.map(move |pair| {
            let [a, b] = pair.bodies.map(entity);
            (a, b, self.manifolds.points_of(pair))
        })
    }
}

/// Times and counts of the last fixed step.
#[derive(Resource, Clone, Debug, Default)]
pub struct StepReport {
    /// Steps since the app began.
    pub step: u64,
    /// Bodies that took part.
    pub bodies: usize,
    /// Time of each stage, in the order of [`Stage::ALL`]: wall time on the CPU, device time on a GPU. Zero on a GPU that
    /// has no time stamps.
    pub stages: [Duration; Stage::COUNT],
    /// Wall time of the whole step, copying components in and results out included.
    pub total: Duration,
    /// Pairs of bodies whose bounding spheres overlap, with the margin within which contact points are looked for.
    pub sphere_pairs: usize,
    /// Pairs of bodies whose triangles were tested with some left out by an approximate
    /// [`Culling`](crate::settings::Culling). With none the step was exact.
    pub approximate_pairs: usize,
    /// Meshes that run exact until the face table is baked for which
    /// [`FacesOfCollision`](crate::settings::Culling::FacesOfCollision) asks.
    pub tables_in_bake: usize,
    /// Pairs of bodies that touch. With [`Reading::Resident`](crate::settings::Reading::Resident) and
    /// [`Response::Contacts`](crate::settings::Response::Contacts) those whose faces intersect, or those that push each other,
    /// whichever are more: nobody compares the two lists.
    pub touching_pairs: usize,
    /// Contact points between bodies, and between bodies and planes, within the contact margin.
    pub contact_points: usize,
    /// Detection intervals into which the step was cut; see [`SolverSettings`](crate::settings::SolverSettings).
    pub intervals: u32,
    /// Bodies asleep.
    pub sleeping: usize,
    /// Pairs of triangles whose boxes overlap, and which were therefore tested.
    pub triangle_tests: u64,
    /// Pairs of faces that intersect.
    pub face_pairs: usize,
    /// Steps on the GPU whose results are not published yet; see [`Reading`](crate::settings::Reading).
    pub in_flight: usize,
    /// How often a step had to wait for the results of another one.
    pub waits: u64,
}

impl StepReport {
    /// Time of one stage; see [`StepReport::stages`].
    pub fn time(&self, stage: Stage) -> Duration {
        self.stages[stage as usize]
    }
}
