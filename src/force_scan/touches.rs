//! Which pairs touched in a step: in any of its collision substeps, or on the path of a body that passes a sensor.

use crate::solver::{Solver, SolverBodies};
use crate::state::manifolds::{nearest, pair_order};
use crate::state::{Bodies, Contact, ContactPoint, Contacts, Manifolds, PairContact, PlaneContact};
use crate::types::solver_settings::SolverSettings;

/// The contact points of all pairs that have touched so far in a step. A pair touches if an impulse acts between its
/// bodies, if they are as near as bodies at rest, or if one is a sensor and they touch on their paths.
#[derive(Default)]
pub(crate) struct Touches {
    all: Vec<Touch>,
    /// Scratch memory for merging.
    pairs: Vec<PairContact>,
    planes: Vec<PlaneContact>,
}

/// One contact point of a pair in one collision substep.
#[derive(Clone, Copy)]
struct Touch {
    bodies: [u32; 2],
    point: ContactPoint,
    /// See [`PairContact::passing`].
    passing: bool,
}

impl Touches {
    /// Removes all touches, at the beginning of a step.
    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// Records the touching pairs of a collision substep that `solver` has just solved. `bodies` have the poses from
    /// its start, `solver_bodies` those from its end.
    pub fn record(
        &mut self,
        bodies: &Bodies,
        solver_bodies: &SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        solver: &Solver,
    ) {
        for pair in &manifolds.pairs {
            let first = pair.first_point as usize;
            let points = manifolds.points_of(pair);
            let Some(nearest) = nearest(points) else {
                continue;
            };
            let [a, b] = pair.bodies.map(|i| i as usize);
            if bodies.travel_time_of(a) == 0.0 && bodies.travel_time_of(b) == 0.0 {
                // The pair was recorded in the collision substeps of its bodies.
                continue;
            }
            let diameter = 2.0 * solver_bodies.bodies[a].radius.min(solver_bodies.bodies[b].radius);
            let near = nearest.gap() <= settings.rest_offset * diameter;
            if near || (first..first + points.len()).any(|point| solver.pushes(point)) {
                let center = bodies.frame[a].body_center.as_vec3();
                self.all.extend(points.iter().enumerate().map(|(k, point)| Touch {
                    bodies: pair.bodies,
                    point: point.in_world(center, solver.impulse_of(first + k)),
                    passing: false,
                }));
            }
        }
    }

    /// Puts back the touches of bodies that slept in the first collision substep, as [`Touches::report`] has reported
    /// them.
    pub fn put_back(&mut self, contacts: &Contacts, first_plane: u32) {
        let pairs = contacts
            .pairs
            .iter()
            .map(|pair| (pair.bodies, contacts.points_of(pair)));
        let planes = contacts.planes.iter();
        let planes = planes.map(|plane| ([plane.body, first_plane + plane.plane], contacts.points_on(plane)));
        for (bodies, points) in pairs.chain(planes) {
            self.all.extend(points.iter().map(|&point| Touch {
                bodies,
                point,
                passing: false,
            }));
        }
    }

    /// Records a pair of a sensor and another body that touch on their paths.
    pub fn record_sensor(&mut self, bodies: [u32; 2], contact: Contact) {
        self.all.push(Touch {
            bodies,
            point: ContactPoint {
                point: contact.point,
                normal: contact.normal,
                separation: 0.0,
                impulse: 0.0,
            },
            passing: true,
        });
    }

    /// The touches that a device has found, in any order.
    #[cfg(feature = "gpu")]
    pub fn from_device(mut found: Vec<crate::gpu::layout::Touch>) -> Self {
        found.sort_unstable_by_key(|touch| (touch.collision_substep, touch.a, touch.b, touch.index));
        let touch = |touch: &crate::gpu::layout::Touch| Touch {
            bodies: [touch.a, touch.b],
            point: ContactPoint {
                point: touch.point.into(),
                normal: touch.normal.into(),
                separation: touch.separation,
                impulse: touch.impulse,
            },
            passing: false,
        };
        Self {
            all: found.iter().map(touch).collect(),
            ..Self::default()
        }
    }

    /// Adds the touching pairs that the triangle test did not find to `contacts`, and the contact points and impulses
    /// of all. Planes have the numbers from `first_plane` on.
    pub fn report(&mut self, first_plane: u32, contacts: &mut Contacts) {
        let Self { all, pairs, planes } = self;
        // A stable sort: the points of a pair stay in the order of collision substeps.
        all.sort_by_key(|touch| pair_order(touch.bodies, first_plane));
        let meshes_end = all.partition_point(|touch| touch.bodies[1] < first_plane);
        let points = &mut contacts.points;
        points.clear();

        pairs.clear();
        let mut found = contacts.pairs.iter().peekable();
        for run in all[..meshes_end].chunk_by(|s, t| s.bodies == t.bodies) {
            while let Some(&pair) = found.next_if(|pair| pair.bodies < run[0].bodies) {
                pairs.push(pair);
            }
            let same = found.next_if(|pair| pair.bodies == run[0].bodies);
            let (first_point, point_count, impulse) = add(run, points);
            pairs.push(PairContact {
                first_point,
                point_count,
                impulse,
                ..same.copied().unwrap_or_else(|| deepest(run).into())
            });
        }
        pairs.extend(found);
        std::mem::swap(pairs, &mut contacts.pairs);

        planes.clear();
        let mut found = contacts.planes.iter().peekable();
        let place = |contact: &PlaneContact| [contact.body, contact.plane];
        for run in all[meshes_end..].chunk_by(|s, t| s.bodies == t.bodies) {
            let [body, number] = run[0].bodies;
            let here = [body, number - first_plane];
            while let Some(&contact) = found.next_if(|contact| place(contact) < here) {
                planes.push(contact);
            }
            let same = found.next_if(|contact| place(contact) == here);
            let (first_point, point_count, impulse) = add(run, points);
            let deepest = deepest(run).point;
            let (point, depth) = same.map_or((deepest.point, -deepest.separation), |same| (same.point, same.depth));
            planes.push(PlaneContact {
                body,
                plane: here[1],
                point,
                normal: deepest.normal,
                depth,
                first_point,
                point_count,
                impulse,
            });
        }
        planes.extend(found);
        std::mem::swap(planes, &mut contacts.planes);
    }
}

/// Appends the points of a pair. Returns the number of the first one, their count and the sum of their impulses.
/// Touches with sensors have no points.
fn add(run: &[Touch], points: &mut Vec<ContactPoint>) -> (u32, u32, f32) {
    let first = points.len() as u32;
    points.extend(run.iter().filter(|touch| !touch.passing).map(|touch| touch.point));
    let impulse = run.iter().map(|touch| touch.point.impulse).sum();
    (first, points.len() as u32 - first, impulse)
}

/// The touch of a pair with the smallest separation; the earliest if there are several.
fn deepest(run: &[Touch]) -> Touch {
    *run.iter()
        .min_by(|s, t| s.point.separation.total_cmp(&t.point.separation))
        .unwrap_or(&run[0])
}

impl From<Touch> for PairContact {
    fn from(touch: Touch) -> Self {
        Self {
            bodies: touch.bodies,
            contained: false,
            first_face: 0,
            face_count: 0,
            contact: Contact {
                point: touch.point.point,
                normal: touch.point.normal,
            },
            first_point: 0,
            point_count: 0,
            impulse: 0.0,
            passing: touch.passing,
        }
    }
}
