//! The first contact of pairs that contact generation found to fly past each other.
//!
//! Such a pair had speculative points on planes that it crosses beyond the surface, and they were dropped. It may meet
//! elsewhere: at an edge or a corner without a point. If it does within the collision substep, its manifold gets the
//! point at which the surfaces touch first, with the normal of that moment.

use super::search::{Outcome, Scratch};
use super::time_of_impact::search;
use super::{Pose, Sweep};
use crate::parallel::loops;
use crate::parallel::per_thread::PerThread;
use crate::state::mesh_arena::MeshArena;
use crate::state::travel::Travel;
use crate::state::{Bodies, ManifoldPoint, Manifolds, StepConfig};
use glam::DVec3;
use rayon::prelude::*;

/// Memory kept between collision substeps.
#[derive(Default)]
pub(crate) struct FirstContacts {
    workers: PerThread<Scratch>,
    found: Vec<Option<ManifoldPoint>>,
    added: Vec<([u32; 2], ManifoldPoint)>,
    merged: Manifolds,
}

impl FirstContacts {
    /// Adds the points of first contact of these pairs, ascending, to `manifolds`.
    pub fn add(
        &mut self,
        config: &StepConfig,
        bodies: &Bodies,
        meshes: &MeshArena,
        pairs: &[[u32; 2]],
        manifolds: &mut Manifolds,
    ) {
        if pairs.is_empty() {
            return;
        }
        let Self {
            workers,
            found,
            added,
            merged,
        } = self;
        let workers = workers.ready();
        let first_contact = |&pair: &[u32; 2]| first_contact(config, bodies, meshes, pair, &mut workers.lock());
        loops::collect(pairs.par_iter().map(first_contact), 1, found);
        added.clear();
        let both = pairs.iter().zip(&*found);
        added.extend(both.filter_map(|(&pair, point)| Some((pair, (*point)?))));
        if !added.is_empty() {
            manifolds.with_points(added, bodies.len() as u32, merged);
            std::mem::swap(manifolds, merged);
        }
    }
}

/// The point at which two colliders first touch within the collision substep, where it is at the start.
fn first_contact(
    config: &StepConfig,
    bodies: &Bodies,
    meshes: &MeshArena,
    pair: [u32; 2],
    scratch: &mut Scratch,
) -> Option<ManifoldPoint> {
    let sweeps = pair.map(|i| sweep(bodies, config, bodies.body_of(i) as usize));
    let search = search(bodies, meshes, pair, [&sweeps[0], &sweeps[1]], 0.0)?;
    let Outcome::Hit(hit) = search.run(scratch) else {
        return None;
    };
    let triangles = hit.triangles?;
    let [point, direction] = search.contact(&hit)?;
    let poses = sweeps.each_ref().map(|sweep| sweep.at(hit.time));
    let normal = direction
        .try_normalize()
        .or_else(|| (poses[1].center - poses[0].center).try_normalize())?;
    let anchors = [0, 1].map(|i| anchor(&sweeps[i].before, &poses[i], point));
    let offset = sweeps[1].before.center + anchors[1] - sweeps[0].before.center - anchors[0];
    Some(ManifoldPoint {
        anchors: anchors.map(|anchor| anchor.as_vec3()),
        normal: normal.as_vec3(),
        // A rotation may lead a point round to a place from which it does not approach along the normal.
        separation: offset.dot(normal).max(0.0) as f32,
        bulge: 0.0,
        curvature_radii: pair.map(|i| bodies.rounding[i as usize]),
        normal_rotation: 0.0,
        faces: [0, 1].map(|i| {
            let mesh = &meshes[bodies.mesh[pair[i] as usize]].mesh.mesh;
            mesh.face_ids()[triangles[i] as usize]
        }),
    })
}

/// From the centre of mass to the point of a body that is at `point` later.
fn anchor(before: &Pose, later: &Pose, point: DVec3) -> DVec3 {
    before.rotation * (later.rotation.inverse() * (point - later.center))
}

/// How a body moves in the collision substep if nothing stops it.
fn sweep(bodies: &Bodies, config: &StepConfig, i: usize) -> Sweep {
    let travel = Travel::of_body(bodies, config, i);
    Sweep {
        before: Pose::of(bodies, i),
        travel: travel.linear,
        turn: travel.turn,
    }
}
