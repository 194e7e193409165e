//! Contact generation within a step: new manifolds of active pairs, reused ones of inactive pairs.

use super::MarginPair;
use super::cpu::{self, PairMotion, PairRequest, Rest, Reuse, planes};
use crate::state::inactive::InactiveBodies;
use crate::state::manifolds::pair_order;
use crate::state::margins::{SAFETY, SpeculativeMargins, surface_speed};
use crate::state::mesh_arena::MeshArena;
use crate::state::travel::Travel;
use crate::state::{Bodies, Manifolds, NearPair, Plane, StepConfig};
use crate::types::settings::Response;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    pairs: Vec<PairRequest>,
    /// Number of steps so far.
    step: u64,
    found: Manifolds,
    /// Manifolds of the last collision substep.
    before: Manifolds,
    meshes: cpu::Scratch,
    dropped: Vec<[u32; 2]>,
    planes: planes::Scratch,
}

impl Scratch {
    /// Whether any pair of the last call of [`find`] is so large that it is worth more than one thread.
    pub fn has_large_pair(&self) -> bool {
        self.meshes.has_large_pair()
    }

    /// Whether the last contact generation shows that a pair's faces do not intersect now, and that neither body
    /// contains the other.
    pub fn is_apart(&self, bodies: &Bodies, meshes: &MeshArena, pair: [u32; 2]) -> bool {
        self.meshes.is_apart(bodies, meshes, pair)
    }

    /// Number of searches for contact features in the last call of [`find`].
    pub fn searches(&self) -> usize {
        self.meshes.searches()
    }

    /// The pairs whose speculative points the last call of [`find`] dropped because the bodies fly past each other
    /// there.
    pub fn dropped(&self) -> &[[u32; 2]] {
        &self.dropped
    }

    /// Returns memory, except the last manifolds and what pairs keep.
    pub fn renew(&mut self) {
        (self.pairs, self.found, self.planes) = Default::default();
        self.before.shrink();
        self.meshes.renew();
    }
}

/// Writes the manifolds of all active pairs that respond to contacts into `manifolds`, in collision substep `number`,
/// and those of `wanted` pairs with planes. `intersects` tells which pairs had intersecting faces at the start of the
/// step. The previous manifolds are kept for [`reuse`].
pub(crate) fn find(
    number: u32,
    config: &StepConfig,
    bodies: &Bodies,
    meshes: &MeshArena,
    planes: &[Plane],
    near_pairs: &[NearPair],
    inactive: &InactiveBodies,
    wanted: impl Fn([u32; 2]) -> bool + Sync,
    intersects: impl Fn([u32; 2]) -> bool,
    scratch: &mut Scratch,
    manifolds: &mut Manifolds,
) {
    let is_awake = |pair| !inactive.is_inactive(pair);
    scratch.pairs.clear();
    scratch.step += u64::from(number == 0);
    for pair in near_pairs {
        if bodies.push_each_other(pair.bodies) && is_awake(pair.bodies) {
            let intersects = intersects(pair.bodies);
            let request = request_of(scratch.step, config, bodies, pair, intersects);
            scratch.pairs.push(request);
        }
    }
    std::mem::swap(manifolds, &mut scratch.before);
    if !inactive.has_same_numbers() {
        scratch.meshes.renumber(|pair| inactive.renumbered(pair));
    }
    // Pairs that have completed their step go on in the next one.
    let has_completed = |i: u32| bodies.travel_time_of(i as usize) == 0.0;
    let waits = |pair: [u32; 2]| pair.into_iter().all(has_completed);
    cpu::run_some(
        bodies,
        meshes,
        &scratch.pairs,
        waits,
        &mut scratch.meshes,
        manifolds,
        &mut scratch.dropped,
    );
    let wanted = |pair| is_awake(pair) && wanted(pair);
    planes::find(bodies, meshes, planes, config, wanted, &mut scratch.planes, manifolds);
}

/// How far the surfaces of a pair that overlaps deeply may move with the same points, in units of
/// [`SolverSettings::collision_substep_travel`](crate::types::solver_settings::SolverSettings::collision_substep_travel).
const DEEP_TRAVEL: f32 = 2.0;

/// How to find the points of a near pair in the step with this number. An overlapping pair that is slow for its group
/// keeps its points until its surfaces have moved too far.
fn request_of(step: u64, config: &StepConfig, bodies: &Bodies, near: &NearPair, intersects: bool) -> PairRequest {
    let &NearPair {
        bodies: pair, margin, ..
    } = near;
    let [a, b] = pair.map(|i| i as usize);
    let count = config.dt / bodies.travel_time[a].max(bodies.travel_time[b]);
    let at_rest = SpeculativeMargins::of_resting_pair(bodies, config, pair);
    // In each collision substep surfaces move by less than this, and by about the part without the safety factor.
    let travel = margin - at_rest;
    let most = DEEP_TRAVEL * config.solver.collision_substep_travel * bodies.thickness[a].min(bodies.thickness[b]);
    let lasts = intersects && count.is_finite() && count > 1.5 && travel * (1.0 + 1.0 / SAFETY) < most;
    PairRequest {
        pair: MarginPair { bodies: pair, margin },
        reuse: lasts.then_some(Reuse {
            step,
            travel: most - travel,
            depth: at_rest,
        }),
        motion: (config.response == Response::Contacts).then(|| motion_of(config, bodies, pair)),
        rest: (config.response == Response::Contacts).then(|| Rest {
            margin: at_rest,
            travel: surface_speed(bodies, pair) * config.dt,
        }),
    }
}

/// How a pair moves until the next collision substep.
fn motion_of(config: &StepConfig, bodies: &Bodies, pair: [u32; 2]) -> PairMotion {
    let [a, b] = pair.map(|i| Travel::of(bodies, config, i as usize));
    let smaller = pair
        .map(|i| bodies.radius[i as usize])
        .into_iter()
        .fold(f32::INFINITY, f32::min);
    PairMotion {
        travel: b.linear - a.linear,
        fall: b.fall - a.fall,
        turns: [a.turn, b.turn],
        rest_offset: f64::from(config.solver.rest_offset * 2.0 * smaller),
    }
}

/// Adds the manifolds that inactive pairs had in the last collision substep. Plane `i` has the number `first_plane +
/// i`.
pub(crate) fn reuse(inactive: &InactiveBodies, first_plane: u32, scratch: &mut Scratch, manifolds: &mut Manifolds) {
    if !inactive.any {
        return;
    }
    std::mem::swap(manifolds, &mut scratch.found);
    let renumbered = |pair| inactive.renumbered(pair).filter(|&pair| inactive.is_inactive(pair));
    join(&scratch.before, renumbered, &scratch.found, first_plane, manifolds);
}

/// Merges into `all`, in order, the manifolds of `before` whose pairs still exist, with their new indices, and those of
/// `found`. Manifolds with planes come last.
fn join(
    before: &Manifolds,
    renumbered: impl Fn([u32; 2]) -> Option<[u32; 2]>,
    found: &Manifolds,
    first_plane: u32,
    all: &mut Manifolds,
) {
    all.clear();
    let kept = before.pairs.iter();
    let mut kept = kept
        .filter_map(|pair| Some((renumbered(pair.bodies)?, before.points_of(pair))))
        .peekable();
    let surfaces = &found.surfaces;
    let mut found = found
        .pairs
        .iter()
        .map(|pair| (pair.bodies, found.points_of(pair)))
        .peekable();
    let order = |bodies| pair_order(bodies, first_plane);
    loop {
        let kept_first = match (kept.peek(), found.peek()) {
            (Some((kept, _)), Some((found, _))) => order(*kept) < order(*found),
            (kept, _) => kept.is_some(),
        };
        let next = if kept_first { kept.next() } else { found.next() };
        let Some((bodies, points)) = next else { break };
        let first = all.points.len();
        all.points.extend_from_slice(points);
        all.end_pair(bodies, first);
    }
    let kept = before.surfaces.iter();
    all.surfaces
        .extend(kept.filter_map(|&(pair, surface)| Some((renumbered(pair)?, surface))));
    all.surfaces.extend_from_slice(surfaces);
    all.surfaces.sort_unstable_by_key(|&(pair, _)| pair);
}
