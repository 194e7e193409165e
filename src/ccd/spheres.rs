//! When two moving spheres overlap.

use super::Sweep;

/// The first and the last time, from 0 to 1, at which the centres of two sweeps are no farther apart than `reach` metres.
pub fn overlap(sweeps: [&Sweep; 2], reach: f64) -> Option<[f64; 2]> {
    let start = sweeps[1].before.center - sweeps[0].before.center;
    let travel = sweeps[1].travel - sweeps[0].travel;
    // Centres far from the origin are rounded: what is lost must not hide an overlap.
    let largest = start.abs().max(travel.abs()).max_element();
    let rounding = 1.0e-14 * (largest + sweeps[0].before.center.abs().max_element());
    let reach = reach * (1.0 + 1.0e-9) + rounding;
    let speed_squared = travel.length_squared();
    if speed_squared == 0.0 {
        return (start.length() <= reach).then_some([0.0, 1.0]);
    }
    // From the time at which they are nearest, by Pythagoras. The textbook's quadratic formula loses the digits that matter
    // when the way is long.
    let nearest = -start.dot(travel) / speed_squared;
    let distance = (start + travel * nearest).length();
    if distance > reach {
        return None;
    }
    let half = ((reach - distance) * (reach + distance) / speed_squared).sqrt();
    let [first, last] = [nearest - half, nearest + half];
    (first <= 1.0 && last >= 0.0).then(|| [first.max(0.0), last.min(1.0)])
}
