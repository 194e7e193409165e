//! Who touched whom in a step, from what the solver did in each of its intervals, and from who passed sensors.

use super::settings::SolverSettings;
use super::{Solver, SolverBodies};
use crate::stages::manifolds::{ManifoldPoint, Manifolds, nearest, place};
use crate::stages::state::{Bodies, Contact, Contacts, PlaneContact, TouchingPair};

/// The pairs that touched so far in a step: that pushed each other, lay nearer than bodies at rest do, or passed each other.
#[derive(Default)]
pub(crate) struct Touches {
    all: Vec<Touch>,
    /// Memory for merging.
    pairs: Vec<TouchingPair>,
    planes: Vec<PlaneContact>,
}

#[derive(Clone, Copy)]
struct Touch {
    bodies: [u32; 2],
    /// The nearest point.
    contact: Contact,
    separation: f32,
    /// Newton seconds.
    impulse: f32,
    /// See [`TouchingPair::passing`].
    passing: bool,
}

impl Touches {
    /// Forgets all, at the beginning of a step.
    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// Adds those of an interval, which began with `bodies` where they are, and which `solver` has solved.
    pub fn note(
        &mut self,
        bodies: &Bodies,
        moved: &SolverBodies,
        manifolds: &Manifolds,
        settings: &SolverSettings,
        solver: &Solver,
    ) {
        for pair in &manifolds.pairs {
            let first = pair.first_point as usize;
            let points = first..first + pair.point_count as usize;
            let impulse = points.clone().map(|point| solver.impulse_of(point)).sum();
            let Some(nearest) = nearest(manifolds.points_of(pair)) else {
                continue;
            };
            let [a, b] = pair.bodies.map(|i| i as usize);
            let diameter = 2.0 * moved.bodies[a].radius.min(moved.bodies[b].radius);
            let near = nearest.separation <= settings.rest_offset * diameter;
            if near || points.clone().any(|point| solver.pushes(point)) {
                self.all.push(Touch {
                    bodies: pair.bodies,
                    contact: contact(bodies, a, nearest),
                    separation: nearest.separation,
                    impulse,
                    passing: false,
                });
            }
        }
    }

    /// Adds a pair of which one is a sensor, and where it touched on its way.
    pub fn pass(&mut self, bodies: [u32; 2], contact: Contact) {
        self.all.push(Touch {
            bodies,
            contact,
            separation: 0.0,
            impulse: 0.0,
            passing: true,
        });
    }

    /// Those that a device found, in any order.
    #[cfg(feature = "gpu")]
    pub fn from_device(mut found: Vec<crate::gpu::layout::Touch>) -> Self {
        found.sort_unstable_by_key(|touch| (touch.interval, touch.a, touch.b));
        let touch = |touch: &crate::gpu::layout::Touch| Touch {
            bodies: [touch.a, touch.b],
            contact: Contact {
                point: touch.point.into(),
                normal: touch.normal.into(),
            },
            separation: touch.separation,
            impulse: touch.impulse,
            passing: false,
        };
        Self {
            all: found.iter().map(touch).collect(),
            ..Self::default()
        }
    }

    /// Adds to what the triangle test found in the step what it did not, and how strongly all pushed. Planes are the bodies
    /// from `planes_from` on.
    pub fn tell(&mut self, planes_from: u32, contacts: &mut Contacts) {
        let Self { all, pairs, planes } = self;
        // Stable: each pair's stay in the order of intervals.
        all.sort_by_key(|touch| place(touch.bodies, planes_from));
        let meshes_end = all.partition_point(|touch| touch.bodies[1] < planes_from);

        pairs.clear();
        let mut found = contacts.pairs.iter().peekable();
        for run in all[..meshes_end].chunk_by(|s, t| s.bodies == t.bodies) {
            while let Some(&pair) = found.next_if(|pair| pair.bodies < run[0].bodies) {
                pairs.push(pair);
            }
            let same = found.next_if(|pair| pair.bodies == run[0].bodies);
            pairs.push(TouchingPair {
                impulse: run.iter().map(|touch| touch.impulse).sum(),
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
            let here = [body, number - planes_from];
            while let Some(&contact) = found.next_if(|contact| place(contact) < here) {
                planes.push(contact);
            }
            let same = found.next_if(|contact| place(contact) == here);
            let deepest = deepest(run);
            planes.push(same.copied().unwrap_or(PlaneContact {
                body,
                plane: here[1],
                point: deepest.contact.point,
                depth: -deepest.separation,
            }));
        }
        planes.extend(found);
        std::mem::swap(planes, &mut contacts.planes);
    }
}

/// The nearest of a pair's points, of the first interval if there are several.
fn deepest(run: &[Touch]) -> Touch {
    *run.iter()
        .min_by(|s, t| s.separation.total_cmp(&t.separation))
        .unwrap_or(&run[0])
}

/// Halfway between both surfaces.
fn contact(bodies: &Bodies, a: usize, point: &ManifoldPoint) -> Contact {
    let on_a = bodies.frame[a].center.as_vec3() + point.arms[0];
    Contact {
        point: on_a + point.normal * (0.5 * point.separation),
        normal: point.normal,
    }
}

impl From<Touch> for TouchingPair {
    fn from(touch: Touch) -> Self {
        Self {
            bodies: touch.bodies,
            contained: false,
            first_face: 0,
            face_count: 0,
            contact: touch.contact,
            impulse: 0.0,
            passing: touch.passing,
        }
    }
}
