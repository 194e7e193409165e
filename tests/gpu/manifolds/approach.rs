//! Pairs of bodies that come towards each other until they are as near as wanted.

use super::scene::state;
use crate::oracle::body::Body;
use crate::oracle::product::Product;
use bevy_faceoff::manifolds::MarginPair;
use bevy_faceoff::queries::touching;
use bevy_faceoff::step::StepState;
use glam::DVec3;

/// Moves the second along `way`, from `start` on, until it overlaps the first by `overlap`; negative for a gap. Nothing
/// if they do not meet before it has come as far as `stop`.
pub fn against(
    product: &Product,
    a: &Body,
    b: &Body,
    way: DVec3,
    [start, stop]: [f64; 2],
    overlap: f64,
) -> Option<Body> {
    let touch = |t: f64| {
        let pair = [a, &b.moved(way * t)].map(|body| product.placement(body));
        !touching(&pair).expect("usable placements").is_empty()
    };
    let step = 0.01;
    let count = ((stop - start) / step) as usize;
    let hit = (1..=count).map(|i| start + step * i as f64).find(|t| touch(*t))?;
    let (mut low, mut high) = (hit - step, hit);
    for _ in 0..18 {
        let middle = 0.5 * (low + high);
        if touch(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(b.moved(way * (high + overlap)))
}

/// A state of pairs of bodies, with a margin for each.
pub fn scene(product: &Product, pairs: &[([Body; 2], f32)]) -> (StepState, Vec<MarginPair>) {
    let bodies: Vec<&Body> = pairs.iter().flat_map(|(bodies, _)| bodies).collect();
    let margins = (0..).zip(pairs).map(|(i, (_, margin))| MarginPair {
        bodies: [2 * i, 2 * i + 1],
        margin: *margin,
    });
    (state(product, &bodies), margins.collect())
}
