//! Down a single tree of boxes.

use super::lanes::bits;
use crate::state::mesh_arena::BoxGroup;

/// Calls `found` for the numbers of all boxes of the lowest level, ascending, that `survivors` keeps with all boxes above
/// them; `survivors` gets eight boxes and has a bit for each that it keeps. Stops once `found` says no.
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
