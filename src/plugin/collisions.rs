//! Results of the last step, to read.

use crate::manifolds::{ManifoldPoint, Manifolds};
use crate::state::{Contact, ContactPoint, Contacts, FacePair, PairContact, PlaneContact};
use crate::types::stage::Stage;
use bevy::prelude::*;
use std::fmt;
use std::time::Duration;

/// All pairs that touched in the last step: bodies, and bodies with planes.
///
/// Bodies touch if their surfaces meet at the beginning of the step, or one contains the other. With
/// [`Response::Contacts`](crate::types::settings::Response) they also do if they pushed each other at some time in the step, or came
/// nearer than the gap that bodies at rest keep
/// ([`SolverSettings::rest_offset`](crate::types::solver_settings::SolverSettings::rest_offset)). So do a sensor and another body that touched at
/// some time in the step, if one of the two has [`ContinuousCollision`](crate::plugin::components::ContinuousCollision). Whether they sleep
/// does not matter.
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

/// Two bodies that touch, or a body and a plane.
#[derive(Clone, Copy, Debug)]
pub struct Collision<'a> {
    /// The body of smaller [`Entity`]; the body, if the other is a [`PlaneCollider`](crate::plugin::components::PlaneCollider).
    pub entity1: Entity,
    /// The other.
    pub entity2: Entity,
    /// One is solid and has the other, or a connected component of it, inside, and no faces were found to intersect; with an
    /// approximate culling mode some may.
    pub contained: bool,
    /// Where they push each other, in one point; the normal points from the first to the second.
    pub contact: Contact,
    /// Intersecting faces as indices of the input meshes, the first body's as `a`, with their common segments.
    /// Empty where the two only lie on each other, with the gap that bodies at rest keep; and for planes.
    pub faces: &'a [FacePair],
    /// The points at which they pushed each other, in the world, and how strongly at each: the impulses of all add up to
    /// [`Collision::impulse`]. Some did not push: their impulse is 0.
    ///
    /// A step that is cut into several detection intervals ([`StepReport::intervals`]) has the points of each one, in order, in
    /// which the two touched; a place where they touch all the time is there once for each. Their impulses are 0 with
    /// [`Response::None`](crate::types::settings::Response). Empty with `Response::Impulse`, and for sensors.
    ///
    /// On a GPU all of it is the same with every [`Reading`](crate::plugin::settings::Reading) that publishes `Collisions`.
    pub points: &'a [ContactPoint],
    /// How strongly they pushed each other along the normals of their points, over the whole step, newton seconds: a weight at
    /// rest gives its weight times the length of the step. 0 unless the response is
    /// [`Response::Contacts`](crate::types::settings::Response), and for bodies asleep.
    pub impulse: f32,
    /// They did not touch at the beginning of the step, but on their ways within it: a sensor and another body, one of them with
    /// [`ContinuousCollision`](crate::plugin::components::ContinuousCollision). The contact is where they first touched.
    pub passing: bool,
}

impl Collisions {
    /// All pairs that touch: bodies first, in ascending order, then bodies with planes.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Collision<'_>> {
        let Contacts { pairs, planes, .. } = &self.contacts;
        (0..self.len()).map(move |i| match pairs.get(i) {
            Some(pair) => self.collision(pair),
            None => self.on_plane(&planes[i - pairs.len()]),
        })
    }

    /// How many pairs touch.
    pub fn len(&self) -> usize {
        self.contacts.pairs.len() + self.contacts.planes.len()
    }

    /// Whether nothing touches.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The collision of two bodies, or of a body and a plane, in either order, if they touch.
    pub fn get(&self, one: Entity, other: Entity) -> Option<Collision<'_>> {
        let find = |entities: &[Entity], entity| entities.binary_search(&entity).ok().map(|i| i as u32);
        let body = |entity| find(&self.entities, entity);
        match (body(one), body(other)) {
            (Some(i), Some(j)) => {
                let key = [i.min(j), i.max(j)];
                let pairs = &self.contacts.pairs;
                let found = pairs.binary_search_by_key(&key, |pair| pair.bodies).ok()?;
                Some(self.collision(&pairs[found]))
            }
            (Some(i), None) | (None, Some(i)) => {
                let plane = find(&self.planes, other).or_else(|| find(&self.planes, one))?;
                let planes = &self.contacts.planes;
                let found = planes.binary_search_by_key(&[i, plane], |c| [c.body, c.plane]).ok()?;
                Some(self.on_plane(&planes[found]))
            }
            (None, None) => None,
        }
    }

    /// All collisions of one body or plane.
    pub fn of(&self, entity: Entity) -> impl Iterator<Item = Collision<'_>> {
        self.iter().filter(move |c| c.entity1 == entity || c.entity2 == entity)
    }

    fn collision<'a>(&'a self, pair: &PairContact) -> Collision<'a> {
        let [entity1, entity2] = pair.bodies.map(|i| self.entities[i as usize]);
        Collision {
            entity1,
            entity2,
            contained: pair.contained,
            contact: pair.contact,
            faces: self.contacts.faces_of(pair),
            points: self.contacts.points_of(pair),
            impulse: pair.impulse,
            passing: pair.passing,
        }
    }

    fn on_plane<'a>(&'a self, contact: &PlaneContact) -> Collision<'a> {
        Collision {
            entity1: self.entities[contact.body as usize],
            entity2: self.planes[contact.plane as usize],
            contained: false,
            contact: Contact {
                point: contact.point,
                normal: contact.normal,
            },
            faces: &[],
            points: self.contacts.points_on(contact),
            impulse: contact.impulse,
            passing: false,
        }
    }

    /// The contact points of all pairs whose surfaces came nearer than the contact margin
    /// ([`SolverSettings::contact_margin`](crate::types::solver_settings::SolverSettings::contact_margin)), whether they touch or not: what
    /// a solver of your own needs. Ascending, pairs of bodies first, then bodies, as the first, with planes. Sensors have
    /// none, and there are none with [`Response::Impulse`](crate::types::settings::Response).
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
#[derive(Resource, Clone, Default)]
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
    /// [`Culling`](crate::types::settings::Culling). With none the step was exact.
    pub approximate_pairs: usize,
    /// Meshes that run exact until the face table is baked for which
    /// [`FacesOfCollision`](crate::types::settings::Culling::FacesOfCollision) asks.
    pub tables_in_bake: usize,
    /// Pairs of bodies that touch. With [`Reading::Resident`](crate::plugin::settings::Reading::Resident) and
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts) those whose faces intersect, or those that push each other,
    /// whichever are more: nobody compares the two lists.
    pub touching_pairs: usize,
    /// Contact points between bodies, and between bodies and planes, within the contact margin.
    pub contact_points: usize,
    /// Detection intervals into which the step was cut; see [`SolverSettings`](crate::types::solver_settings::SolverSettings).
    pub intervals: u32,
    /// Bodies asleep.
    pub sleeping: usize,
    /// Pairs of triangles whose boxes overlap, and which were therefore tested.
    pub triangle_tests: u64,
    /// Pairs of faces that intersect.
    pub face_pairs: usize,
    /// Steps on the GPU whose results are not published yet; see [`Reading`](crate::plugin::settings::Reading).
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

impl fmt::Debug for StepReport {
    /// As derived, but for the stages, which are named.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // Every field by name, so that a new one cannot be forgotten.
        let Self {
            step,
            bodies,
            stages: _,
            total,
            sphere_pairs,
            approximate_pairs,
            tables_in_bake,
            touching_pairs,
            contact_points,
            intervals,
            sleeping,
            triangle_tests,
            face_pairs,
            in_flight,
            waits,
        } = self;
        let stages = fmt::from_fn(|f| {
            let times = Stage::ALL.map(|stage| (stage, self.time(stage)));
            f.debug_map().entries(times).finish()
        });
        f.debug_struct("StepReport")
            .field("step", step)
            .field("bodies", bodies)
            .field("stages", &stages)
            .field("total", total)
            .field("sphere_pairs", sphere_pairs)
            .field("approximate_pairs", approximate_pairs)
            .field("tables_in_bake", tables_in_bake)
            .field("touching_pairs", touching_pairs)
            .field("contact_points", contact_points)
            .field("intervals", intervals)
            .field("sleeping", sleeping)
            .field("triangle_tests", triangle_tests)
            .field("face_pairs", face_pairs)
            .field("in_flight", in_flight)
            .field("waits", waits)
            .finish()
    }
}
