//! Warns of bodies that stay deep in each other. Contacts push them apart, so something holds them there, or their
//! surfaces do not tell where outside is.

use super::{Step, named};
use crate::plugin::collisions::{Collisions, StepReport};
use crate::state::manifolds::nearest;
use crate::types::settings::Response;
use bevy::prelude::*;

/// Steps from one look to the next: a quarter of a second by default.
const STEPS: u64 = 16;
/// A pair is told when so many looks in a row have found it.
const LOOKS: u32 = 6;
/// An overlap is deep if it is more than this part of the diameter of the smaller collider.
const FRACTION: f32 = 0.05;
/// So many pairs are told. In a scene with more of them, these show what is wrong.
const MOST_TOLD: u32 = 8;

/// The pairs that the last look found, ascending, and how many looks in a row have.
#[derive(Default)]
pub(crate) struct DeepOverlaps {
    pairs: Vec<([Entity; 2], u32)>,
    /// Scratch: those of the look before.
    before: Vec<([Entity; 2], u32)>,
    told: u32,
    /// The number of the last look. Results that come late skip steps, and stay for several.
    last: u64,
}

/// Looks at the results of a step now and then. What never leaves a device is not seen.
pub(crate) fn warn_of_deep_overlaps(
    step: Res<Step>,
    collisions: Res<Collisions>,
    report: Res<StepReport>,
    names: Query<&Name>,
    mut known: Local<DeepOverlaps>,
) {
    let pushes = step.state.input.config.response == Response::Contacts;
    let number = report.step / STEPS;
    if !pushes || number == known.last || known.told == MOST_TOLD || !step.engine.runs() {
        return;
    }
    let known = &mut *known;
    known.last = number;
    std::mem::swap(&mut known.pairs, &mut known.before);
    known.pairs.clear();
    let name = |entity: Entity| named(entity, names.get(entity).ok());
    for (pair, depth) in deep_pairs(&step, &collisions) {
        let before = known.before.binary_search_by_key(&pair, |&(pair, _)| pair);
        let looks = before.map_or(0, |at| known.before[at].1) + 1;
        known.pairs.push((pair, looks));
        if looks == LOOKS && known.told < MOST_TOLD {
            known.told += 1;
            let [one, other] = pair.map(name);
            let more = if known.told == MOST_TOLD {
                ". No more pairs are told"
            } else {
                ""
            };
            warn!(
                "{one} and {other} overlap by {depth:.2} m and do not come apart. Spawn them apart, let their \
                 CollisionLayers not meet, give fast ones ContinuousCollision, or make what presses them lighter or \
                 leave it more room{more}"
            );
        }
    }
    known.pairs.sort_unstable();
}

/// The colliders, or collider and plane, that overlap deeply after a step, and how deeply, metres.
fn deep_pairs<'a>(step: &'a Step, collisions: &'a Collisions) -> impl Iterator<Item = ([Entity; 2], f32)> + 'a {
    let radii = &step.state.input.bodies.radius;
    // Latent results are those of an earlier step, which may have had other colliders.
    let is_known = radii.len() == collisions.rows.entities.len();
    let pairs = if is_known { &collisions.manifolds.pairs[..] } else { &[] };
    pairs.iter().filter_map(move |pair| {
        let depth = -nearest(collisions.manifolds.points_of(pair))?.separation;
        let radius = pair.bodies.into_iter().filter_map(|i| radii.get(i as usize));
        let smaller = radius.copied().fold(f32::INFINITY, f32::min);
        (depth > 2.0 * FRACTION * smaller).then(|| (pair.bodies.map(|i| collisions.collider_or_plane(i)), depth))
    })
}
