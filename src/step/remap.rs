//! Body remap: the numbers of bodies in the last step and in this one.
//!
//! Bodies are renumbered in every step, but their keys stay the same. Both lists are in ascending order of keys, so one
//! merge matches them. [`StepMemory`](super::StepMemory) and the GPU's memory use it.

use crate::state::inactive::GONE;

/// For each key of `now` its number in `before`, if it is there. Both are ascending.
pub(crate) fn previous_numbers<K: Ord>(
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

/// Appends to `numbers`, which are the new numbers of the old bodies, the new numbers of the `old_count` old
/// planes. Planes are numbered after the bodies; now there are `new_count` of them after `bodies` bodies.
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
        let before = |old: &[u64], now: &[u64]| -> Vec<_> {
            previous_numbers(old.iter().copied(), now.iter().copied()).collect()
        };
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
