//! Traversal of a single box tree.

use super::lanes::bits;
use crate::geometry::lanes::BoxGroup;
use arrayvec::ArrayVec;
use std::hint::black_box;

/// 32-bit numbers have at most eleven groups of three bits.
const MAX_LEVELS: usize = 11;

/// Visits a box tree from the root down.
///
/// `survivors` gets eight boxes and returns one bit for each box to descend into. `found` is called with the number of
/// each surviving box of the lowest level, in ascending order. The traversal stops when `found` returns `false`; the
/// result is then `false`.
#[inline(always)]
pub fn visit(
    levels: &[Vec<BoxGroup>],
    survivors: impl Fn(&BoxGroup) -> u32,
    mut found: impl FnMut(u32) -> bool,
) -> bool {
    // Not recursive, so that it is inlined into code for wider vectors. The group's number is the way to it, three bits
    // per level; `rest` has what is yet to be visited of each group on the way. Above the tree is a group of one box.
    let mut rest = [0; MAX_LEVELS + 1];
    let (mut level, mut group, mut met) = (levels.len(), 0, 1u32);
    loop {
        if met == 0 {
            if level == levels.len() {
                return true;
            }
            level += 1;
            group /= 8;
            met = rest[level];
            continue;
        }
        let number = 8 * group + met.trailing_zeros() as usize;
        met &= met - 1;
        if level > 0 {
            rest[level] = met;
            level -= 1;
            group = number;
            met = survivors(&levels[level][group]);
        } else if !found(number as u32) {
            return false;
        }
    }
}

/// A node that [`visit_nearest`] has yet to visit.
struct OpenNode {
    /// Lower bound of its distance.
    bound: f32,
    /// The boxes below it; 0 for a box of the lowest level.
    level: u32,
    number: u32,
}

/// Each level adds at most seven nodes to those that are open.
const MAX_OPEN: usize = 7 * MAX_LEVELS + 1;

/// Visits a box tree, nearer boxes first.
///
/// `bounds` gets eight boxes and the largest distance of interest. It returns a lower bound of the distance of each
/// box, and one bit for each box to descend into. `found` is called with the number of each box of the lowest level,
/// and returns the largest distance that is of interest from then on; minus infinity ends the visit. `early` is called
/// with the numbers of several such boxes before the first of them is found: it may read what `found` will need, so
/// that the waits for memory overlap.
#[inline(always)]
pub fn visit_nearest(
    levels: &[Vec<BoxGroup>],
    mut most: f32,
    bounds: impl Fn(&BoxGroup, f32) -> ([f32; 8], u32),
    early: impl Fn(u32),
    mut found: impl FnMut(u32) -> f32,
) {
    let mut open = ArrayVec::<OpenNode, MAX_OPEN>::new();
    open.push(OpenNode {
        bound: f32::MIN,
        level: levels.len() as u32,
        number: 0,
    });
    while let Some(node) = open.pop() {
        if node.bound > most {
            continue;
        }
        if node.level == 0 {
            most = found(node.number);
            continue;
        }
        let level = node.level - 1;
        let (lower, met) = bounds(&levels[level as usize][node.number as usize], most);
        let first = open.len();
        // In a large mesh the visit waits for memory, so what is below several boxes is asked for together. The upper
        // levels are small, and in the cache.
        if level <= 2 && met.count_ones() > 1 {
            for lane in bits(met) {
                let number = 8 * node.number + lane as u32;
                if level == 0 {
                    early(number);
                } else {
                    let group = &levels[level as usize - 1][number as usize];
                    black_box((group.center[0].0[0], group.half[0].0[0], group.half[2].0[7]));
                }
            }
        }
        for lane in bits(met) {
            // Insertion sort, farthest first.
            let mut i = open.len();
            open.push(OpenNode {
                bound: lower[lane],
                level,
                number: 8 * node.number + lane as u32,
            });
            while i > first && open[i - 1].bound < open[i].bound {
                open.swap(i - 1, i);
                i -= 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::visit;
    use crate::geometry::Aabb;
    use crate::geometry::lanes::{BoxGroup, box_levels};
    use glam::Vec3;

    /// The numbers that a visit finds of a row of so many unit boxes, of those that begin before `before`. It stops
    /// after `most`.
    fn found(count: u32, before: f32, most: usize) -> (Vec<u32>, bool) {
        let boxes = (0..count).map(|i| Aabb::around([0.0, 1.0].map(|x| Vec3::splat(x) + Vec3::X * i as f32)));
        let (levels, _) = box_levels(boxes.collect());
        let survivors = |group: &BoxGroup| {
            let begins = |lane: &usize| group.center[0].0[*lane] - group.half[0].0[*lane] < before;
            (0..8).filter(begins).map(|lane| 1 << lane).sum()
        };
        let mut found = Vec::new();
        let all = visit(&levels, survivors, |number| {
            found.push(number);
            found.len() < most
        });
        (found, all)
    }

    #[test]
    fn a_visit_finds_the_survivors_in_ascending_order_until_it_is_stopped() {
        for count in [1, 7, 8, 9, 64, 65, 600] {
            for survivors in [0, 1, 8, 9, 63, 64, 70, 600].into_iter().filter(|&n| n <= count) {
                let before = survivors as f32 - 0.5;
                let (numbers, all) = found(count, before, usize::MAX);
                assert!(
                    all && numbers.iter().copied().eq(0..survivors),
                    "{numbers:?} of {count}"
                );
                let (numbers, all) = found(count, before, 5);
                assert!(
                    numbers.iter().copied().eq(0..survivors.min(5)),
                    "{numbers:?} of {count}"
                );
                assert_eq!(all, survivors < 5, "{survivors} of {count}");
            }
        }
    }
}
