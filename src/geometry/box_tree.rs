//! Boxes around runs of triangles, and around runs of such boxes, for searches while a mesh is baked.

use crate::geometry::Aabb;

/// Children per node, and items per leaf.
const WIDTH: usize = 8;

/// A box hierarchy over items in their given order: boxes around runs of eight items, then around runs of eight such boxes,
/// and so on. It is correct for any order, and fast if neighbours in the list are neighbours in space.
pub struct BoxTree {
    count: usize,
    /// From the leaves up; the last level has one box.
    levels: Vec<Vec<Aabb>>,
}

impl BoxTree {
    /// A tree over items with these boxes. There must be at least one.
    pub fn new(boxes: impl IntoIterator<Item = Aabb>) -> Self {
        let boxes: Vec<Aabb> = boxes.into_iter().collect();
        let above = |boxes: &[Aabb]| -> Vec<Aabb> {
            let runs = boxes.chunks(WIDTH);
            runs.map(|run| run.iter().copied().fold(Aabb::EMPTY, Aabb::union))
                .collect()
        };
        let mut levels = vec![above(&boxes)];
        while levels[levels.len() - 1].len() > 1 {
            levels.push(above(&levels[levels.len() - 1]));
        }
        Self {
            count: boxes.len(),
            levels,
        }
    }

    /// Calls `found` with each item in a leaf whose box and all boxes above it are `met`. Both get `state`.
    pub fn visit<S>(&self, state: &mut S, met: impl Fn(&S, &Aabb) -> bool, mut found: impl FnMut(&mut S, usize)) {
        let mut waiting = vec![(self.levels.len() - 1, 0)];
        while let Some((level, i)) = waiting.pop() {
            if !met(state, &self.levels[level][i]) {
                continue;
            }
            let below = if level > 0 {
                self.levels[level - 1].len()
            } else {
                self.count
            };
            let children = i * WIDTH..below.min((i + 1) * WIDTH);
            if level > 0 {
                waiting.extend(children.map(|child| (level - 1, child)));
            } else {
                children.for_each(|item| found(state, item));
            }
        }
    }
}
