//! Body remap: the numbers of bodies in the last step and in this one.
//!
//! Bodies are renumbered in every step, but their keys stay the same. [`StepMemory`](super::StepMemory) and the GPU's
//! memory match them.

use crate::state::inactive::GONE;

/// For each key of `now` its number in `before`, if it is there.
pub(crate) fn previous_numbers(before: &[u64], now: &[u64]) -> Vec<Option<u32>> {
    let mut sorted: Vec<(u64, u32)> = before.iter().copied().zip(0..).collect();
    if !before.is_sorted() {
        sorted.sort_unstable();
    }
    // Most keys come right after the previous key in both lists.
    let mut next = 0;
    let find = |&key: &u64| {
        let is_next = sorted.get(next).is_some_and(|(old, _)| *old == key);
        let at = if is_next {
            next
        } else {
            sorted.binary_search_by_key(&key, |(old, _)| *old).ok()?
        };
        next = at + 1;
        Some(sorted[at].1)
    };
    now.iter().map(find).collect()
}

/// Appends the new numbers of the `old_count` old planes to `numbers`, the new numbers of the old bodies. Planes are
/// numbered after the bodies; there are now `new_count` planes after `bodies` bodies.
pub(crate) fn renumber_planes(numbers: &mut Vec<u32>, old_count: usize, bodies: usize, new_count: usize) {
    numbers.extend((0..old_count).map(|plane| {
        if plane < new_count {
            (bodies + plane) as u32
        } else {
            GONE
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_keep_their_identity_when_others_are_added_and_removed() {
        let before = |old: &[u64], now: &[u64]| -> Vec<_> { previous_numbers(old, now) };
        assert_eq!(before(&[10, 20, 30], &[10, 20, 30]), [Some(0), Some(1), Some(2)]);
        assert_eq!(
            before(&[10, 20, 30], &[5, 20, 25, 30, 40]),
            [None, Some(1), None, Some(2), None]
        );
        assert_eq!(
            before(&[30, 10, 20], &[20, 40, 10, 30]),
            [Some(2), None, Some(1), Some(0)]
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
