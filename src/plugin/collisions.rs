//! Results of the last step: [`Collisions`] and [`StepReport`].

use crate::manifolds::{ManifoldPoint, Manifolds};
use crate::plugin::sync::Rows;
use crate::plugin::sync::order::Numbers;
use crate::state::manifolds::pair_order;
use crate::state::{Contact, ContactPoint, Contacts, FacePair, PairContact, PlaneContact};
use crate::types::energy::Energy;
use crate::types::gpu_work::GpuWork;
use crate::types::stage::Stage;
use bevy::prelude::*;
use std::fmt;
use std::time::Duration;

/// All pairs that touched in the last step: pairs of colliders of different bodies, and colliders with planes.
///
/// Two colliders touch if their surfaces intersect at the beginning of the step, or if one contains the other. With
/// [`Response::Contacts`](crate::types::settings::Response::Contacts) they also touch
/// * if they pushed each other at any time in the step,
/// * if they came nearer than the gap between bodies at rest
///   ([`SolverSettings::rest_offset`](crate::types::solver_settings::SolverSettings::rest_offset)),
/// * if one is a sensor, one of the two has [`ContinuousCollision`](crate::plugin::components::ContinuousCollision),
///   and they met at any time in the step.
///
/// Bodies asleep touch like bodies awake. "Ascending" and "smaller" refer to the order of
/// [`StableKey`](crate::plugin::components::StableKey), and then, for colliders without one, to the order of spawning.
/// An entity with the index of one that was despawned comes after those that have a new index.
#[derive(Resource, Reflect, Debug, Default)]
#[reflect(Resource, Default, Debug)]
pub struct Collisions {
    /// The colliders and their bodies.
    #[reflect(ignore)]
    pub(crate) rows: Rows,
    /// Entity of each plane. In manifolds, planes are numbered after the colliders.
    #[reflect(ignore)]
    pub(crate) planes: Numbers,
    #[reflect(ignore)]
    pub(crate) contacts: Contacts,
    #[reflect(ignore)]
    pub(crate) manifolds: Manifolds,
    /// Contacts and manifolds of dormant bodies, which `contacts` and `manifolds` lack.
    #[reflect(ignore)]
    pub(crate) dormant_contacts: Contacts,
    #[reflect(ignore)]
    pub(crate) dormant_manifolds: Manifolds,
}

/// Two colliders that touch, or a collider and a plane.
#[derive(Clone, Copy, Debug)]
pub struct Collision<'a> {
    /// The smaller collider, or the collider that touches a
    /// [`PlaneCollider`](crate::plugin::components::PlaneCollider).
    pub collider1: Entity,
    /// The other collider, or the plane.
    pub collider2: Entity,
    /// The body of `collider1`: the nearest entity with a [`RigidBody`](crate::types::body::RigidBody), or the collider
    /// itself if there is none.
    pub body1: Entity,
    /// The body of `collider2`.
    pub body2: Entity,
    /// Whether one is solid and contains the other, or a connected component of it, while no intersecting faces were
    /// found. With an approximate culling mode some faces may intersect all the same.
    pub contained: bool,
    /// The contact, reduced to one point in the world. The normal points from the first collider to the second.
    pub contact: Contact,
    /// Intersecting face pairs with their common segments in the world, if
    /// [`FaceLists`](crate::plugin::settings::FaceLists) asks for them; else `None`. Faces are indices into the source
    /// meshes; `a` is a face of `collider1`. Empty if the two are only near each other, like bodies at rest, and for
    /// planes.
    ///
    /// Faces of rounded meshes are those whose roundings touch. Bodies of which one is rounded have none while they
    /// push each other.
    pub faces: Option<&'a [FacePair]>,
    /// Contact points in the world, each with its normal impulse. The impulses add up to [`Collision::impulse`]. Points
    /// that did not push have impulse 0.
    ///
    /// A step with several collision substeps ([`StepReport::collision_substeps`]) has the points of each collision
    /// substep in which the two touched, in order. A persistent contact therefore appears once per collision substep.
    /// With [`Response::None`](crate::types::settings::Response::None) all impulses are 0. With `Response::Impulse`,
    /// and for sensors, there are no points.
    ///
    /// On a GPU the points are the same with every [`Readback`](crate::plugin::settings::Readback) that publishes
    /// `Collisions`.
    pub points: &'a [ContactPoint],
    /// Total normal impulse over the step, in newton seconds: for a body at rest, its weight times the length of the
    /// step. 0 for bodies asleep, and unless the response is
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts).
    pub impulse: f32,
    /// Whether the two did not touch at the beginning of the step but met within it: a sensor and another body, one of
    /// them with [`ContinuousCollision`](crate::plugin::components::ContinuousCollision). The contact is where they
    /// first touched.
    pub passing: bool,
}

impl Collisions {
    /// All touching pairs in ascending order: first pairs of colliders, then colliders with planes.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Collision<'_>> {
        Iter {
            collisions: self,
            pairs: Merged(self.both().map(|some| &some.pairs[..])),
            planes: Merged(self.both().map(|some| &some.planes[..])),
        }
    }

    /// The contacts of bodies that were in the last step, and of dormant bodies.
    fn both(&self) -> [&Contacts; 2] {
        [&self.contacts, &self.dormant_contacts]
    }

    /// Number of touching pairs.
    pub fn len(&self) -> usize {
        let count = |contacts: &Contacts| contacts.pairs.len() + contacts.planes.len();
        self.both().map(count).iter().sum()
    }

    /// Number of pairs with contact points.
    #[cfg(feature = "debug_panel")]
    pub(crate) fn manifold_count(&self) -> usize {
        self.manifolds.pairs.len() + self.dormant_manifolds.pairs.len()
    }

    /// Number of colliders that touch planes, for each plane.
    #[cfg(feature = "debug_panel")]
    pub(crate) fn plane_pairs(&self) -> usize {
        self.both().map(|contacts| contacts.planes.len()).iter().sum()
    }

    /// Whether no pair touches.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The collision of two colliders, or of a collider and a plane, if they touch. The order of arguments does not
    /// matter. Takes time logarithmic in the number of colliders and pairs. For bodies of several colliders see
    /// [`Collisions::of`].
    pub fn get(&self, one: Entity, other: Entity) -> Option<Collision<'_>> {
        let find = |numbers: &Numbers, entity| numbers.number_of(entity).map(|i| i as u32);
        let colliders = &self.rows.entities;
        let key = |i: u32| colliders.keyed(i as usize);
        let body = |entity| find(colliders, entity);
        match (body(one), body(other)) {
            (Some(i), Some(j)) => {
                let [i, j] = [key(i), key(j)];
                let wanted = [i.min(j), i.max(j)];
                self.both().into_iter().find_map(|contacts| {
                    let pairs = &contacts.pairs;
                    let found = pairs.binary_search_by_key(&wanted, |pair| pair.bodies.map(key)).ok()?;
                    Some(self.collision(contacts, &pairs[found]))
                })
            }
            (Some(i), None) | (None, Some(i)) => {
                let plane = find(&self.planes, other).or_else(|| find(&self.planes, one))?;
                let wanted = (key(i), plane);
                self.both().into_iter().find_map(|contacts| {
                    let planes = &contacts.planes;
                    let found = planes.binary_search_by_key(&wanted, |c| (key(c.body), c.plane)).ok()?;
                    Some(self.on_plane(contacts, &planes[found]))
                })
            }
            (None, None) => None,
        }
    }

    /// All collisions of one collider, body or plane. Takes time linear in the number of touching pairs.
    pub fn of(&self, entity: Entity) -> impl Iterator<Item = Collision<'_>> {
        self.iter()
            .filter(move |c| [c.collider1, c.collider2, c.body1, c.body2].contains(&entity))
    }

    /// The body of a collider; `None` for planes.
    #[cfg(any(feature = "debug_gizmos", feature = "debug_panel"))]
    pub(crate) fn body_of(&self, collider: Entity) -> Option<Entity> {
        let at = self.rows.entities.number_of(collider)?;
        Some(self.rows.bodies[at])
    }

    fn collision<'a>(&'a self, contacts: &'a Contacts, pair: &PairContact) -> Collision<'a> {
        let [collider1, collider2] = pair.bodies.map(|i| self.rows.entities[i as usize]);
        let [body1, body2] = pair.bodies.map(|i| self.rows.bodies[i as usize]);
        Collision {
            collider1,
            collider2,
            body1,
            body2,
            contained: pair.contained,
            contact: pair.contact,
            faces: self.contacts.lists_faces.then(|| contacts.faces_of(pair)),
            points: contacts.points_of(pair),
            impulse: pair.impulse,
            passing: pair.passing,
        }
    }

    fn on_plane<'a>(&'a self, contacts: &'a Contacts, contact: &PlaneContact) -> Collision<'a> {
        let plane = self.planes[contact.plane as usize];
        Collision {
            collider1: self.rows.entities[contact.body as usize],
            collider2: plane,
            body1: self.rows.bodies[contact.body as usize],
            body2: plane,
            contained: false,
            contact: Contact {
                point: contact.point,
                normal: contact.normal,
            },
            faces: self.contacts.lists_faces.then_some(&[]),
            points: contacts.points_on(contact),
            impulse: contact.impulse,
            passing: false,
        }
    }

    /// The contact manifolds of all pairs whose surfaces came nearer than a margin, whether they touch or not. With
    /// [`Response::None`](crate::types::settings::Response::None) the margin of two colliders is
    /// [`SolverSettings::contact_margin`](crate::types::solver_settings::SolverSettings::contact_margin). With
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts) it is the speculative margin, which also
    /// grows with the relative speed of the two. With both responses the margin of a collider and a plane is a
    /// hundredth of the collider's diameter, and grows with its speed.
    ///
    /// In the order of the step: first pairs of colliders, then colliders (first) with planes (second). Within a pair
    /// the static collider comes first, else the smaller one. Sensors have no manifolds, and
    /// [`Response::Impulse`](crate::types::settings::Response::Impulse) makes none.
    ///
    /// # A solver of your own
    ///
    /// The example `custom_response` is one. Set [`Response::None`](crate::types::settings::Response::None), and add a
    /// system to [`FaceoffStep`](crate::plugin::FaceoffStep) in the set
    /// [`FaceoffSystems::Respond`](crate::plugin::FaceoffSystems::Respond). It reads the manifolds and writes
    /// [`LinearVelocity`](crate::types::body::LinearVelocity) and
    /// [`AngularVelocity`](crate::types::body::AngularVelocity), with which the next step moves the bodies.
    ///
    /// * **Points are from the beginning of the step**, before bodies moved. Since then the separation of a point has
    ///   changed by about the relative velocity along the normal, as the components have it, times the length of the
    ///   step.
    /// * **The next step adds gravity** to the velocities, [`Gravity`](crate::plugin::settings::Gravity) times the
    ///   length of the step, before it moves the bodies. Solve for the velocities with gravity, and write them without.
    /// * **The length of a step** is the delta of the resource `Time`, which is the physics clock there.
    /// * **The margin of two colliders does not grow with speed** with `Response::None`. Set `contact_margin` to the
    ///   distance that bodies may travel in a step, as a part of their diameter, so that a contact is seen before they
    ///   overlap.
    /// * **Mass and inertia** are yours. [`CollisionMesh::mass`](crate::asset::BakedMesh::mass) has those of a mesh,
    ///   about the centre of mass, where anchors begin.
    /// * **The colliders' bodies** have the velocities. Where bodies have colliders on children, find them by
    ///   `ChildOf`.
    /// * **On a GPU** use [`Readback::Lockstep`](crate::plugin::settings::Readback::Lockstep). Otherwise the manifolds
    ///   are some steps old, and contacts are solved too late.
    pub fn manifolds(&self) -> impl Iterator<Item = (Entity, Entity, &[ManifoldPoint])> {
        let both = [&self.manifolds, &self.dormant_manifolds];
        let mut pairs = Merged(both.map(|some| &some.pairs[..]));
        let first_plane = self.rows.entities.len() as u32;
        std::iter::from_fn(move || {
            let (at, pair) = pairs.next(|pair| pair_order(pair.bodies, first_plane))?;
            let [a, b] = pair.bodies.map(|i| self.collider_or_plane(i));
            Some((a, b, both[at].points_of(pair)))
        })
    }

    /// The collider or plane with this number in manifolds.
    pub(crate) fn collider_or_plane(&self, number: u32) -> Entity {
        let (colliders, i) = (self.rows.entities.len(), number as usize);
        if i < colliders {
            self.rows.entities[i]
        } else {
            self.planes[i - colliders]
        }
    }
}

/// The collisions that [`Collisions::iter`] has not passed yet.
struct Iter<'a> {
    collisions: &'a Collisions,
    pairs: Merged<'a, PairContact>,
    planes: Merged<'a, PlaneContact>,
}

impl<'a> Iterator for Iter<'a> {
    type Item = Collision<'a>;

    fn next(&mut self) -> Option<Self::Item> {
        let own = self.collisions;
        let key = |i: u32| own.rows.entities.keyed(i as usize);
        if let Some((at, pair)) = self.pairs.next(|pair| pair.bodies.map(key)) {
            return Some(own.collision(own.both()[at], pair));
        }
        let (at, plane) = self.planes.next(|contact| (key(contact.body), contact.plane))?;
        Some(own.on_plane(own.both()[at], plane))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.pairs.len() + self.planes.len();
        (left, Some(left))
    }
}

impl ExactSizeIterator for Iter<'_> {}

/// What is left of two ascending lists.
struct Merged<'a, T>([&'a [T]; 2]);

impl<'a, T> Merged<'a, T> {
    fn len(&self) -> usize {
        self.0.iter().map(|list| list.len()).sum()
    }

    /// The next element in the order of `key`, and in which list it is.
    fn next<K: Ord>(&mut self, key: impl Fn(&T) -> K) -> Option<(usize, &'a T)> {
        let at = match self.0.map(|list| list.first()) {
            [Some(a), Some(b)] => usize::from(key(a) > key(b)),
            [a, _] => usize::from(a.is_none()),
        };
        let (next, rest) = self.0[at].split_first()?;
        self.0[at] = rest;
        Some((at, next))
    }
}

/// Times and counts of the last published step.
#[derive(Resource, Reflect, Clone, Default)]
#[reflect(Resource, Default, Debug)]
pub struct StepReport {
    /// Number of steps since the app started.
    pub step: u64,
    /// Number of bodies in the step.
    pub bodies: usize,
    /// Number of colliders whose components the step has read: all, or, if changes are known, only colliders of bodies
    /// that are neither static nor [dormant](Self::dormant), and changed static ones.
    pub colliders_read: usize,
    /// Time of each stage, in the order of [`Stage::ALL`]: wall time on the CPU, the GPU's own time on a GPU. Zero on a
    /// GPU without timestamp queries.
    pub stages: [Duration; Stage::COUNT],
    /// Wall time of the whole step, including reading components and writing results.
    pub total: Duration,
    /// Number of pairs of colliders whose bounding spheres, enlarged by the speculative margin, overlap. Planes do not
    /// count.
    pub sphere_pairs: usize,
    /// Number of pairs for which an approximate [`Culling`](crate::types::settings::Culling) left out triangles. If it
    /// is 0, the step was exact.
    pub approximate_pairs: usize,
    /// Number of meshes tested exactly while their face table bakes; see
    /// [`FacesOfCollision`](crate::types::settings::Culling::FacesOfCollision).
    pub tables_in_bake: usize,
    /// Number of touching pairs of colliders. Planes do not count; [`Collisions::len`] counts them too.
    ///
    /// With [`Readback::Resident`](crate::plugin::settings::Readback::Resident) and
    /// [`Response::Contacts`](crate::types::settings::Response::Contacts) it counts pairs that push each other: nobody
    /// reads which faces intersect, so faces are not tested, and [`triangle_tests`](Self::triangle_tests) and
    /// [`face_pairs`](Self::face_pairs) are 0.
    pub touching_pairs: usize,
    /// Number of contact points within the margin of [`Collisions::manifolds`], between colliders and between colliders
    /// and planes.
    pub contact_points: usize,
    /// Number of collision substeps, the largest of any body; see
    /// [`SolverSettings`](crate::types::solver_settings::SolverSettings).
    pub collision_substeps: u32,
    /// The mean number of collision substeps of the bodies that move.
    pub mean_collision_substeps: f32,
    /// Number of bodies asleep.
    pub sleeping: usize,
    /// Number of sleeping bodies for which the step did nothing, because nothing awake is near. They are not read, but
    /// their contacts and pairs are counted.
    pub dormant: usize,
    /// Number of pairs of triangles that were tested because their bounding boxes overlap.
    pub triangle_tests: u64,
    /// Number of intersecting face pairs.
    pub face_pairs: usize,
    /// Number of stages that ran on the thread pool. On the CPU a small stage runs on the thread of the schedule and
    /// wakes no other. 0 on a GPU.
    pub parallel_stages: u32,
    /// Number of steps on the GPU whose results are not published yet; see
    /// [`Readback`](crate::plugin::settings::Readback).
    pub in_flight: usize,
    /// How many times a step has waited for the GPU since the device was opened: for the results of an earlier step, or
    /// in each collision substep and at the end for what
    /// [`ContinuousCollision`](crate::plugin::components::ContinuousCollision) needs.
    pub waits: u64,
    /// Number of bodies that lost pairs, because they overlap so many others that the step would have exceeded its
    /// [`StepLimits`](crate::types::limits::StepLimits). If it is not 0, the step was not exact.
    pub crowded_bodies: usize,
    /// What the step asked of the GPU: commands, bytes and memory. `None` if it ran on the CPU.
    pub gpu: Option<GpuWork>,
    /// Kinetic and potential energy of the dynamic bodies after the step. If it grows without the work of forces,
    /// impulses or kinematic bodies, and nobody wrote velocities, poses or [`Gravity`](crate::plugin::settings::Gravity),
    /// the solver has made energy.
    ///
    /// `None` unless [`MeasureEnergy`](crate::plugin::settings::MeasureEnergy) asks for it, and where results of a GPU
    /// come later than in the step that finds them.
    pub energy: Option<Energy>,
}

impl StepReport {
    /// Time of one stage; see [`StepReport::stages`].
    pub fn time(&self, stage: Stage) -> Duration {
        self.stages[stage as usize]
    }
}

impl fmt::Debug for StepReport {
    /// Like the derived implementation, but with the names of the stages.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // Without `..`, so that the compiler reports a new field that is missing here.
        let Self {
            step,
            bodies,
            colliders_read,
            stages: _,
            total,
            sphere_pairs,
            approximate_pairs,
            tables_in_bake,
            touching_pairs,
            contact_points,
            collision_substeps,
            mean_collision_substeps,
            sleeping,
            dormant,
            triangle_tests,
            face_pairs,
            parallel_stages,
            in_flight,
            waits,
            crowded_bodies,
            gpu,
            energy,
        } = self;
        let stages = fmt::from_fn(|f| {
            let times = Stage::ALL.map(|stage| (stage, self.time(stage)));
            f.debug_map().entries(times).finish()
        });
        f.debug_struct("StepReport")
            .field("step", step)
            .field("bodies", bodies)
            .field("colliders_read", colliders_read)
            .field("stages", &stages)
            .field("total", total)
            .field("sphere_pairs", sphere_pairs)
            .field("approximate_pairs", approximate_pairs)
            .field("tables_in_bake", tables_in_bake)
            .field("touching_pairs", touching_pairs)
            .field("contact_points", contact_points)
            .field("collision_substeps", collision_substeps)
            .field("mean_collision_substeps", mean_collision_substeps)
            .field("sleeping", sleeping)
            .field("dormant", dormant)
            .field("triangle_tests", triangle_tests)
            .field("face_pairs", face_pairs)
            .field("parallel_stages", parallel_stages)
            .field("in_flight", in_flight)
            .field("waits", waits)
            .field("crowded_bodies", crowded_bodies)
            .field("gpu", gpu)
            .field("energy", energy)
            .finish()
    }
}
