//! TriangleTest on the CPU: pairs in parallel, each task writing lists of its own that are joined in order.

mod choice;
pub(super) mod contact;
pub(crate) mod containment;
mod cull;
pub(super) mod decide;
mod first;
pub(crate) mod placed;
mod planes;
mod product;
mod setting;

use crate::parallel::per_thread::PerThread;
use crate::state::manifolds::nearest;
use crate::state::mesh_arena::MeshArena;
use crate::state::still::StillBodies;
use crate::state::{Bodies, Contacts, FacePair, Manifolds, NearPair, PairContact, Plane};
use rayon::prelude::*;
use setting::Setting;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    /// A set of lists per task.
    tasks: Vec<Task>,
    workers: PerThread<Worker>,
    planes: planes::Scratch,
    /// Pairs that sleep and overlap, ascending.
    overlapping: Vec<[u32; 2]>,
}

#[derive(Default)]
struct Task {
    found: Contacts,
    touching: Vec<[u32; 2]>,
}

#[derive(Default)]
struct Worker {
    product: product::Scratch,
    search: first::Search,
    masks: [Vec<u8>; 2],
}

impl Scratch {
    /// A task for every few of so many pairs, and a worker for every thread.
    fn ready(&mut self, pairs: usize) -> (&mut [Task], &PerThread<Worker>) {
        let wanted = pairs.div_ceil(TASK);
        if self.tasks.len() < wanted {
            self.tasks.resize_with(wanted, Task::default);
        }
        (&mut self.tasks[..wanted], self.workers.ready())
    }
}

/// Pairs per task: small enough to balance, large enough to keep the scratch warm.
const TASK: usize = 16;

/// Writes into `contacts` which of `near_pairs` touch, with their intersecting faces, and which bodies reach into `planes`.
/// `manifolds` are those of the last interval: pairs that are still touch as they did then.
pub(crate) fn run(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    near_pairs: &[NearPair],
    manifolds: &Manifolds,
    still: &StillBodies,
    scratch: &mut Scratch,
    contacts: &mut Contacts,
) {
    let mut overlapping = std::mem::take(&mut scratch.overlapping);
    find_overlapping(manifolds, still, &mut overlapping);
    // What pushes and sleeps has the points it had, and these tell that it touches. Its surfaces do not meet if they say so.
    let is_known = |pair: [u32; 2]| {
        still.is_still(pair) && bodies.push_each_other(pair) && overlapping.binary_search(&pair).is_err()
    };
    let (tasks, workers) = scratch.ready(near_pairs.len());
    tasks
        .par_iter_mut()
        .zip(near_pairs.par_chunks(TASK))
        .for_each(|(task, pairs)| {
            task.found.clear();
            let mut worker = workers.lock();
            for pair in pairs.iter().filter(|pair| !is_known(pair.bodies)) {
                test_pair(bodies, meshes, pair, &mut worker, &mut task.found);
            }
        });

    contacts.clear();
    for Task { found, .. } in tasks.iter() {
        let base = contacts.faces.len() as u32;
        contacts.faces.extend_from_slice(&found.faces);
        contacts.pairs.extend(found.pairs.iter().map(|pair| PairContact {
            first_face: base + pair.first_face,
            ..*pair
        }));
        contacts.triangle_tests += found.triangle_tests;
    }
    scratch.overlapping = overlapping;
    planes::find(bodies, meshes, planes, &mut scratch.planes, &mut contacts.planes);
}

/// Finds the pairs that sleep and whose surfaces cross, by the points they have from the last interval.
fn find_overlapping(manifolds: &Manifolds, still: &StillBodies, overlapping: &mut Vec<[u32; 2]>) {
    overlapping.clear();
    if !still.has_sleepers {
        return;
    }
    let crossing = manifolds.pairs.iter().filter(|pair| {
        let nearest = nearest(manifolds.points_of(pair));
        nearest.is_some_and(|point| point.separation <= 0.0)
    });
    let now = crossing.filter_map(|pair| still.renumbered(pair.bodies));
    overlapping.extend(now.filter(|&pair| still.is_still(pair)));
    overlapping.sort_unstable();
}

/// Which of `near_pairs` touch, as [`run`] would find them, but without faces and contacts: each pair's test ends at the first
/// hit.
pub(crate) fn touching(
    bodies: &Bodies,
    meshes: &MeshArena,
    near_pairs: &[NearPair],
    scratch: &mut Scratch,
) -> Vec<[u32; 2]> {
    let (tasks, workers) = scratch.ready(near_pairs.len());
    tasks
        .par_iter_mut()
        .zip(near_pairs.par_chunks(TASK))
        .for_each(|(task, pairs)| {
            task.touching.clear();
            let mut worker = workers.lock();
            let touching = pairs.iter().filter(|pair| touch(bodies, meshes, pair, &mut worker));
            task.touching.extend(touching.map(|pair| pair.bodies));
        });
    tasks.iter().flat_map(|task| &task.touching).copied().collect()
}

fn touch(bodies: &Bodies, meshes: &MeshArena, pair: &NearPair, worker: &mut Worker) -> bool {
    let [a, b] = pair.bodies.map(|i| i as usize);
    let [mesh_a, mesh_b] = [a, b].map(|i| &meshes[bodies.mesh[i]].mesh.mesh);
    let size = bodies.radius[a] + bodies.radius[b];
    let view = contact::PairView::new(&bodies.frame[a], &bodies.frame[b], size);
    let setting = Setting::new(bodies, meshes, pair, &view, &mut worker.masks);
    let intersect = |&[ta, tb]: &[u32; 2]| {
        view.intersect(mesh_a.corners(ta as usize), mesh_b.corners(tb as usize))
            .is_some()
    };
    worker.search.any(&setting, intersect) || containment::either_inside(bodies, meshes, pair)
}

fn test_pair(bodies: &Bodies, meshes: &MeshArena, pair: &NearPair, worker: &mut Worker, found: &mut Contacts) {
    if pair.is_apart() {
        return;
    }
    let Worker { product, masks, .. } = worker;
    let [a, b] = pair.bodies.map(|i| i as usize);
    let size = bodies.radius[a] + bodies.radius[b];
    let view = contact::PairView::new(&bodies.frame[a], &bodies.frame[b], size);
    let setting = Setting::new(bodies, meshes, pair, &view, masks);
    found.triangle_tests += product.find(&setting);

    let [mesh_a, mesh_b] = [a, b].map(|i| &meshes[bodies.mesh[i]].mesh);
    let first_face = found.faces.len() as u32;
    let mut contour = contact::Contour::default();
    product.decide(&setting.placing, |decided| {
        let [ta, tb] = decided.triangles;
        let hit = match decided.segment {
            Some([start, end]) => Some(contact::Segment::across(start, end)),
            None => view.intersect(mesh_a.mesh.corners(ta as usize), mesh_b.mesh.corners(tb as usize)),
        };
        if let Some(segment) = hit {
            contour.add(&segment);
            found.faces.push(FacePair {
                a: mesh_a.mesh.face_ids()[ta as usize],
                b: mesh_b.mesh.face_ids()[tb as usize],
                start: view.to_world(segment.start),
                end: view.to_world(segment.end),
            });
        }
    });
    let face_count = found.faces.len() as u32 - first_face;
    let contained = face_count == 0 && containment::either_inside(bodies, meshes, pair);
    if face_count > 0 || contained {
        found.pairs.push(PairContact {
            bodies: pair.bodies,
            contained,
            first_face,
            face_count,
            contact: contact::contact(bodies, meshes, pair, &contour, &view),
            first_point: 0,
            point_count: 0,
            impulse: 0.0,
            passing: false,
        });
    }
}
