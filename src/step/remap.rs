//! Which body of a step was which in the step before.
//!
//! Bodies are numbered anew in every step. Keys, in ascending order, tell them from each other; so one walk along both lists
//! finds who is who. The solver's memory, a device's and the plugin's all use this walk.

use crate::state::inactive::GONE;

/// The number that each of `now` had in the step before, if it was there. Both are ascending.
pub(crate) fn numbers_before<K: Ord>(
    before: impl IntoIterator<Item = K>,
    now: impl IntoIterator<Item = K>,
) -> impl Iterator<Item = Option<u32>> {
    let mut before = (0..).zip(before).peekable();
    now.into_iter().map(move |key| {
        while before.next_if(|(_, old)| *old < key).is_some() {}
        let same = before.peek().filter(|(_, old)| *old == key);
        same.map(|&(number, _)| number)
    })
}

/// Appends to `numbers`, which say where each old body went, where each of `then` half-spaces went. Half-spaces are numbered
/// after the bodies; there are `now` of them after `bodies` bodies.
pub(crate) fn renumber_planes(numbers: &mut Vec<u32>, then: usize, bodies: usize, now: usize) {
    numbers.extend((0..then).map(|plane| if plane < now { (bodies + plane) as u32 } else { GONE }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_that_stay_are_found_whoever_comes_and_goes() {
        let before =
            |old: &[u64], now: &[u64]| -> Vec<_> { numbers_before(old.iter().copied(), now.iter().copied()).collect() };
        assert_eq!(before(&[10, 20, 30], &[10, 20, 30]), [Some(0), Some(1), Some(2)]);
        assert_eq!(
            before(&[10, 20, 30], &[5, 20, 25, 30, 40]),
            [None, Some(1), None, Some(2), None]
        );
        assert_eq!(before(&[], &[1]), [None]);
        assert_eq!(before(&[1], &[]), []);
    }

    #[test]
    fn half_spaces_follow_the_bodies() {
        let mut numbers = vec![0, GONE];
        renumber_planes(&mut numbers, 3, 5, 2);
        assert_eq!(numbers, [0, GONE, 5, 6, GONE]);
    }
}
