//! Traversal of a single box tree.

use super::lanes::bits;
use crate::geometry::lanes::BoxGroup;
use arrayvec::ArrayVec;
use std::hint::black_box;

/// Visits a box tree from the root down.
///
/// `survivors` gets eight boxes and returns one bit for each box to descend into. `found` is called with the number of
/// each surviving box of the lowest level, in ascending order. The traversal stops when `found` returns `false`; the
/// result is then `false`.
pub fn visit(
    levels: &[Vec<BoxGroup>],
    survivors: &impl Fn(&BoxGroup) -> u32,
    found: &mut impl FnMut(u32) -> bool,
) -> bool {
    below(levels, 0, survivors, found)
}

fn below(
    levels: &[Vec<BoxGroup>],
    group: usize,
    survivors: &impl Fn(&BoxGroup) -> u32,
    found: &mut impl FnMut(u32) -> bool,
) -> bool {
    let Some((level, lower)) = levels.split_last() else {
        return found(group as u32);
    };
    for lane in bits(survivors(&level[group])) {
        if !below(lower, 8 * group + lane, survivors, found) {
            return false;
        }
    }
    true
}

/// A node that [`visit_nearest`] has yet to visit.
struct Open {
    /// Lower bound of its distance.
    bound: f32,
    /// The boxes below it; 0 for a box of the lowest level.
    level: u32,
    number: u32,
}

/// Each level adds at most seven nodes to those that are open, and 32-bit numbers have at most eleven levels.
const MAX_OPEN: usize = 96;

/// Visits a box tree, nearer boxes first.
///
/// `bounds` gets eight boxes and the largest distance of interest. It returns a lower bound of the distance of each box, and
/// one bit for each box to descend into. `found` is called with the number of each box of the lowest level, and returns the
/// largest distance that is of interest from then on; minus infinity ends the visit. `early` is called with the numbers of
/// several such boxes before the first of them is found: it may read what `found` will need, so that the waits for memory
/// overlap.
#[inline(always)]
pub fn visit_nearest(
    levels: &[Vec<BoxGroup>],
    mut most: f32,
    bounds: impl Fn(&BoxGroup, f32) -> ([f32; 8], u32),
    early: impl Fn(u32),
    mut found: impl FnMut(u32) -> f32,
) {
    let mut open = ArrayVec::<Open, MAX_OPEN>::new();
    open.push(Open {
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
        // In a large mesh the visit waits for memory, so what is below several boxes is asked for together. The upper levels
        // are small, and in the cache.
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
            open.push(Open {
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
