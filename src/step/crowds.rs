//! Crowds: so many bodies overlap one another that their intersecting faces exceed the limits of a step.

use crate::state::crowd::Crowd;
use crate::state::{Bodies, NearPair};
use crate::types::body::RigidBody;

/// Number of pairs that are tested before the next look at the limit, at first.
const PORTION: usize = 256;

/// Cuts `pairs` down to what fits the limits, and returns the bodies that lose pairs.
///
/// `fits` tests some pairs, and returns whether all that it has tested so far stay within the limits. Pairs with a
/// static body come first, so that nothing falls through the floor; then pairs of bodies with few partners. The other
/// bodies keep about equally many pairs each.
pub(super) fn cut(pairs: &mut Vec<NearPair>, bodies: &Bodies, mut fits: impl FnMut(&[NearPair]) -> bool) -> Crowd {
    let mut partners = vec![0u32; bodies.len()];
    for i in pairs.iter().flat_map(|pair| pair.bodies) {
        partners[i as usize] += 1;
    }
    let is_static = |&i: &u32| bodies.kind[i as usize] == RigidBody::Static;
    let crowding = |pair: &NearPair| {
        let [a, b] = pair.bodies;
        let least = partners[a as usize].min(partners[b as usize]);
        let with_static = pair.bodies.iter().any(is_static);
        // By the distance of the numbers, so that every body of a crowd keeps some.
        (if with_static { 0 } else { least }, b - a, a)
    };
    pairs.sort_unstable_by_key(crowding);
    // A portion that does not fit is halved, so that all pairs before the first one that does not fit are kept.
    let (mut kept, mut portion) = (0, PORTION);
    while kept < pairs.len() && portion > 0 {
        let end = pairs.len().min(kept + portion);
        if fits(&pairs[kept..end]) {
            kept = end;
        } else {
            portion /= 2;
        }
    }
    // One pair always fits, or a pair of huge meshes would never be tested.
    let kept = kept.clamp(1, pairs.len());
    let crowd = Crowd::of(pairs[kept..].iter().flat_map(|pair| pair.bodies).collect());
    pairs.truncate(kept);
    pairs.sort_unstable_by_key(|pair| pair.bodies);
    crowd
}

/// Cuts `pairs` down to `most`, in the same order as [`cut`].
pub(super) fn keep_at_most(most: usize, pairs: &mut Vec<NearPair>, bodies: &Bodies) {
    if pairs.len() > most {
        let mut kept = 0;
        cut(pairs, bodies, |portion| {
            let fits = kept + portion.len() <= most;
            kept += if fits { portion.len() } else { 0 };
            fits
        });
    }
}
