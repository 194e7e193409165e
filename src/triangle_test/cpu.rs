//! TriangleTest on the CPU: pairs run in parallel; each task writes its own lists, which are joined in order.

mod any_hit;
mod candidates;
pub(super) mod contact;
pub(crate) mod containment;
mod cull;
pub(crate) mod interval_test;
mod lane_filter;
mod pair_setup;
pub(crate) mod placed;
mod planes;
mod rounded;

use crate::parallel::loops;
use crate::parallel::per_thread::PerThread;
use crate::simd::lanes::Simd;
use crate::simd::level::with_simd;
use crate::state::inactive::InactiveBodies;
use crate::state::manifolds::nearest;
use crate::state::mesh_arena::MeshArena;
use crate::state::{Bodies, Contact, Contacts, FacePair, Manifolds, NearPair, PairContact, PlacedMesh, Plane};
use pair_setup::PairSetup;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    /// Result lists, one set per task.
    tasks: Vec<Task>,
    workers: PerThread<Worker>,
    planes: planes::Scratch,
    /// Inactive pairs that overlap, ascending.
    overlapping: Vec<[u32; 2]>,
}

#[derive(Default)]
struct Task {
    found: Contacts,
    touching: Vec<[u32; 2]>,
}

/// Memory kept between pairs.
#[derive(Default)]
pub(crate) struct Worker {
    candidates: candidates::Scratch,
    search: any_hit::Search,
    masks: [Vec<u8>; 2],
}

impl Scratch {
    /// The tasks for this many pairs, and a worker for every thread.
    fn ready(&mut self, pairs: usize) -> (&mut [Task], &PerThread<Worker>) {
        let wanted = pairs.div_ceil(TASK);
        if self.tasks.len() < wanted {
            self.tasks.resize_with(wanted, Task::default);
        }
        (&mut self.tasks[..wanted], self.workers.ready())
    }
}

/// More intersecting faces than the step's limit.
#[derive(Debug)]
pub(crate) struct TooManyFaces;

/// Pairs per task: small enough to balance the load, large enough to keep the scratch memory in cache.
const TASK: usize = 16;

/// Writes into `contacts` which of `near_pairs` touch, with their intersecting faces, and which bodies penetrate
/// `planes`, if the pair is `wanted`. `manifolds` are those of the last collision substep, in which inactive pairs
/// touch as now. Pairs for which `is_apart` holds do not touch.
///
/// Returns the number of intersecting faces. If it exceeds the `limit`, the test ends early and leaves `contacts`
/// empty.
pub(crate) fn run(
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    near_pairs: &[NearPair],
    manifolds: &Manifolds,
    inactive: &InactiveBodies,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
    is_apart: impl Fn([u32; 2]) -> bool + Sync,
    limit: usize,
    scratch: &mut Scratch,
    contacts: &mut Contacts,
) -> Result<usize, TooManyFaces> {
    contacts.clear();
    let mut overlapping = std::mem::take(&mut scratch.overlapping);
    find_overlapping(manifolds, inactive, &mut overlapping);
    // Inactive solid pairs keep their contact points, and these tell whether they touch. If no point overlaps, no faces
    // intersect, and the test is skipped.
    let is_known = |pair: [u32; 2]| {
        let is_still = inactive.is_inactive(pair) && bodies.push_each_other(pair);
        is_still && overlapping.binary_search(&pair).is_err() || is_apart(pair)
    };
    let (tasks, workers) = scratch.ready(near_pairs.len());
    let parts = tasks.par_iter_mut().zip(near_pairs.par_chunks(TASK));
    let faces = AtomicUsize::new(0);
    loops::for_each(parts, 1, |(task, pairs)| {
        task.found.clear();
        let mut worker = workers.lock();
        for pair in pairs.iter().filter(|pair| !is_known(pair.bodies)) {
            if faces.load(Ordering::Relaxed) > limit {
                return;
            }
            let before = task.found.faces.len();
            with_simd!(simd => test_pair(simd, bodies, meshes, pair, &mut worker, &mut task.found));
            faces.fetch_add(task.found.faces.len() - before, Ordering::Relaxed);
        }
    });
    if faces.into_inner() > limit {
        scratch.overlapping = overlapping;
        return Err(TooManyFaces);
    }

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
    planes::find(
        bodies,
        meshes,
        planes,
        wanted,
        &mut scratch.planes,
        &mut contacts.planes,
    );
    Ok(contacts.faces.len())
}

/// The most pairs of faces that are listed of a rounded pair: a large ball may hold a whole level.
const MAX_ROUNDED_FACES: usize = 1 << 14;

/// Adds a pair whose cores are apart and whose rounded surfaces touch, with the contact where they are deepest. Its
/// faces are those whose roundings touch, up to [`MAX_ROUNDED_FACES`].
fn add_rounded(pair @ [a, b]: [&PlacedMesh; 2], near: &NearPair, found: &mut Contacts) {
    let first_face = found.faces.len() as u32;
    let mut deepest: Option<rounded::Touch> = None;
    rounded::touches(pair, |touch| {
        let Contact { point, .. } = touch.contact;
        let [ta, tb] = touch.triangles.map(|t| t as usize);
        let is_full = found.faces.len() - first_face as usize >= MAX_ROUNDED_FACES;
        if !is_full {
            found.faces.push(FacePair {
                a: a.mesh.mesh.face_ids()[ta],
                b: b.mesh.mesh.face_ids()[tb],
                start: point,
                end: point,
            });
        }
        let least = deepest.as_ref().map_or(f64::INFINITY, |other| other.distance);
        let distance = touch.distance;
        if distance < least {
            deepest = Some(touch);
        }
        // Then only deeper places are of interest.
        if is_full { least.min(distance) } else { f64::INFINITY }
    });
    found.pairs.extend(deepest.map(|touch| PairContact {
        bodies: near.bodies,
        contained: false,
        first_face,
        face_count: found.faces.len() as u32 - first_face,
        contact: touch.contact,
        first_point: 0,
        point_count: 0,
        impulse: 0.0,
        passing: false,
    }));
}

/// Finds the inactive pairs whose contact points of the last collision substep overlap.
fn find_overlapping(manifolds: &Manifolds, inactive: &InactiveBodies, overlapping: &mut Vec<[u32; 2]>) {
    overlapping.clear();
    if !inactive.any {
        return;
    }
    let crossing = manifolds.pairs.iter().filter(|pair| {
        let nearest = nearest(manifolds.points_of(pair));
        nearest.is_some_and(|point| point.separation <= 0.0)
    });
    let now = crossing.filter_map(|pair| inactive.renumbered(pair.bodies));
    overlapping.extend(now.filter(|&pair| inactive.is_inactive(pair)));
    overlapping.sort_unstable();
}

/// Which of `near_pairs` touch: the pairs of [`run`] without faces and contacts. Each pair's test stops at the first
/// intersection.
pub(crate) fn touching(
    bodies: &Bodies,
    meshes: &MeshArena,
    near_pairs: &[NearPair],
    scratch: &mut Scratch,
) -> Vec<[u32; 2]> {
    let (tasks, workers) = scratch.ready(near_pairs.len());
    let parts = tasks.par_iter_mut().zip(near_pairs.par_chunks(TASK));
    loops::for_each(parts, 1, |(task, pairs)| {
        task.touching.clear();
        let mut worker = workers.lock();
        let touching = pairs.iter().filter(|pair| {
            let [a, b] = pair.bodies.map(|i| PlacedMesh::of(bodies, meshes, i));
            touch_placed([&a, &b], pair, &mut worker)
        });
        task.touching.extend(touching.map(|pair| pair.bodies));
    });
    tasks.iter().flat_map(|task| &task.touching).copied().collect()
}

/// Whether two placed meshes touch. `near` has their relative pose.
pub(crate) fn touch_placed(meshes: [&PlacedMesh; 2], near: &NearPair, worker: &mut Worker) -> bool {
    with_simd!(simd => touch(simd, meshes, near, worker))
}

#[inline(always)]
fn touch<S: Simd>(simd: S, [a, b]: [&PlacedMesh; 2], near: &NearPair, worker: &mut Worker) -> bool {
    let pair_frame = contact::PairFrame::new(a.frame, b.frame, a.radius + b.radius);
    let setup = PairSetup::new(simd, [a, b], near, &pair_frame, &mut worker.masks);
    let intersect = |&[ta, tb]: &[u32; 2]| {
        let (a, b) = (a.mesh.mesh.corners(ta as usize), b.mesh.mesh.corners(tb as usize));
        pair_frame.intersect(a, b).is_some()
    };
    let mut any = worker.search.any(&setup, intersect) || containment::either_inside([a, b], near);
    if !any {
        rounded::touches([a, b], |_| {
            any = true;
            f64::NEG_INFINITY
        });
    }
    any
}

#[inline(always)]
fn test_pair<S: Simd>(
    simd: S,
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: &NearPair,
    worker: &mut Worker,
    found: &mut Contacts,
) {
    if pair.is_apart() {
        return;
    }
    let Worker { candidates, masks, .. } = worker;
    let [a, b] = pair.bodies.map(|i| PlacedMesh::of(bodies, meshes, i));
    let pair_frame = contact::PairFrame::new(a.frame, b.frame, a.radius + b.radius);
    let setup = PairSetup::new(simd, [&a, &b], pair, &pair_frame, masks);
    found.triangle_tests += candidates.find(&setup);

    let (mesh_a, mesh_b) = (a.mesh, b.mesh);
    let first_face = found.faces.len() as u32;
    let mut contour = contact::Contour::default();
    candidates.decide(simd, &setup.pair_scale, |decided| {
        let [ta, tb] = decided.triangles;
        let hit = match decided.segment {
            Some([start, end]) => Some(contact::Segment::across(start, end)),
            None => pair_frame.intersect(mesh_a.mesh.corners(ta as usize), mesh_b.mesh.corners(tb as usize)),
        };
        if let Some(segment) = hit {
            contour.add(&segment);
            found.faces.push(FacePair {
                a: mesh_a.mesh.face_ids()[ta as usize],
                b: mesh_b.mesh.face_ids()[tb as usize],
                start: pair_frame.to_world(segment.start),
                end: pair_frame.to_world(segment.end),
            });
        }
    });
    let face_count = found.faces.len() as u32 - first_face;
    let contained = face_count == 0 && containment::either_inside([&a, &b], pair);
    if face_count == 0 && !contained {
        add_rounded([&a, &b], pair, found);
    }
    if face_count > 0 || contained {
        found.pairs.push(PairContact {
            bodies: pair.bodies,
            contained,
            first_face,
            face_count,
            contact: contact::contact(bodies, meshes, pair, &contour, &pair_frame),
            first_point: 0,
            point_count: 0,
            impulse: 0.0,
            passing: false,
        });
    }
}
