//! The time span in which two moving spheres overlap.

use super::Sweep;

/// The first and the last time, from 0 to 1, at which the centres of two sweeps are at most `max_distance` metres
/// apart.
pub fn overlap(sweeps: [&Sweep; 2], max_distance: f64) -> Option<[f64; 2]> {
    let start = sweeps[1].before.center - sweeps[0].before.center;
    let travel = sweeps[1].travel - sweeps[0].travel;
    // Centres far from the origin are rounded. The allowance keeps that from hiding an overlap.
    let largest = start.abs().max(travel.abs()).max_element();
    let rounding = 1.0e-14 * (largest + sweeps[0].before.center.abs().max_element());
    let max_distance = max_distance * (1.0 + 1.0e-9) + rounding;
    let speed_squared = travel.length_squared();
    if speed_squared == 0.0 {
        return (start.length() <= max_distance).then_some([0.0, 1.0]);
    }
    // By Pythagoras, from the time of the smallest distance. The usual quadratic formula would lose significant digits
    // on long paths.
    let nearest = -start.dot(travel) / speed_squared;
    let distance = (start + travel * nearest).length();
    if distance > max_distance {
        return None;
    }
    let half = ((max_distance - distance) * (max_distance + distance) / speed_squared).sqrt();
    let [first, last] = [nearest - half, nearest + half];
    (first <= 1.0 && last >= 0.0).then(|| [first.max(0.0), last.min(1.0)])
}
