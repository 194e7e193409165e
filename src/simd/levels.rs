//! Traversal of a single box tree.

use super::lanes::bits;
use crate::geometry::lanes::BoxGroup;

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
    bits(survivors(&level[group])).all(|lane| below(lower, 8 * group + lane, survivors, found))
}
