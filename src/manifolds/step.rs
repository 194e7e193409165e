//! Contact generation as a stage of a step.

use super::cpu::{self, planes};
use super::{Manifolds, MarginPair, place};
use crate::state::{Bodies, NearPair, StepState};
use crate::step::touches::show_points;
use crate::types::settings::Response;

/// Memory kept between steps.
#[derive(Default)]
pub(crate) struct Scratch {
    pairs: Vec<MarginPair>,
    found: Manifolds,
    before: Manifolds,
    meshes: cpu::Scratch,
    planes: planes::Scratch,
}

/// Fills `state.manifolds` with those of all pairs that push each other. Pairs that sleep keep what they had.
pub fn run(state: &mut StepState) {
    let StepState {
        config,
        meshes,
        bodies,
        planes,
        near_pairs,
        manifolds,
        contacts,
        dynamics,
        manifold_scratch: scratch,
        ..
    } = state;
    if config.response == Response::Impulse {
        manifolds.clear();
        return;
    }
    let is_awake = |pair| !dynamics.is_still(pair);
    scratch.pairs.clear();
    for &NearPair {
        bodies: pair, margin, ..
    } in near_pairs.iter()
    {
        if push_each_other(bodies, pair) && is_awake(pair) {
            scratch.pairs.push(MarginPair { bodies: pair, margin });
        }
    }
    let found = &mut scratch.found;
    cpu::run(bodies, meshes, &scratch.pairs, &mut scratch.meshes, found);
    let interval = dynamics.interval(config);
    planes::find(bodies, meshes, planes, &interval, is_awake, &mut scratch.planes, found);
    if dynamics.has_still() {
        std::mem::swap(manifolds, &mut scratch.before);
        let renumbered = |pair| dynamics.renumbered(pair).filter(|&pair| dynamics.is_still(pair));
        join(&scratch.before, renumbered, found, bodies.len() as u32, manifolds);
    } else {
        std::mem::swap(manifolds, found);
    }
    if config.response == Response::None {
        show_points(manifolds, bodies.len() as u32, contacts, |i| bodies.center[i as usize]);
    }
}

/// Whether contacts between two bodies move one of them.
pub(crate) fn push_each_other(bodies: &Bodies, [a, b]: [u32; 2]) -> bool {
    let (a, b) = (a as usize, b as usize);
    (bodies.inverse_mass[a] > 0.0 || bodies.inverse_mass[b] > 0.0) && !bodies.sensor[a] && !bodies.sensor[b]
}

/// Writes the manifolds of `before` whose pairs have numbers now, and those of `found`, into `all`, in order: by bodies, and
/// after them those with planes, which are numbered after the bodies.
fn join(
    before: &Manifolds,
    renumbered: impl Fn([u32; 2]) -> Option<[u32; 2]>,
    found: &Manifolds,
    planes_from: u32,
    all: &mut Manifolds,
) {
    all.clear();
    let kept = before.pairs.iter();
    let mut kept = kept
        .filter_map(|pair| Some((renumbered(pair.bodies)?, before.points_of(pair))))
        .peekable();
    let mut found = found
        .pairs
        .iter()
        .map(|pair| (pair.bodies, found.points_of(pair)))
        .peekable();
    let place = |bodies| place(bodies, planes_from);
    loop {
        let kept_first = match (kept.peek(), found.peek()) {
            (Some((kept, _)), Some((found, _))) => place(*kept) < place(*found),
            (kept, _) => kept.is_some(),
        };
        let next = if kept_first { kept.next() } else { found.next() };
        let Some((bodies, points)) = next else { return };
        let first = all.points.len();
        all.points.extend_from_slice(points);
        all.close(bodies, first);
    }
}
